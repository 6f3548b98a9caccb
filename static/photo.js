// A photo that can be looked at closely: larger and smaller by wheel, pinch, double click, keys and buttons, and moved about. How it is
// shown is one rule of a style sheet of this script's own, so that a page that is kept fresh does not undo it.
"use strict";

(() => {
  const MOST = 8; // times its size: then pixels are all there is
  const STEP = 1.5; // by keys and buttons
  const MOVE = 0.15; // of what is seen, by an arrow
  const STILL_PX = 4; // a press that moved less is a click
  const root = document.documentElement;
  const sheet = new CSSStyleSheet();
  document.adoptedStyleSheets.push(sheet);
  const whole = () => ({ scale: 1, x: 0, y: 0 });
  let seen = whole(); // x and y: how far the photo's corner is moved, in sizes of the photo as it is whole
  let photo = ""; // the one that is looked at so closely; another one is shown whole
  const touching = new Map(); // the fingers on it, and where each was last
  let moved = 0;

  const viewer = () => document.querySelector(".viewer:has(img)");
  const image = () => viewer()?.querySelector("img");

  function show() {
    const { scale, x, y } = seen;
    sheet.replaceSync(scale === 1 ? "" : `.viewer img { transform: translate(${x * 100}%, ${y * 100}%) scale(${scale}); }`);
    if (scale === 1) delete root.dataset.zoomed;
    else root.dataset.zoomed = "yes";
  }

  function within({ scale, x, y }) {
    const held = (place) => Math.min(0, Math.max(1 - scale, place));
    return { scale, x: held(x), y: held(y) };
  }

  /** So many times larger, with what is at this place of the viewer staying where it is. */
  function zoom(factor, at = { x: 0.5, y: 0.5 }) {
    const scale = Math.min(MOST, Math.max(1, seen.scale * factor));
    const kept = (side) => at[side] - ((at[side] - seen[side]) / seen.scale) * scale;
    seen = within({ scale, x: kept("x"), y: kept("y") });
    show();
  }

  function move(x, y) {
    seen = within({ ...seen, x: seen.x + x, y: seen.y + y });
    show();
  }

  function fit() {
    seen = whole();
    show();
  }

  /** Where in the photo as it is whole a pointer is. */
  function place({ clientX, clientY }) {
    const { left, top, width, height } = frame();
    return { x: (clientX - left) / width, y: (clientY - top) / height };
  }

  /** The photo's own box, as it is when it is shown whole. */
  function frame() {
    const { left, top, width, height } = image().getBoundingClientRect();
    const { scale, x, y } = seen;
    return { left: left - (x * width) / scale, top: top - (y * height) / scale, width: width / scale, height: height / scale };
  }

  const isOn = (event) => event.target.closest?.(".viewer") && event.target.closest(".zoom") === null && image();

  addEventListener("wheel", (event) => {
    if (!isOn(event) || event.ctrlKey) return;
    // Where there is nothing to make smaller, the page scrolls.
    if (event.deltaY > 0 && seen.scale === 1) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 400), place(event));
  }, { passive: false });

  addEventListener("pointerdown", (event) => {
    if (!isOn(event) || event.button !== 0) return;
    touching.set(event.pointerId, event);
    moved = 0;
  });

  addEventListener("pointermove", (event) => {
    const before = touching.get(event.pointerId);
    if (!before || !image()) return;
    const { width, height } = frame();
    const by = { x: event.clientX - before.clientX, y: event.clientY - before.clientY };
    moved += Math.hypot(by.x, by.y);
    const other = [...touching.values()].find(({ pointerId }) => pointerId !== event.pointerId);
    if (other) {
      const apart = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
      const middle = { clientX: (event.clientX + other.clientX) / 2, clientY: (event.clientY + other.clientY) / 2 };
      zoom(apart(event) / Math.max(1, apart(before)), place(middle));
      move(by.x / 2 / width, by.y / 2 / height);
    } else if (seen.scale > 1) {
      move(by.x / width, by.y / height);
    }
    touching.set(event.pointerId, event);
  });

  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, ({ pointerId }) => touching.delete(pointerId));

  // A drag over the photo is no click on the link that it is, and no dragging of the picture out of the page.
  addEventListener("dragstart", (event) => isOn(event) && event.preventDefault());
  addEventListener("click", (event) => {
    const button = event.target.closest?.("button[data-zoom]");
    if (button) ({ in: () => zoom(STEP), out: () => zoom(1 / STEP), whole: fit })[button.dataset.zoom]();
    if (isOn(event) && moved > STILL_PX) event.preventDefault();
  }, { capture: true });
  addEventListener("dblclick", (event) => isOn(event) && !event.target.closest("a") && zoom(2, place(event)));

  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || !event.target.closest?.(".viewer") || !image()) return;
    const keys = { "+": () => zoom(STEP), "=": () => zoom(STEP), "-": () => zoom(1 / STEP), 0: fit };
    const arrows = { ArrowLeft: [MOVE, 0], ArrowRight: [-MOVE, 0], ArrowUp: [0, MOVE], ArrowDown: [0, -MOVE] };
    const arrow = seen.scale > 1 && arrows[event.key];
    const act = keys[event.key] ?? (arrow && (() => move(...arrow)));
    if (!act) return;
    event.preventDefault();
    act();
  });

  // Another piece, or another photo of it, begins whole.
  new MutationObserver(() => {
    const now = image()?.getAttribute("src") ?? "";
    if (now === photo) return;
    photo = now;
    fit();
  }).observe(document.body, { subtree: true, childList: true, attributes: true, attributeFilter: ["src"] });
  photo = image()?.getAttribute("src") ?? "";
  root.dataset.photo = "zooms";
})();
