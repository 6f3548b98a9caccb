// The simulator's page while scripts run: buttons reload nothing, and what others change is shown. STOP is stop.js.
"use strict";

const LOOK_MS = 1500; // so often the page looks whether something has changed, while somebody looks at it

const controls = document.getElementById("controls");
let sending = false;

/** Shows the controls of this page; what somebody types, chooses or is about to press stays. */
function show(html) {
  const fresh = new DOMParser().parseFromString(html, "text/html").getElementById("controls");
  if (fresh) Idiomorph.morph(controls, fresh, { callbacks: { beforeNodeMorphed: keeps } });
}

/** A field with something in it, or a choice that was not sent yet, is nobody else's. */
function keeps(old) {
  return !(old.nodeType === 1 && old.matches("input:not([type=hidden]), select") && (old.dataset.touched || old === document.activeElement));
}

controls.addEventListener("input", (event) => { event.target.dataset.touched = "yes"; });

controls.addEventListener("submit", async (event) => {
  const { target: form, submitter } = event;
  if ("leaves" in form.dataset) return;
  event.preventDefault();
  const fields = new URLSearchParams(new FormData(form));
  if (submitter?.name) fields.set(submitter.name, submitter.value);
  sending = true;
  try {
    const response = await fetch(form.action, { method: "POST", body: fields, headers: { Accept: "text/html" } });
    for (const field of form.querySelectorAll("[data-touched]")) delete field.dataset.touched;
    if (response.ok) form.reset();
    show(await response.text());
  } catch {
    form.closest("section").querySelector(".why").textContent = say("simulator-unsent");
  }
  sending = false;
});

async function look() {
  if (document.hidden || sending || controls.querySelector(".why:not(:empty)")) return;
  try {
    const response = await fetch("./simulator", { headers: { Accept: "text/html" } });
    if (response.ok && !sending) show(await response.text());
  } catch { /* The next look may reach it; STOP says itself when it does not. */ }
}

setInterval(look, LOOK_MS);
document.addEventListener("visibilitychange", look);
