// The picture of the hall under a person's hands: closer, wider, moved, fitted, following the robot; what is under the pointer; the numbers
// of columns and rows; "go there". What is drawn comes from the server; this only chooses the part of it that is seen.
"use strict";

const hall = (() => {
  const CELL = 10; // a cell in the picture's units
  const NEAR_PX = 14; // from this size of a cell on every piece is drawn in its own cell
  const NAMED_PX = 72; // the searching robot has its name from this size of a cell on: below, the name covers pieces
  const LARGEST_PX = 120; // no cell is drawn larger
  const STEP = 1.35;
  const CLICK_PX = 6; // a press that moved less is a click
  const RULER_PX = 90;
  const NUMBER_PX = 26; // minimum distance of two numbers
  const EDGE_PX = 13; // minimum distance of a number from the edge of the panel
  const NUMBERS = [1, 2, 5, 10, 20, 50, 100, 200, 500];
  const FOLLOWED = 2.5; // minimum magnification while the robot is followed

  const stage = at("stage");
  const svg = at("hall");
  let whole = svg.getAttribute("viewBox").split(" ").map(Number);
  let lens = null; // the middle of what is shown and the pixels of a unit; null: the whole hall, however it grows
  const fingers = new Map();
  let moved = 0;
  let pinched = 0;
  let size = { width: 1, height: 1 }; // of the panel, without its margins
  let isFollowed = false;

  /** Pixels of a unit when the whole hall is shown. */
  function fitting() {
    return Math.min(size.width / whole[2], size.height / whole[3]);
  }

  const scale = () => lens?.scale ?? fitting();

  /** The server's picture has these bounds now. Most often they are the same, and nothing is to be painted anew. */
  function bounds(view) {
    outline();
    svg.classList.toggle("pinned", at("pins").childElementCount > 0);
    if (isFollowed) Object.assign(lens, robot());
    else if (view === whole.join(" ") && larger() === drawnLarger) return known === at("hall-labels").dataset.known || rule();
    whole = view.split(" ").map(Number);
    draw();
  }

  /** How many times their size the robot and its like are drawn in. */
  const larger = () => Number(at("hall-layer").dataset.larger ?? 1);
  let drawnLarger = 0;

  function draw() {
    const { width, height } = size;
    if (lens && lens.scale <= fitting() * 1.001) lens = null;
    if (lens) {
      // The middle stays within the hall, so that it is never lost.
      lens.x = Math.min(Math.max(lens.x, whole[0]), whole[0] + whole[2]);
      lens.y = Math.min(Math.max(lens.y, whole[1]), whole[1] + whole[3]);
      const [w, h] = [width / lens.scale, height / lens.scale];
      svg.setAttribute("viewBox", `${lens.x - w / 2} ${lens.y - h / 2} ${w} ${h}`);
    } else {
      svg.setAttribute("viewBox", whole.join(" "));
    }
    drawnLarger = larger();
    svg.classList.toggle("large", drawnLarger > 1);
    svg.style.setProperty("--sized", Math.max(1, drawnLarger * fitting() / scale()));
    svg.classList.toggle("closer", lens !== null);
    svg.classList.toggle("near", scale() * CELL >= NEAR_PX);
    svg.classList.toggle("named", scale() * CELL >= NAMED_PX);
    at("fit").disabled = at("wider").disabled = !lens;
    isFollowed &&= lens !== null;
    at("follow").setAttribute("aria-pressed", isFollowed);
    measure();
    rule();
  }

  const robot = () => {
    const [x, y] = at("hall-robot").getAttribute("transform").match(/-?\d+/g).map(Number);
    return { x, y };
  };

  function follow() {
    isFollowed = !isFollowed;
    if (isFollowed) lens = { ...robot(), scale: Math.min(Math.max(scale(), fitting() * FOLLOWED), LARGEST_PX / CELL) };
    draw();
  }

  let known = ""; // bounds of the hall that the drawn numbers belong to

  /** The numbers of columns and rows: beside the hall, and at the edge of the panel where the hall goes on beyond it. */
  function rule() {
    known = at("hall-labels").dataset.known;
    const matrix = svg.getScreenCTM();
    if (!matrix) return;
    const [left, top, right, bottom] = known.split(" ").map(Number);
    const box = stage.getBoundingClientRect();
    const step = NUMBERS.find((step) => step * CELL * matrix.a >= NUMBER_PX) ?? 1000;
    const texts = [];
    const put = (x, y, number) => {
      if (x < EDGE_PX || y < EDGE_PX || x > box.width || y > box.height) return;
      const text = document.createElementNS("http://www.w3.org/2000/svg", "text");
      text.setAttribute("x", Math.round(x));
      text.setAttribute("y", Math.round(y) + 4);
      text.textContent = number;
      texts.push(text);
    };
    const [x0, y0] = [matrix.e - box.left, matrix.f - box.top];
    const place = (cell, from) => from + (cell + .5) * CELL * matrix.a;
    const above = Math.max(EDGE_PX, y0 + top * CELL * matrix.a - EDGE_PX);
    const beside = Math.max(EDGE_PX, x0 + left * CELL * matrix.a - EDGE_PX);
    for (let x = Math.ceil(left / step) * step; x <= right; x += step) put(place(x, x0), above, x);
    for (let y = Math.ceil(top / step) * step; y <= bottom; y += step) put(beside, place(y, y0), y);
    at("rulers").replaceChildren(...texts);
  }

  /** A bar as long as a round number of metres, or of cells where their size is not known. */
  function measure() {
    const side = Number(svg.dataset.cellM) || 0;
    const unit = side ? scale() * CELL / side : scale() * CELL;
    const most = RULER_PX / unit;
    const power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map((n) => n * power).find((n) => n <= most) ?? power;
    at("ruler").style.width = `${length * unit}px`;
    at("ruler").textContent = say(side ? "hall-ruler-metres" : "hall-ruler-cells", { length: Number(length.toPrecision(2)).toLocaleString(root.lang) });
  }

  /** The point of the picture under a point of the window. */
  function under({ clientX, clientY }) {
    const matrix = svg.getScreenCTM();
    return matrix && new DOMPoint(clientX, clientY).matrixTransform(matrix.inverse());
  }

  /** So many times as close, while this point of the picture stays where it is. */
  function zoom(factor, about = middle()) {
    const before = scale();
    const now = Math.min(before * factor, LARGEST_PX / CELL);
    const { x, y } = lens ?? middle();
    const kept = before / now;
    lens = { scale: now, x: about.x + (x - about.x) * kept, y: about.y + (y - about.y) * kept };
    if (isFollowed) Object.assign(lens, robot());
    hideOffer();
    draw();
  }

  function move(dx, dy) {
    if (!lens) return;
    isFollowed = false;
    lens.x += dx / lens.scale;
    lens.y += dy / lens.scale;
    hideOffer();
    draw();
  }

  const middle = () => lens ?? { x: whole[0] + whole[2] / 2, y: whole[1] + whole[3] / 2 };

  function fit() {
    lens = null;
    hideOffer();
    draw();
  }

  const cellOf = (point) => ({ x: Math.floor(point.x / CELL), y: Math.floor(point.y / CELL) });

  // ---- an area to search again ----

  const area = document.createElementNS("http://www.w3.org/2000/svg", "path");
  area.setAttribute("class", "again");
  svg.append(area);

  /** The form of an area, while a person can use it. */
  function areaForm() {
    const form = document.querySelector("#again[open] form");
    return form?.checkVisibility() && !root.dataset.past && !form.querySelector("fieldset").disabled ? form : null;
  }

  /** The pressed cell becomes a corner: the first of a new area, or the opposite one. */
  function putCorner(form, { x, y }) {
    const { elements } = form;
    const isSecond = elements.x.value !== "" && elements.toX.value === "";
    const [column, row] = isSecond ? ["toX", "toY"] : ["x", "y"];
    if (!isSecond) [elements.toX.value, elements.toY.value] = ["", ""];
    [elements[column].value, elements[row].value] = [x, y];
    outline();
  }

  /** Draws the area that is typed or chosen; of a single corner its cell. */
  function outline() {
    const form = areaForm();
    const number = (name) => parseInt(form?.elements[name].value, 10);
    const [x, y] = [number("x"), number("y")];
    const [toX, toY] = [number("toX"), number("toY")].map((to, n) => (Number.isNaN(to) ? [x, y][n] : to));
    const [left, top, width, height] = [Math.min(x, toX), Math.min(y, toY), Math.abs(toX - x) + 1, Math.abs(toY - y) + 1].map((n) => n * CELL);
    area.setAttribute("d", Number.isNaN(left + top) ? "" : `M${left} ${top}h${width}v${height}h${-width}z`);
  }

  for (const what of ["input", "reset", "toggle"]) {
    document.addEventListener(what, ({ target }) => target.closest?.("#again") && setTimeout(outline), { capture: true });
  }

  // ---- go there ----

  const offer = document.createElement("form");
  offer.id = "offer";
  offer.method = "post";
  offer.action = "./console/goto";
  offer.dataset.why = "page";
  offer.hidden = true;
  for (const name of ["epoch", "x", "y"]) offer.append(Object.assign(document.createElement("input"), { type: "hidden", name }));
  offer.append(Object.assign(document.createElement("button"), { className: "small" }));
  stage.append(offer);

  /** A cell was pressed: it is a corner of an area, or, if it is free, the robot can be sent there. */
  function offerCell(event) {
    hideOffer();
    const isFree = event.target.closest?.(".visited, .trail, .route, .ray");
    const again = areaForm();
    if (again) return putCorner(again, cellOf(under(event)));
    const drive = document.querySelector("#manual form[action='./console/goto']");
    if (!isFree || root.dataset.past || !drive || drive.querySelector("fieldset").disabled) return;
    const cell = cellOf(under(event));
    offer.elements.x.value = cell.x;
    offer.elements.y.value = cell.y;
    offer.querySelector("button").textContent = say("hall-go", cell);
    offer.hidden = false;
    const box = stage.getBoundingClientRect();
    offer.style.left = `${Math.min(event.clientX - box.left, box.width - offer.offsetWidth - 8)}px`;
    offer.style.top = `${Math.min(event.clientY - box.top, box.height - offer.offsetHeight - 8)}px`;
  }

  function hideOffer() {
    offer.hidden = true;
  }

  offer.addEventListener("submit", () => {
    // A STOP since then makes it void, as it does of any other button.
    offer.elements.epoch.value = document.querySelector("#manual form[action='./console/goto'] [name=epoch]").value;
    setTimeout(hideOffer);
  }, { capture: true });

  // ---- hands ----

  svg.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(event.deltaY < 0 ? STEP : 1 / STEP, under(event) ?? undefined);
  }, { passive: false });

  svg.addEventListener("pointerdown", (event) => {
    if (event.button > 0) return;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (fingers.size === 1) moved = 0;
    pinched = spread();
    name(event);
  });

  svg.addEventListener("pointermove", (event) => {
    const finger = fingers.get(event.pointerId);
    if (finger) {
      const [dx, dy] = [event.clientX - finger.x, event.clientY - finger.y];
      moved += Math.abs(dx) + Math.abs(dy);
      if (moved > CLICK_PX && !svg.hasPointerCapture(event.pointerId)) svg.setPointerCapture(event.pointerId);
      finger.x = event.clientX;
      finger.y = event.clientY;
      if (fingers.size === 1 && moved > CLICK_PX) move(-dx, -dy);
      if (fingers.size === 2) pinch();
    }
    name(event);
  });

  /** Says which cell is under a pointer or a finger. */
  function name(event) {
    const point = under(event);
    if (point) at("pointer").textContent = say("hall-cell", cellOf(point));
  }

  /** How far apart two fingers are. */
  function spread() {
    const [one, other] = [...fingers.values()];
    return other ? Math.hypot(one.x - other.x, one.y - other.y) : 0;
  }

  function pinch() {
    const [one, other] = [...fingers.values()];
    const about = under({ clientX: (one.x + other.x) / 2, clientY: (one.y + other.y) / 2 });
    const now = spread();
    if (pinched > 0 && now > 0) zoom(now / pinched, about ?? undefined);
    pinched = now;
  }

  for (const what of ["pointerup", "pointercancel"]) {
    svg.addEventListener(what, (event) => {
      fingers.delete(event.pointerId);
      pinched = 0;
    });
  }
  svg.addEventListener("pointerleave", () => (at("pointer").textContent = ""));

  svg.addEventListener("click", (event) => {
    if (moved > CLICK_PX) return event.preventDefault();
    const piece = event.target.closest("[data-piece]");
    if (piece) open(`./luggage/${piece.dataset.piece}`, "_blank", "noopener");
    else if (event.target.closest(".pin")) zoom(STEP ** 4, under(event) ?? undefined);
    else offerCell(event);
  });

  at("closer").addEventListener("click", () => zoom(STEP * STEP));
  at("wider").addEventListener("click", () => zoom(1 / STEP / STEP));
  at("fit").addEventListener("click", fit);
  at("follow").addEventListener("click", follow);

  stage.tabIndex = 0;
  stage.addEventListener("keydown", (event) => {
    if (event.target !== stage || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = Math.min(size.width, size.height) / 5;
    const keys = {
      "+": () => zoom(STEP), "=": () => zoom(STEP), "-": () => zoom(1 / STEP), 0: fit, c: () => at("covered").click(),
      ArrowLeft: () => move(-step, 0), ArrowRight: () => move(step, 0), ArrowUp: () => move(0, -step), ArrowDown: () => move(0, step),
    };
    const act = keys[event.key];
    if (!act || (event.key.startsWith("Arrow") && !lens)) return;
    event.preventDefault();
    act();
  });

  new ResizeObserver(([{ contentRect }]) => {
    size = { width: contentRect.width || 1, height: contentRect.height || 1 };
    draw();
  }).observe(svg);
  return { bounds, hideOffer };
})();
