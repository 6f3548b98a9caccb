// STOP, on every page of ours. Without this script it is a plain form. With it nothing is reloaded, and a STOP that was not
// confirmed stays on the page and is tried again until it is (safety S10). What else a page does stands in console.js.
"use strict";

const CONFIRM_MS = 2000; // an attempt that is not answered by then is given up: the STOP is unconfirmed
const AGAIN_MS = 1000; // a new attempt begins at most so often by itself
const SOON_MS = 400; // of an attempt that is answered sooner nothing is said
const OVER_MS = 15000; // that a STOP was confirmed is old after this
const COVERED_PX = 60; // a window of which so much is missing has a keyboard over it
const ATTEMPTS = 4; // at once: a browser has six connections for all pages of a place

let leaving = false;

/** To the page where one signs in; it says what was not done: a STOP before everything else, and else what was first. */
function signIn(undone) {
  if (!leaving || undone === "stop") location.assign(`./sign-in?undone=${undone}`);
  leaving = true;
}

const stopping = (() => {
  const form = document.getElementById("stop");
  const bar = form?.closest("#command-bar");
  const place = document.getElementById("why-stop");
  const words = place?.dataset; // in the language of the page
  const filled = (phrase, value) => phrase.replace("{}", () => value);
  const key = `hallsweep-stop ${form?.action}`; // a page of the same hall that is loaded anew finds the name of an unconfirmed STOP under this
  const page = crypto.getRandomValues(new Uint32Array(4)).join("-");
  let pressed = 0; // how often it was pressed here
  let name = ""; // a press has one name for all its attempts, so that it is on record once
  let open = false; // whether a press is not confirmed yet
  let isInDoubt = false; // whether that was said
  let underWay = 0;
  let triedAt = -Infinity;
  let again, soon, over;

  /** A press is confirmed by an attempt that began after it, not by one that was on its way already. */
  function press(before = null) {
    pressed += 1;
    name = before ?? `${page}-${pressed}`;
    open = true;
    remember(name);
    if (underWay < ATTEMPTS) attempt();
  }

  async function attempt() {
    const press = pressed;
    underWay += 1;
    triedAt = performance.now();
    clearTimeout(again);
    clearTimeout(soon);
    if (!place.textContent) soon = setTimeout(() => open && say(words.soon), SOON_MS);
    const failure = await failed(name);
    underWay -= 1;
    if (failure === "401") return giveUp();
    if (!open || (failure === null && press === pressed)) return confirmed();
    clearTimeout(soon);
    clearTimeout(again);
    if (failure !== null) doubt(failure);
    again = setTimeout(attempt, failure === null ? 0 : AGAIN_MS);
  }

  /** Sends it: null when the robot's program has confirmed it, else why not. */
  async function failed(called) {
    try {
      const signal = AbortSignal.timeout(CONFIRM_MS);
      const headers = { accept: "application/json", "idempotency-key": called };
      const answer = await fetch(form.action, { method: "POST", headers, keepalive: true, signal });
      if (answer.status === 401) return "401";
      const said = await answer.json();
      return answer.ok && said.accepted ? null : filled(words.says, said.detail ?? answer.status);
    } catch (error) {
      return error.name === "TimeoutError" ? words.silent : words.cut;
    }
  }

  function confirmed() {
    if (!open) return;
    const wasLate = isInDoubt;
    isInDoubt = false;
    open = false;
    remember(null);
    clearTimeout(again);
    clearTimeout(soon);
    // The console shows at once what holds the robot; other pages look every second, and whoever was in doubt is told anywhere.
    say(wasLate || !document.documentElement.dataset.live ? words.confirmed : "", true);
    over = setTimeout(() => say(""), OVER_MS);
  }

  /** Nobody is signed in any more: the page for that says that STOP was not given. It is remembered, and sent when somebody has signed in. */
  function giveUp() {
    open = false;
    signIn("stop");
  }

  function doubt(failure) {
    isInDoubt = true;
    say(filled(words.unconfirmed, failure));
  }

  function say(said, isDone = false) {
    clearTimeout(over);
    place.classList.toggle("done", isDone);
    if (place.textContent !== said) place.textContent = said;
  }

  function remember(unconfirmed) {
    try {
      if (unconfirmed) sessionStorage.setItem(key, unconfirmed);
      else sessionStorage.removeItem(key);
    } catch {
      // Without a memory it is tried for as long as this page is open.
    }
  }

  function leftUnconfirmed() {
    try {
      return sessionStorage.getItem(key);
    } catch {
      return null;
    }
  }

  /** The connection stands, by whatever sign: an unconfirmed STOP does not wait for its turn. */
  function connected() {
    if (open && performance.now() - triedAt > AGAIN_MS) attempt();
  }

  /** Two fingers, or a keyboard on the screen, make what is seen smaller than the page: STOP then lies along the lower edge of that. */
  function follow() {
    const { scale, offsetLeft, offsetTop, width, height } = visualViewport;
    const isSmaller = scale > 1.05 || innerHeight - height * scale > COVERED_PX;
    document.documentElement.classList.toggle("magnified", isSmaller);
    bar.style.width = isSmaller ? `${width * scale}px` : "";
    bar.style.transform = isSmaller ? `translate(${offsetLeft}px, ${offsetTop + height}px) scale(${1 / scale}) translateY(-100%)` : "";
  }

  if (form) {
    document.documentElement.dataset.stop = "ready";
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      press();
    });
    // Escape is STOP, whatever is open or typed.
    document.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || event.repeat) return;
      event.preventDefault();
      press();
    }, { capture: true });
    // A key that is held down presses a button once.
    document.addEventListener("keydown", (event) => {
      if (event.repeat && event.key === "Enter" && event.target.closest?.("button")) event.preventDefault();
    });
    for (const what of ["resize", "scroll"]) globalThis.visualViewport?.addEventListener(what, follow);
    addEventListener("online", connected);
    document.addEventListener("visibilitychange", connected);
    const before = leftUnconfirmed();
    if (before) {
      doubt(words.left);
      press(before);
    }
  }
  return { connected };
})();
