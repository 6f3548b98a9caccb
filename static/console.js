// The console's script: it keeps the page fresh from one event stream and sends its forms without reloading.
// Everything it does also works without it; it knows no rule of the mission, and what it shows comes rendered from the server.
"use strict";

const SILENCE_MS = 3000; // the server speaks every second: after three the page is not to be believed
const RETRY_MS = 1000;
const LOOK_MS = 900; // a page without a stream of its own looks this often
const STREAMS = 3; // pages of one browser that keep a stream
const SETTLE_MS = 500; // verdict buttons are dead this long when the piece under them changes
const WHY_MS = 15000; // a reason of a refusal is old after this
const STOP_MS = 2000; // a STOP that is not confirmed by then is said to be unconfirmed
const SEND_MS = 8000; // anything else may wait for the store
const GLANCE_MS = 5000; // a page nobody looks at keeps its title true by looking this often

const at = (id) => document.getElementById(id);
const root = document.documentElement;

// ---- keeping fresh -------------------------------------------------------------------------------------------------------

let stream = null;
let heard = performance.now();
let heardAt = new Date();
let settledAt = 0;

/** Opens the stream anew; its first message holds everything, so whatever was missed is caught up with. */
function listen() {
  stream?.close();
  stream = new EventSource("/console/live");
  stream.addEventListener("page", (event) => {
    show(JSON.parse(event.data));
    alive();
    if (openedSince >= STREAMS || document.hidden) stream.close();
  });
  stream.addEventListener("tick", alive);
  stream.addEventListener("error", refused);
}

/** The door hangs up when it does not know us any more: then one is told so, where one signs in. */
async function refused() {
  const answer = await fetch("/", { method: "HEAD" }).catch(() => null);
  if (answer?.status === 401) signIn("watching");
}

let leaving = false;

/** To the page where one signs in; it says what was not done. A later reason does not take the place of an earlier one. */
function signIn(undone) {
  if (!leaving) location.assign(`/sign-in?undone=${undone}`);
  leaving = true;
}

function alive() {
  heard = performance.now();
  heardAt = new Date();
  if (root.dataset.live !== "on") {
    root.dataset.live = "on";
    at("lost").hidden = true;
  }
}

/** Nothing was heard for too long: say so, and let nobody act blindly. STOP stays, it is an ordinary request. */
function lost() {
  if (root.dataset.live !== "lost") {
    root.dataset.live = "lost";
    at("lost-since").textContent = heardAt.toLocaleTimeString("en-GB");
    at("lost").hidden = false;
    unask();
  }
  // The next whole message renders every button as it then is.
  document.querySelectorAll("button:not([data-always])").forEach((control) => (control.disabled = true));
}

let retried = 0;
setInterval(() => {
  const now = performance.now();
  const silence = now - heard;
  const patience = document.hidden ? 2 * GLANCE_MS : SILENCE_MS;
  const due = document.hidden ? GLANCE_MS : openedSince >= STREAMS ? LOOK_MS : SILENCE_MS;
  if (silence > patience) lost();
  if (silence > due && now - retried > RETRY_MS) {
    retried = now;
    listen();
  }
  waits();
}, 250);

let ahead = 0; // the server's clock before this one's, in milliseconds

/** How long each piece has waited by now. */
function waits() {
  for (const place of document.querySelectorAll("[data-since]")) {
    if (!(root.dataset.live === "on")) continue;
    const seconds = Math.max(0, Math.floor((Date.now() + ahead - Number(place.dataset.since)) / 1000));
    place.textContent = `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
  }
}

// A browser opens only six connections to one place for all its pages together, and a STOP must find a free one. So pages
// nobody looks at give their stream back, and of those in sight only the latest few keep one; the others look by the second.
const pages = new BroadcastChannel("hallsweep-console");
let openedSince = 0;
pages.onmessage = () => {
  openedSince += 1;
  if (openedSince >= STREAMS) stream?.close();
};

/** Opens a stream to keep. */
function join() {
  openedSince = 0;
  // What is shown may be old; until the first message has come it is not called live.
  if (root.dataset.live === "on") root.dataset.live = "opening";
  heard = performance.now();
  pages.postMessage("opened");
  listen();
}

document.addEventListener("visibilitychange", () => (document.hidden ? stream?.close() : join()));
addEventListener("pageshow", (event) => event.persisted && join());
addEventListener("focus", () => openedSince >= STREAMS && join());

/** Shows what changed. */
function show(message) {
  ahead = message.now - Date.now();
  at("hall").setAttribute("viewBox", message.view);
  const piece = at("inspect").dataset.luggage;
  for (const [id, markup] of Object.entries(message.parts)) {
    if (id.startsWith("hall-") || id.startsWith("tile_")) draw(id, markup);
    else morph(id, markup);
  }
  if (message.whole) {
    for (const tile of [...at("tiles").children]) if (!(tile.id in message.parts)) tile.remove();
    at("confirm-yes").disabled = at("confirm-no").disabled = false;
  }
  if (document.title !== message.title) document.title = message.title;
  at("revision").textContent = message.revision;
  if (at("inspect").dataset.luggage !== piece) otherPiece();
}

/** Another piece is under the verdict buttons: a click already on its way must not hit it. */
function otherPiece() {
  settledAt = performance.now() + SETTLE_MS;
  at("inspect").classList.add("settling");
  setTimeout(() => at("inspect").classList.remove("settling"), SETTLE_MS);
  if (at("confirm").dataset.id) unask();
}

/** Replaces a piece of the picture; the robot keeps its element, so that it glides instead of jumping. */
function draw(id, markup) {
  const old = at(id);
  if (!markup) return old?.remove();
  const parsed = new DOMParser().parseFromString(`<svg xmlns="http://www.w3.org/2000/svg">${markup}</svg>`, "image/svg+xml");
  const fresh = document.importNode(parsed.documentElement.firstElementChild, true);
  if (!old) at("tiles").append(fresh);
  else if (id === "hall-robot") {
    for (const { name, value } of fresh.attributes) old.setAttribute(name, value);
    old.replaceChildren(...fresh.childNodes);
    glide(old);
  } else old.replaceWith(fresh);
}

/** The same as the attribute says, as a style, because only styles glide. */
function glide(robot) {
  const [x, y] = robot.getAttribute("transform").match(/-?\d+/g);
  robot.style.transform = `translate(${x}px, ${y}px)`;
}

/** Changes a part into its newer self, but not what a person types, has opened, or is being told. */
function morph(id, markup) {
  const old = at(id);
  if (!old) return;
  Idiomorph.morph(old, markup, {
    morphStyle: "outerHTML",
    ignoreActiveValue: true,
    callbacks: {
      beforeNodeMorphed: (node) => !isPersons(node),
      beforeAttributeUpdated: (name, node) => !(name === "open" && node.tagName === "DETAILS"),
    },
  });
}

/** Whether this is the person's and not the server's: a reason being shown, something typed, a choice not yet sent. */
function isPersons(node) {
  if (node.tagName === "INPUT") return node.type !== "hidden";
  return node.classList?.contains("why") || node.dataset?.touched === "yes";
}

document.addEventListener("change", (event) => {
  if (event.target.tagName === "SELECT") event.target.dataset.touched = "yes";
});

// ---- acting --------------------------------------------------------------------------------------------------------------

document.addEventListener("submit", (event) => {
  const form = event.target;
  if (form.id === "who") leaving = true;
  if (!form.action.includes("/console/")) return;
  event.preventDefault();
  if (form.closest("#inspect") && performance.now() < settledAt) return;
  if (form.dataset.confirm) return ask(form);
  if (form.closest("#confirm")) unask();
  send(form, new URLSearchParams(new FormData(form, event.submitter)), event.submitter);
});

const sending = new Set();

/** Sends a form; a refusal is written beside the button that was pressed. A STOP is never held back by another one. */
async function send(form, fields, button) {
  const isStop = form.id === "stop";
  const { action, dataset: { why } } = form;
  const what = `${action} ${fields.get("id") ?? ""}`;
  if (sending.has(what) && !isStop) return;
  sending.add(what);
  if (!isStop) button?.setAttribute("aria-busy", "true");
  tell(why, "");
  const slow = isStop && setTimeout(() => tell(why, "STOP is on its way…"), 400);
  try {
    const signal = AbortSignal.timeout(isStop ? STOP_MS : SEND_MS);
    const answer = await fetch(action, { method: "POST", body: fields, headers: { accept: "application/json" }, signal });
    const said = await answer.json();
    clearTimeout(slow);
    if (answer.status === 401) signIn(isStop ? "stop" : "command");
    else if (!answer.ok) tell(why, said.detail ?? `It was refused (${answer.status}).`);
    else accepted(form);
  } catch (error) {
    clearTimeout(slow);
    tell(why, unheard(isStop, error.name === "TimeoutError"));
  } finally {
    sending.delete(what);
    button?.removeAttribute("aria-busy");
  }
}

/** What to do when no answer came: a robot of which nobody knows is treated as one that moves. */
function unheard(isStop, isLate) {
  if (isStop) return `STOP is not confirmed: ${isLate ? "no answer came" : "there is no connection"}. Use the robot's own switch, and press STOP again.`;
  if (isLate) return "No answer came. It may still be carried out: look at the robot before you try again.";
  return "No connection: it did not get through.";
}

/** What was refused before is history, and what was typed has been sent. */
function accepted(form) {
  for (const place of document.querySelectorAll(".why:not(:empty)")) place.textContent = "";
  for (const select of form.querySelectorAll("select")) delete select.dataset.touched;
  if (form.querySelector("input:not([type=hidden])")) form.reset();
}

const fading = new Map();

/** Writes a reason beside a button, for a while. */
function tell(button, words) {
  const place = at(`why-${button}`) ?? at("why-page");
  place.textContent = words;
  clearTimeout(fading.get(place.id));
  if (words && !words.endsWith("…")) fading.set(place.id, setTimeout(() => tell(button, ""), WHY_MS));
}

/** Asks before the act, not after it. */
function ask(form) {
  const dialog = at("confirm");
  const inner = dialog.querySelector("form");
  inner.action = form.dataset.confirm;
  inner.dataset.why = form.dataset.why;
  inner.elements.id.value = form.dataset.id ?? "";
  inner.elements.id.disabled = !form.dataset.id;
  dialog.dataset.id = form.dataset.id ?? "";
  at("confirm-question").textContent = form.dataset.question;
  at("confirm-consequence").textContent = form.dataset.consequence;
  at("confirm-yes").textContent = form.dataset.yes;
  // The question is not modal, since STOP must stay in reach; everything else is out of it until there is an answer.
  rest().forEach((part) => (part.inert = true));
  asked = document.activeElement;
  dialog.show();
  at("confirm-no").focus();
}

let asked = null;
const rest = () => document.querySelectorAll(".skip, .ask, .field, .controls, .below");

/** Takes the question back. */
function unask() {
  if (!at("confirm").open) return;
  at("confirm").close();
  rest().forEach((part) => (part.inert = false));
  if (asked?.isConnected) asked.focus();
}

at("confirm-no").addEventListener("click", unask);

// Escape is STOP, whatever is open or typed; a question that is open is thereby taken back.
document.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" || event.repeat) return;
  event.preventDefault();
  unask();
  at("stop").requestSubmit();
}, { capture: true });

// ---- reading the picture -------------------------------------------------------------------------------------------------

at("hall").addEventListener("pointermove", (event) => {
  const matrix = at("hall").getScreenCTM();
  if (!matrix) return;
  const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
  at("pointer").textContent = `column ${Math.floor(point.x / 10)}, row ${Math.floor(point.y / 10)}`;
});
at("hall").addEventListener("pointerleave", () => (at("pointer").textContent = ""));

root.dataset.live = "opening";
glide(at("hall-robot"));
join();
