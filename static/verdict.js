// The moment of the verdict: its keys, the photo as large as the window lets it, and the question of DANGER beside the photo instead of
// over it. Who may press what, and that nothing is sent while a piece has just changed, is console.js's business and the server's.
"use strict";

(() => {
  const SETTLE_MS = 500; // so long the second click of a double click on DANGER is no yes
  const GAP_PX = 8;
  const NARROW_PX = 288; // no question is narrower
  const WIDE_PX = 480;
  const root = document.documentElement;
  const dialog = document.getElementById("confirm");
  const shortcuts = document.getElementById("shortcuts");
  const sheet = new CSSStyleSheet();
  document.adoptedStyleSheets.push(sheet);
  const inspect = () => document.getElementById("inspect");

  // ---- keys ----------------------------------------------------------------------------------------------------------------

  const isTyping = (target) => target.closest?.("input:not([type=radio], [type=checkbox]), textarea, select, [contenteditable]");

  /** The button of the verdict with this key, which is a letter of the page's language. */
  const ofVerdict = (key) => inspect().querySelector(`.verdict-form [aria-keyshortcuts="${CSS.escape(key)}"]`);

  /** Presses a button of the verdict as a key does, not as a pointer; why a dead one is dead is said. */
  function press(button) {
    if (button.disabled) tell("verdict", button.title && `${button.title}.`);
    else button.click();
  }

  /** Goes to the next answer to a question about the piece; after the last one, to none. */
  function answer(question) {
    const answers = [...inspect().querySelectorAll(`[data-question="${question}"] input`)];
    const next = answers.findIndex((one) => one.checked) + 1;
    for (const [n, one] of answers.entries()) one.checked = n === next && !one.matches(":disabled");
  }

  const keys = { f: enlarge, "?": list, 1: () => answer("hidden"), 2: () => answer("obvious"), 3: () => answer("typical") };

  document.addEventListener("keydown", (event) => {
    const { key, repeat, ctrlKey, altKey, metaKey, shiftKey, target } = event;
    if (event.defaultPrevented || repeat || ctrlKey || altKey || metaKey || isTyping(target)) return;
    if ((shiftKey && key !== "?") || dialog.open) return;
    const letter = key.toLowerCase();
    const button = ofVerdict(letter);
    const act = keys[letter] ?? (button && (() => press(button)));
    if (!act) return;
    event.preventDefault();
    // The list may lie over the photo: a key of it shows the page again, and decides nothing yet.
    if (shortcuts.open) uncover();
    else act();
  });

  /** All keys, or none. */
  function list() {
    if (shortcuts.open) uncover();
    else cover(shortcuts);
  }

  // ---- the photo, large ------------------------------------------------------------------------------------------------------

  function enlarge() {
    if (!inspect().querySelector(".viewer")) return;
    root.toggleAttribute("data-large");
    inspect().scrollTo(0, 0);
    inspect().querySelector("a.photo").focus({ preventScroll: true });
  }

  document.addEventListener("click", ({ target }) => {
    if (target.closest("[data-enlarge]")) enlarge();
    if (target.closest("[data-shortcuts]")) list();
  });

  // ---- the question ------------------------------------------------------------------------------------------------------------

  let askedAt = 0;

  /** Where a question can stand: not over the bar, not over STOP and what is said of it, under it or in a column of its own. */
  function room() {
    const box = (one) => one.getBoundingClientRect();
    const stop = box(document.getElementById("command-bar"));
    const top = document.getElementById("top");
    const rail = document.getElementById("rail");
    const isAbove = getComputedStyle(rail).position === "static"; // it pushes the bar down where the page is not scrolled
    const bar = getComputedStyle(top).position === "sticky" ? top.offsetHeight + (isAbove ? rail.offsetHeight : 0) : 0;
    const column = parseFloat(getComputedStyle(document.getElementById("desk")).paddingRight);
    const isBelow = stop.bottom > innerHeight - GAP_PX && stop.width > innerWidth / 2;
    const said = [...document.querySelectorAll("#notes > :not(:empty, [hidden])")].map(box);
    const hasColumn = !isBelow && column > GAP_PX * 4; // in which the messages have their place
    return {
      left: (isAbove ? 0 : rail.offsetWidth) + GAP_PX,
      top: Math.max(bar, ...(!isBelow && !hasColumn ? said.map(({ bottom }) => bottom) : [])) + GAP_PX,
      right: innerWidth - Math.max(hasColumn && said.length === 0 ? 0 : column, GAP_PX),
      bottom: (isBelow ? Math.min(stop.top, ...said.map(({ top }) => top)) : innerHeight) - GAP_PX,
    };
  }

  /** The places beside the photo, the widest first choice first. */
  function beside(photo, all) {
    return [
      { ...all, right: photo.left - GAP_PX },
      { ...all, top: Math.max(all.top, photo.bottom + GAP_PX) },
      { ...all, left: photo.right + GAP_PX },
      { ...all, bottom: photo.top - GAP_PX },
    ];
  }

  /** Puts the question into a place, if it fits there. */
  function fits({ left, top, right, bottom }) {
    const width = Math.min(WIDE_PX, right - left);
    if (width < NARROW_PX) return false;
    const x = left + (right - left - width) / 2;
    const rule = (y) => `#confirm { inset: ${y}px auto auto ${x}px; width: ${width}px; max-width: none; margin: 0; }`;
    sheet.replaceSync(rule(top));
    const spare = bottom - top - dialog.offsetHeight;
    if (spare >= 0) sheet.replaceSync(rule(top + Math.min(spare / 2, innerHeight / 4)));
    return spare >= 0;
  }

  /** The question of DANGER is beside the photo that it is about. Where there is no room, the photo makes some. */
  function place() {
    sheet.replaceSync("");
    const viewer = dialog.dataset.id && inspect().querySelector(".viewer");
    if (!viewer) return;
    const seen = () => viewer.getBoundingClientRect();
    if (beside(seen(), room()).some(fits)) return;
    sheet.replaceSync("");
    if (root.hasAttribute("data-large")) inspect().scrollTo(0, 0);
    else scrollBy(0, seen().top - room().top);
    if (fits(beside(seen(), room())[1])) return;
    const all = room();
    const high = Math.max(64, all.bottom - dialog.offsetHeight - GAP_PX - seen().top);
    const y = all.bottom - dialog.offsetHeight;
    sheet.replaceSync(`#confirm { inset: ${y}px auto auto ${all.left}px; width: ${all.right - all.left}px; max-width: none; margin: 0; }
      .viewer img { max-height: ${high}px; object-fit: contain; }`);
  }

  new MutationObserver(() => {
    if (!dialog.open) return sheet.replaceSync("");
    askedAt = performance.now();
    place();
  }).observe(dialog, { attributeFilter: ["open"] });
  const placeAgain = () => dialog.open && place();
  addEventListener("resize", placeAgain);
  const observer = new ResizeObserver(placeAgain);
  for (const id of ["command-bar", "why-stop", "notes"]) observer.observe(document.getElementById(id));

  // The second click of a double click on DANGER may land on the answer.
  dialog.addEventListener("click", (event) => {
    const isSecond = event.detail > 1 && performance.now() < askedAt + SETTLE_MS;
    if (event.target.id === "confirm-yes" && isSecond) event.preventDefault();
  });

  root.dataset.verdict = "yes";
})();
