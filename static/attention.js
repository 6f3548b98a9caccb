// Calls whoever looks elsewhere: by a notification of the browser while the page is not in view, and by a sound. Both are off until they
// are switched on, and this browser remembers it. What there is to call for is read off the page, which console.js keeps fresh.
"use strict";

(() => {
  const panel = document.getElementById("attention");
  const said = document.getElementById("attention-said");
  const switches = { notify: document.getElementById("notify"), sound: document.getElementById("sound") };
  const key = (name) => `hallsweep-${name}`;
  let audio = null;

  // ---- what there is to call for -------------------------------------------------------------------------------------------

  const waiting = () => document.getElementById("inspect").dataset.luggage;
  const alarms = () => [...document.querySelectorAll("form[id^=alarm-]")];
  // A form with a field of the name `id` has no `id` of its own but that field.
  const nameOf = (alarm) => alarm.getAttribute("id");
  let lastWaiting = waiting();
  const known = new Set(alarms().map(nameOf));

  /** What is new since the last look. */
  function look() {
    const piece = waiting();
    if (piece && piece !== lastWaiting) call(`waits-${piece}`, say("attention-waits", { id: piece }), 2);
    lastWaiting = piece;
    for (const alarm of alarms()) {
      if (known.has(nameOf(alarm))) continue;
      known.add(nameOf(alarm));
      call(nameOf(alarm), alarm.querySelector("p").innerText, 4);
    }
  }

  new MutationObserver(look).observe(document.getElementById("desk"), { subtree: true, childList: true, attributeFilter: ["data-luggage"] });

  // ---- calling -----------------------------------------------------------------------------------------------------------------

  function call(tag, words, beeps) {
    if (switches.sound.checked) sound(beeps);
    if (!switches.notify.checked || !document.hidden || Notification.permission !== "granted") return;
    // Several pages of one hall call once: what has the same tag takes the other's place.
    const notification = new Notification(words, { tag: `hallsweep-${tag} ${document.baseURI}`, icon: "./static/icon.svg", requireInteraction: true });
    notification.onclick = () => {
      focus();
      notification.close();
    };
  }

  /** So many short tones, two heights in turn. */
  function sound(beeps) {
    audio ??= new AudioContext();
    audio.resume();
    for (let beep = 0; beep < beeps; beep += 1) {
      const [tone, volume, from] = [audio.createOscillator(), audio.createGain(), audio.currentTime + beep * 0.28];
      tone.frequency.value = beep % 2 ? 660 : 880;
      volume.gain.setValueAtTime(0.0001, from);
      volume.gain.exponentialRampToValueAtTime(0.25, from + 0.02);
      volume.gain.exponentialRampToValueAtTime(0.0001, from + 0.22);
      tone.connect(volume).connect(audio.destination);
      tone.start(from);
      tone.stop(from + 0.24);
    }
  }

  // ---- the switches ------------------------------------------------------------------------------------------------------------

  /** What the browser makes of it: the reason why not, or nothing. */
  async function unable() {
    if (!("Notification" in globalThis)) return say("attention-unknown");
    if (Notification.permission === "default") await Notification.requestPermission();
    return Notification.permission === "granted" ? "" : say("attention-denied");
  }

  switches.notify.addEventListener("change", async () => {
    said.textContent = switches.notify.checked ? await unable() : "";
    if (said.textContent) switches.notify.checked = false;
    remember("notify");
  });
  switches.sound.addEventListener("change", () => {
    if (switches.sound.checked) sound(2);
    remember("sound");
  });

  function remember(name) {
    try {
      localStorage.setItem(key(name), switches[name].checked ? "on" : "off");
    } catch {
      // A browser that keeps nothing asks again the next time.
    }
  }

  function recalled(name) {
    try {
      return localStorage.getItem(key(name)) === "on";
    } catch {
      return false;
    }
  }

  switches.notify.checked = recalled("notify") && globalThis.Notification?.permission === "granted";
  switches.sound.checked = recalled("sound");
  // A browser lets a page be heard only after somebody has touched it.
  if (switches.sound.checked) addEventListener("pointerdown", () => (audio ??= new AudioContext()).resume(), { once: true });
  panel.hidden = false;
})();
