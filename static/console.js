// The console's script: it keeps the page fresh from one event stream and sends its forms without reloading.
// Everything it does also works without it; it knows no rule of the mission, and what it shows comes rendered from the server.
// STOP itself is in stop.js, which every page has.
"use strict";

const SILENCE_MS = 3000; // the server speaks every second: after three the page is not to be believed
const RETRY_MS = 1000;
const LOOK_MS = 900; // a page without a stream of its own looks this often
const STREAMS = 3; // pages of one browser that keep a stream
const SETTLE_MS = 500; // verdict buttons are dead this long when the piece under them changes
const WHY_MS = 15000; // a reason of a refusal is old after this
const SEND_MS = 8000; // a command may wait for the store
const GLANCE_MS = 5000; // a page nobody looks at keeps its title true by looking this often

const at = (id) => document.getElementById(id);
const root = document.documentElement;

// ---- keeping fresh -------------------------------------------------------------------------------------------------------

let stream = null;
let heard = performance.now();
let settledAt = 0;

/** Opens the stream anew; its first message holds everything, so whatever was missed is caught up with. */
function listen() {
  stream?.close();
  stream = new EventSource("./console/live");
  stream.addEventListener("page", (event) => {
    const message = JSON.parse(event.data);
    if (time.isPast()) time.meanwhile(message);
    else show(message);
    alive();
    if (openedSince >= STREAMS || document.hidden) stream.close();
  });
  stream.addEventListener("tick", alive);
  stream.addEventListener("error", refused);
}

/** The door hangs up when it does not know us any more: then one is told so, where one signs in. */
async function refused() {
  const answer = await fetch("./", { method: "HEAD" }).catch(() => null);
  if (answer?.status === 401) signIn("watching");
}

function alive() {
  if (typeof stopping !== "undefined") stopping.connected();
  heard = performance.now();
  if (root.dataset.live !== "on") {
    root.dataset.live = "on";
    at("lost").hidden = true;
  }
}

/** Nothing was heard for too long: say so, and let nobody act blindly. STOP stays, it is an ordinary request. */
function lost() {
  if (root.dataset.live !== "lost") {
    root.dataset.live = "lost";
    at("lost-since").textContent = `${clockTime(heard)} (${at("zone").textContent})`;
    at("lost").hidden = false;
    uncover();
  }
  // The next whole message renders every button as it then is.
  document.querySelectorAll("button:not([data-always])").forEach((control) => (control.disabled = true));
  if (isDead(document.activeElement)) lead();
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

let ahead = performance.timeOrigin; // what makes a moment here, which counts from when the page was opened, one of the server's clock

/** A moment by this clock as the server's clock shows it, in its zone, like every other time on the page. */
function clockTime(moment) {
  const zone = at("zone").dataset;
  return new Date(moment + ahead + Number(zone.offset) * 1000).toISOString().slice(11, 19);
}

/** How long each piece has waited by now, and how old readings are; one that is said when it is old is hidden before. */
function waits() {
  for (const place of document.querySelectorAll("[data-since]")) {
    if (!(root.dataset.live === "on")) continue;
    const seconds = Math.max(0, Math.floor((performance.now() + ahead - Number(place.dataset.since)) / 1000));
    const words = `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
    if (place.textContent !== words) place.textContent = words;
    if (place.dataset.old > 0) place.parentElement.hidden = seconds * 1000 < place.dataset.old;
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
  if (!message.then) ahead = message.now - performance.now();
  const [piece, act] = [at("inspect").dataset.luggage, nextAct()];
  const here = document.activeElement;
  for (const [id, markup] of Object.entries(message.parts)) {
    if (/^(hall-|tile_|pieces_|pins_|time_)/.test(id)) draw(id, markup);
    else morph(id, markup);
  }
  if (document.querySelector("dialog[open]")) hide(); // what is new, too
  if (message.whole) {
    for (const layer of Object.values(LAYERS)) for (const part of [...at(layer).children]) if (!(part.id in message.parts)) part.remove();
    at("confirm-yes").disabled = at("confirm-no").disabled = false;
  }
  const isFetching = !at("retrieval").hidden;
  at("desk").classList.toggle("fetching", isFetching);
  if (!isFetching && at("tab-trees").checked) at("tab-status").checked = true;
  hall.bounds(message.view);
  time.shown(message);
  drawCoverage();
  if (!message.then) {
    if (document.title !== message.title) document.title = message.title;
    at("revision").textContent = message.revision;
  }
  if (at("inspect").dataset.luggage !== piece) otherPiece();
  else if (nextAct() !== act) settledAt = performance.now() + SETTLE_MS;
  if (answered && message.revision >= answered.revision) goOn();
  else if (here !== document.body && isDead(here)) lead();
}

/** What the buttons of the incident, of the banners and under a photo are about: a double click on OK must not be START. */
const nextAct = () => {
  const forms = [...document.querySelectorAll("#incident .acts form, #holds form")];
  return [at("holds").childElementCount, at("inspect").dataset.take, ...forms.map((form) => `${form.getAttribute("action")} ${form.elements.id?.value ?? ""}`)].join();
};

/** Another piece is under the verdict buttons: a click already on its way must not hit it. */
function otherPiece() {
  settledAt = performance.now() + SETTLE_MS;
  at("inspect").classList.add("settling");
  setTimeout(() => at("inspect").classList.remove("settling"), SETTLE_MS);
  if (at("confirm").open && at("confirm").dataset.id) overtaken(at("confirm").dataset.id);
  else if (!at("confirm").open) uncover();
}

/** Where a piece of the picture goes that was not there before, by the beginning of its id. */
const LAYERS = { tile: "tiles", pieces: "pieces", pins: "pins", time: "times" };

/** Replaces a piece of the picture. */
function draw(id, markup) {
  const old = at(id);
  if (!markup) return old?.remove();
  const parsed = new DOMParser().parseFromString(`<svg xmlns="http://www.w3.org/2000/svg">${markup}</svg>`, "image/svg+xml");
  if (parsed.querySelector("parsererror")) return; // what was there is better than a browser's complaint
  const fresh = document.importNode(parsed.documentElement.firstElementChild, true);
  if (old) old.replaceWith(fresh);
  else at(LAYERS[id.split("_")[0]]).append(fresh);
}

/** Changes a part into its newer self, but not what a person types, has opened, or is being told. */
function morph(id, markup) {
  const old = at(id);
  if (!old) return;
  Idiomorph.morph(old, markup, {
    morphStyle: "outerHTML",
    callbacks: {
      beforeNodeMorphed: (node, newer) => (node.tagName === "SELECT" && newer.disabled) || !isPersons(node),
      beforeAttributeUpdated: (name, node) => !(name === "open" && node.tagName === "DETAILS") && name !== "inert",
    },
  });
  for (const select of at(id)?.querySelectorAll("select:disabled") ?? []) giveUp(select);
}

/** A choice that was not sent and cannot be any more is none: what holds is shown again. */
function giveUp(select) {
  delete select.dataset.touched;
  select.value = select.querySelector("option[selected]").value;
}

/** Whether this is the person's and not the server's: a reason being shown, something typed, a choice not yet sent. */
function isPersons(node) {
  if (node.tagName === "INPUT") return node.type !== "hidden";
  if (node.tagName === "TEXTAREA") return true;
  if (node.tagName === "SELECT" && node === document.activeElement) return true;
  return node.classList?.contains("why") || node.dataset?.touched === "yes";
}

document.addEventListener("change", (event) => {
  if (event.target.tagName === "SELECT") event.target.dataset.touched = "yes";
});

// ---- how well each cell was searched --------------------------------------------------------------------------------------

const COVER_MS = 1000; // the coverage is large: it is asked for this often at most
const covered = at("covered");
let coverNext = 0;
let coverTimer;

/** Whether the layer is shown. The past has no such picture. */
const isCovered = () => covered.getAttribute("aria-pressed") === "true" && !root.dataset.past;

async function drawCoverage() {
  clearTimeout(coverTimer);
  if (!isCovered()) return at("hall-coverage").replaceChildren();
  const left = coverNext - performance.now();
  if (left > 0) return (coverTimer = setTimeout(drawCoverage, left));
  coverNext = performance.now() + COVER_MS;
  const answer = await fetch("./console/coverage").catch(() => null);
  if (answer?.ok && isCovered()) draw("hall-coverage", await answer.text());
}

covered.addEventListener("click", () => {
  covered.setAttribute("aria-pressed", covered.getAttribute("aria-pressed") !== "true");
  coverNext = 0;
  drawCoverage();
});

// ---- acting --------------------------------------------------------------------------------------------------------------

document.addEventListener("submit", (event) => {
  const form = event.target;
  if (form.id === "who") leaving = true;
  if (form.id === "stop" || !form.getAttribute("action")?.includes("./console/")) return;
  event.preventDefault();
  if (form.closest("#inspect, .acts, #holds") && performance.now() < settledAt) {
    return tell(form.dataset.why, say("console-changed"));
  }
  if (settling && event.submitter === settling.button && performance.now() < settling.until && !isAimed) {
    return tell(form.dataset.why, say("console-twice"));
  }
  const asks = event.submitter?.dataset.confirm ? event.submitter : form;
  if (asks.dataset.confirm) return ask(asks);
  if (form.closest("#confirm")) uncover();
  send(form, new URLSearchParams(new FormData(form, event.submitter)), event.submitter);
});

// A finger has no hover that shows the title: a press on a disabled button tells its reason.
document.addEventListener("pointerup", ({ pointerType, target }) => {
  const dead = pointerType !== "mouse" && target.closest?.(":disabled[title]:not([data-always])");
  if (dead) tell("page", dead.title);
});

let isAimed = false; // whether the last press was one of its own with a pointer, and neither a key nor the second of a double click
document.addEventListener("click", (event) => (isAimed = event.detail === 1), true);

// A link within the page leads there at whatever moment is shown; its address is for a page without scripts.
document.addEventListener("click", (event) => {
  const { hash } = event.target.closest?.("a") ?? {};
  if (!hash || !at(hash.slice(1))) return;
  event.preventDefault();
  location.assign(location.pathname + location.search + hash);
});

const sending = new Set();

/** Sends a form; a refusal is written beside the button that was pressed. */
async function send(form, fields, button) {
  const action = button?.getAttribute("formaction") ?? form.action;
  const { why } = form.dataset;
  const what = `${action} ${fields.get("id") ?? ""}`;
  if (sending.has(what)) return;
  sending.add(what);
  button?.setAttribute("aria-busy", "true");
  tell(why, "");
  try {
    const signal = AbortSignal.timeout(SEND_MS);
    const answer = await fetch(action, { method: "POST", body: fields, headers: { accept: "application/json" }, signal });
    const said = await answer.json();
    if (answer.status === 401) signIn("command");
    else if (!answer.ok) tell(why, said.detail ?? say("console-refused", { status: answer.status }));
    else accepted(form, button, said);
  } catch (error) {
    tell(why, say(error.name === "TimeoutError" ? "console-silent" : "console-cut"));
  } finally {
    sending.delete(what);
    button?.removeAttribute("aria-busy");
  }
}

/** What was refused before is history, and what was typed has been sent. What is said beside STOP is not this script's. */
function accepted(form, button, { revision, keptBack, luggage }) {
  for (const place of document.querySelectorAll(".why:not(:empty, #why-stop)")) place.textContent = "";
  for (const select of form.querySelectorAll("select")) delete select.dataset.touched;
  if (form.querySelector("input:not([type=hidden])")) form.reset();
  if (keptBack) tell(form.dataset.why, say("console-kept-back", { id: luggage.id }));
  answered = { button, revision };
  if (Number(at("revision").textContent) >= revision) goOn();
}

let settling = null; // the button on which the keyboard was put: what a hand that presses twice hits there does not count
let answered = null; // the button whose press was accepted, until the page shows what came of it

/** The page shows what came of a press: the keyboard goes where the next act is, unless a person has moved it meanwhile. */
function goOn() {
  const here = document.activeElement;
  const isDone = [answered.button, asked].includes(here) && here.closest("#inspect, #actions");
  answered = null;
  if (here === document.body || isDead(here) || isDone) lead();
}

const isDead = (element) => !element.isConnected || element.matches(":disabled");

/** Puts the keyboard where the next act is. */
function lead() {
  // At a piece first comes its photo: a key that was pressed once too often decides nothing. While the robot moves it is STOP.
  const piece = root.dataset.live !== "lost" && at("inspect").dataset.luggage && at("inspect").querySelector("a.photo, button:enabled");
  const next = piece || document.querySelector(".acts .loud:enabled") || document.querySelector("button.start.loud:enabled") || at("stop-button");
  next.focus({ preventScroll: next === at("stop-button") });
  settling = { button: next, until: performance.now() + SETTLE_MS };
}

const fading = new Map();

/** Writes a reason beside a button, for a while. */
function tell(button, words) {
  const place = at(`why-${button}`) ?? at("why-page");
  place.textContent = words;
  clearTimeout(fading.get(place.id));
  if (words) fading.set(place.id, setTimeout(() => tell(button, ""), WHY_MS));
}

/** Asks before the act, not after it. */
function ask({ dataset, form }) {
  const dialog = at("confirm");
  const inner = dialog.querySelector("form");
  inner.action = dataset.confirm;
  inner.dataset.why = dataset.why;
  inner.elements.id.value = dataset.id ?? "";
  inner.elements.id.disabled = !dataset.id;
  for (const name of ["note", "hidden", "obvious", "typical"]) {
    const field = inner.elements[name];
    field.value = form?.elements[name]?.value ?? "";
    field.disabled = !field.value;
  }
  dialog.dataset.id = dataset.id ?? "";
  const size = at("confirm-sizes");
  size.hidden = size.disabled = !dataset.id;
  for (const field of size.elements) {
    field.value = "";
    field.oninput = () => [...size.elements].forEach((other) => other !== field && (other.value = ""));
  }
  at("confirm-question").textContent = dataset.question;
  at("confirm-consequence").textContent = dataset.consequence;
  at("confirm-yes").textContent = dataset.yes;
  cover(dialog);
}

let asked = null;
const rest = () => document.querySelectorAll(".skip, #rail, #bar a, #actions, #side, .field, #time");
const hide = () => rest().forEach((part) => (part.inert = true));

/** Opens a dialog. It is not modal, since STOP must stay in reach; nothing else can be pressed through it. */
function cover(dialog) {
  at("menu").open = false;
  hide();
  asked = document.activeElement;
  dialog.show();
  dialog.querySelector("[autofocus]").focus();
}

/** Closes the dialog that is open; a question is thereby taken back. */
function uncover() {
  const dialog = document.querySelector("dialog[open]");
  if (!dialog) return;
  dialog.close();
  rest().forEach((part) => (part.inert = false));
  if (asked?.isConnected) asked.focus();
}

/** Takes the question about a piece back that waits no more, and says beside its buttons what became of it. */
async function overtaken(id) {
  uncover();
  const { verdict, decided } = await fetch(`./api/v1/luggage/${id}`).then((answer) => answer.json()).catch(() => ({}));
  if (!decided) return tell("verdict", say("console-withdrawn", { id }));
  const values = { id, by: decided.by, time: clockTime(Date.parse(decided.at) - ahead) };
  tell("verdict", verdict === "safe" ? say("console-judged-safe", values) : say("console-judged-danger", values));
}

at("confirm-no").addEventListener("click", uncover);

// Escape is STOP, and takes away whatever lies over the desk, so that what holds is seen.
document.addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  uncover();
  at("menu").open = false;
  root.removeAttribute("data-large");
  hall.hideOffer();
}, { capture: true });

root.dataset.live = "opening";
addEventListener("DOMContentLoaded", join); // when hall.js and time.js are there as well
