// The editor of halls: draws the hall file that stands in the text field below it, and writes what is drawn back into it. What a hall file
// means, and what is wrong with one, the program says; this script knows only the drawing in it and the words about luggage.
"use strict";

const LETTERS = "abcdefghijklmnopqrstuvwxyz";
const STEPS_BACK = 200; // so much can be undone
const CHECK_MS = 500; // the hall is checked when nothing was drawn for so long
const LARGEST_PX = 40; // a cell on the screen, at most
const MOST_CORNERS = 32; // of an area
const FLOOR = ".", WALL = "#", HOME = "S", PLAIN = "T";

const $ = (id) => document.getElementById(id);
const canvas = $("plan");
const text = $("toml");
const most = Number($("draw").dataset.most);
const mostBytes = Number($("draw").dataset.bytes);
const mayAct = !text.readOnly;

/** The hall: rows of characters, what is said of each letter, the areas, and the other lines of the file as they stand. */
let hall = { rows: ["S"], bags: {}, areas: [], head: "", tail: "" };
let cursor = { x: 0, y: 0 };
let anchor = null; // where a line or a rectangle began
let outline = []; // the corners of an unfinished polygon
let stroke = null; // what is drawn while the pointer is down: its letter, and the cell before
let findings = [];
let undone = [], done = [];
let checking, checks = 0;
let isNamed = $("keep-as").value !== ""; // whether somebody has named it; else it is kept under the hall's own name

// ---- the file ----

/** The hall of a file as the program writes it; null when it is written otherwise. */
function parse(toml) {
  const parts = toml.replaceAll("\r\n", "\n").match(/^([\s\S]*?)drawing = """\n([\s\S]*?)"""\n([\s\S]*)$/);
  if (!parts) return null;
  const [, head, drawing, rest] = parts;
  const rows = drawing.trimEnd().split("\n").map((row) => row.trim());
  const blocks = rest.split(/(?=^\[\[)/m).map((block) => block.trim()).filter(Boolean);
  const bags = {};
  for (const block of blocks.filter((block) => block.startsWith("[[luggage]]"))) {
    const mark = block.match(/^mark = "([a-z])"$/m)?.[1];
    if (!mark) return null;
    const lines = block.split("\n").slice(1).filter((line) => !/^(mark|dangerous) = /.test(line));
    bags[mark] = { lines, dangerous: /^dangerous = true$/m.test(block) };
  }
  const areas = blocks.filter((block) => block.startsWith("[[area]]")).map(parseArea);
  const tail = blocks.filter((block) => !/^\[\[(luggage|area)\]\]/.test(block)).join("\n\n");
  return areas.includes(null) || rows.some((row) => row.length !== rows[0].length) ? null : { rows, bags, areas, head, tail };
}

function parseArea(block) {
  const value = (key) => block.match(new RegExp(`^${key} = (.+)$`, "m"))?.[1] ?? "";
  const name = value("name");
  try {
    const probability = JSON.parse(value("probability"));
    return { name: /^'[^']*'$/.test(name) ? name.slice(1, -1) : JSON.parse(name), probability, corners: JSON.parse(value("corners")) };
  } catch {
    return null;
  }
}

function written({ rows, bags, areas, head, tail }) {
  const there = new Set(rows.join(""));
  const blocks = Object.entries(bags).filter(([mark]) => there.has(mark)).sort().map(([mark, bag]) =>
    ["[[luggage]]", `mark = "${mark}"`, ...bag.lines, ...(bag.dangerous ? ["dangerous = true"] : [])].join("\n"));
  const corner = ([x, y]) => `[${x}, ${y}]`;
  const named = areas.map(({ name, probability, corners }) =>
    `[[area]]\nname = ${JSON.stringify(name)}\nprobability = ${probability}\ncorners = [${corners.map(corner).join(", ")}]`);
  return [`${head}drawing = """\n${rows.join("\n")}\n"""`, ...blocks, ...named, tail].filter(Boolean).join("\n\n") + "\n";
}

/** What the program reads in a file: the hall as a hall file, and findings; or the words of its refusal. */
async function read(name, body) {
  const headers = body.size > mostBytes ? { "Content-Encoding": "gzip" } : {};
  if (body.size > mostBytes) body = await new Response(body.stream().pipeThrough(new CompressionStream("gzip"))).blob();
  if (body.size > mostBytes) return { why: say("editor-large", { bytes: body.size, most: mostBytes }) };
  try {
    const place = `./api/v1/simulator/hall/check?name=${encodeURIComponent(name.replaceAll(/[^\w.-]/g, "_"))}`;
    const response = await fetch(place, { method: "POST", headers, body });
    const answer = await response.json();
    return response.ok ? answer : { why: say("editor-refused", answer) };
  } catch {
    return { why: say("editor-cut") };
  }
}

// ---- what is drawn ----

const width = () => hall.rows[0].length;
const height = () => hall.rows.length;
const at = (x, y) => hall.rows[y]?.[x];
const copy = () => JSON.stringify(hall);

function put(x, y, mark) {
  if (at(x, y) === undefined || at(x, y) === mark) return;
  hall.rows[y] = hall.rows[y].slice(0, x) + mark + hall.rows[y].slice(x + 1);
}

/** The letter of a new dangerous piece; none is left when all stand in the drawing. */
function newLetter() {
  const there = new Set(hall.rows.join(""));
  const letter = [...LETTERS].find((letter) => !there.has(letter));
  if (!letter) return tell(say("editor-letters"));
  hall.bags[letter] = { lines: ['kind = "backpack"', 'colour = "red"'], dangerous: true };
  return letter;
}

/** Draws with the tool into one cell. Home is moved, and never drawn over. */
function draw(x, y) {
  const tool = chosen("tool"), here = at(x, y);
  if (here === undefined || (here === HOME && tool !== "home")) return;
  if (tool === "wall") put(x, y, WALL);
  if (tool === "floor") put(x, y, FLOOR);
  if (tool === "home") {
    hall.rows = hall.rows.map((row) => row.replace(HOME, FLOOR));
    put(x, y, HOME);
  }
  if (tool === "bag") {
    if (hall.bags[here]) hall.bags[here].dangerous = false;
    else put(x, y, PLAIN);
  }
  if (tool === "danger") {
    if (hall.bags[here]) hall.bags[here].dangerous = true;
    else {
      const letter = stroke?.letter ?? newLetter();
      if (stroke && letter) stroke.letter = letter; // one stroke is one piece
      if (letter) put(x, y, letter);
    }
  }
}

/** All cells from one to another, so that a quick pointer leaves no gap: side by side, as pieces must touch. */
function* between(from, to) {
  let { x, y } = from;
  const dx = Math.abs(to.x - x), dy = Math.abs(to.y - y), sx = Math.sign(to.x - x), sy = Math.sign(to.y - y);
  yield { x, y };
  for (let i = 0, j = 0; i < dx || j < dy;) {
    if (j >= dy || (i < dx && (i + .5) * dy < (j + .5) * dx)) { x += sx; i += 1; } else { y += sy; j += 1; }
    yield { x, y };
  }
}

function* inside(from, to) {
  for (let y = Math.min(from.y, to.y); y <= Math.max(from.y, to.y); y += 1)
    for (let x = Math.min(from.x, to.x); x <= Math.max(from.x, to.x); x += 1) yield { x, y };
}

const cellsOf = (shape, from, to) => (shape === "rectangle" ? inside(from, to) : between(from, to));

/** Adds an area, with a name that no other area has. */
function addArea(corners) {
  let number = 1;
  while (hall.areas.some(({ name }) => name === say("editor-area-name", { number }))) number += 1;
  const probability = Math.min(.1, Math.max(0, rest()));
  change(() => hall.areas.push({ name: say("editor-area-name", { number }), probability, corners }));
}

/** The probability outside the areas. */
const rest = () => Math.round((1 - hall.areas.reduce((sum, { probability }) => sum + probability, 0)) * 1e6) / 1e6;

/** Adds a corner to the outline. The first corner once more closes it. */
function addCorner({ x, y }) {
  const [first] = outline;
  if (first && first[0] === x && first[1] === y) {
    const corners = outline;
    outline = [];
    addArea(corners.length > 2 ? corners : [...corners, first]); // two corners would be a rectangle
  } else if (outline.length === MOST_CORNERS) {
    tell(say("editor-corners", { most: MOST_CORNERS }));
  } else {
    outline.push([x, y]);
  }
}

const isOutline = () => chosen("tool") === "area" && chosen("shape") === "line";

/** The cells of each outline that was drawn. */
const known = new Map();

/** The cells whose centre is within the outline or on it, as the program counts them. */
function cellsIn(corners) {
  const key = JSON.stringify(corners);
  if (known.has(key)) return known.get(key);
  const [[x0, y0], [x1, y1]] = corners;
  const points = corners.length === 2 ? [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] : corners;
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  const from = { x: Math.min(...xs), y: Math.min(...ys) }, to = { x: Math.max(...xs), y: Math.max(...ys) };
  const cells = new Set();
  for (const { x, y } of inside(from, to)) if (isWithin(points, x, y)) cells.add(`${x},${y}`);
  known.set(key, cells);
  return cells;
}

function isWithin(points, x, y) {
  let is = false;
  for (const [index, [ax, ay]] of points.entries()) {
    const [bx, by] = points[(index + 1) % points.length];
    const turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
    if (turn === 0 && x >= Math.min(ax, bx) && x <= Math.max(ax, bx) && y >= Math.min(ay, by) && y <= Math.max(ay, by)) return true;
    if ((ay > y) !== (by > y) && (turn > 0) === (by > ay)) is = !is;
  }
  return is;
}

/** Draws the line or rectangle that began at the anchor. */
function drawShape(to) {
  if (chosen("tool") === "area") addArea([[anchor.x, anchor.y], [to.x, to.y]]);
  else change(() => {
    stroke = {};
    for (const { x, y } of cellsOf(chosen("shape"), anchor, to)) draw(x, y);
    stroke = null;
  });
  anchor = null;
}

/** Does something that can be undone. */
function change(act) {
  const before = copy();
  act();
  remember(before);
}

function remember(before) {
  if (before === copy()) return paint();
  done = [...done.slice(-STEPS_BACK), before];
  undone = [];
  changed();
}

function step(from, to) {
  if (!from.length) return;
  to.push(copy());
  hall = JSON.parse(from.pop());
  changed();
}

/** What was said of the hall was said of another one: it is taken away, and the hall as it is now checked. */
function unchecked() {
  findings = [];
  checks += 1; // what is on its way is of another one, too
  for (const id of ["why", "done"]) $(id).textContent = "";
  $("findings").textContent = say("editor-unchecked");
  clearTimeout(checking);
  checking = setTimeout(check, CHECK_MS);
}

/** The text, the fields and the check follow what is drawn. */
function changed() {
  text.value = written(hall);
  unchecked();
  cursor = { x: Math.min(cursor.x, width() - 1), y: Math.min(cursor.y, height() - 1) };
  showFields();
  paint();
}

/** A button that is just being pressed must not move from under the hand. */
async function released() {
  while (document.querySelector("button:active")) await new Promise(requestAnimationFrame);
}

async function check() {
  const number = checks += 1;
  const answer = await read("hall.toml", new Blob([text.value]));
  await released();
  if (number !== checks) return; // a later one is on its way
  const checked = parse(answer.toml ?? "")?.rows ?? hall.rows;
  const all = answer.findings ?? [];
  findings = checked.join() === hall.rows.join() ? all : []; // a text that somebody types is not drawn yet
  const rows = all.map((found) => {
    const item = document.createElement("li"), to = document.createElement("button");
    if (!isPlaced(found)) {
      item.textContent = said(found);
      return item;
    }
    to.type = "button";
    to.className = "small";
    to.textContent = placed(found.column, found.row, said(found), checked);
    to.addEventListener("click", () => { cursor = { x: found.column, y: found.row }; canvas.focus(); moved(); });
    item.append(to);
    return item;
  });
  const words = document.createElement("p");
  words.className = answer.why ? "why" : "";
  if ($("why").textContent.trim() === answer.why) $("why").textContent = ""; // a page that came with it
  words.textContent = answer.why ?? say(rows.length ? "editor-unsound" : "editor-sound");
  const list = document.createElement("ul");
  list.append(...rows);
  $("findings").replaceChildren(words, list);
  paint();
}

// ---- what is shown ----

const chosen = (name) => document.querySelector(`input[name=${name}]:checked`).value;
const tell = (words) => { $("draw-why").textContent = words; };
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
let side = 20;
let painting = false;

function paint() {
  if (!painting) requestAnimationFrame(paintNow);
  painting = true;
}

function paintNow() {
  painting = false;
  const room = $("sheet").clientWidth - 2;
  side = Math.max(4, Math.min(LARGEST_PX, Math.floor(room / width())));
  const scale = window.devicePixelRatio || 1;
  canvas.width = width() * side * scale;
  canvas.height = height() * side * scale;
  canvas.style.width = `${width() * side}px`;
  canvas.style.height = `${height() * side}px`;
  const to = canvas.getContext("2d");
  to.scale(scale, scale);
  const looks = { [FLOOR]: colour("--visited"), [WALL]: colour("--wall"), [PLAIN]: colour("--bag"), [HOME]: colour("--visited") };
  to.fillStyle = colour("--grid");
  to.fillRect(0, 0, width() * side, height() * side);
  const gap = side > 7 ? 1 : 0;
  to.textAlign = "center";
  to.textBaseline = "middle";
  to.font = `700 ${Math.round(side * .62)}px system-ui, sans-serif`;
  hall.rows.forEach((row, y) => [...row].forEach((mark, x) => {
    const dangerous = hall.bags[mark]?.dangerous;
    to.fillStyle = dangerous ? colour("--red") : looks[mark] ?? colour("--bag");
    to.fillRect(x * side, y * side, side - gap, side - gap);
    if (side < 10 || mark === FLOOR || mark === WALL) return;
    to.fillStyle = dangerous ? "#fff" : mark === HOME ? colour("--text") : "#161d2b";
    to.fillText(dangerous ? "▲" : mark === PLAIN ? "" : mark, (x + .5) * side, (y + .55) * side);
  }));
  to.lineWidth = 2;
  to.strokeStyle = colour("--red-text");
  to.setLineDash([3, 2]);
  for (const { column, row } of findings.filter(isPlaced)) to.strokeRect(column * side + 1, row * side + 1, side - 3, side - 3);
  to.setLineDash([]);
  paintAreas(to);
  to.strokeStyle = colour("--focus");
  if (anchor) for (const { x, y } of cellsOf(chosen("shape"), anchor, cursor)) to.strokeRect(x * side + 1, y * side + 1, side - 3, side - 3);
  to.lineWidth = 3;
  to.strokeRect(cursor.x * side + 1, cursor.y * side + 1, side - 3, side - 3);
}

/** Areas are tinted and framed cell by cell, and each has its name in its first row. */
function paintAreas(to) {
  to.lineWidth = 2;
  to.strokeStyle = to.fillStyle = colour("--carrier");
  for (const { name, corners } of hall.areas) {
    const cells = cellsIn(corners);
    to.beginPath();
    to.globalAlpha = .18;
    for (const cell of cells) {
      const [x, y] = cell.split(",").map(Number);
      to.fillRect(x * side, y * side, side, side);
      for (const [dx, dy] of Object.values(ARROWS)) {
        if (cells.has(`${x + dx},${y + dy}`)) continue;
        const [left, top] = [x + (dx > 0), y + (dy > 0)];
        to.moveTo(left * side, top * side);
        to.lineTo((left + (dx === 0)) * side, (top + (dy === 0)) * side);
      }
    }
    to.globalAlpha = 1;
    to.stroke();
    label(to, name, cells);
  }
  if (!outline.length) return;
  to.beginPath();
  for (const [x, y] of [...outline, [cursor.x, cursor.y]]) to.lineTo((x + .5) * side, (y + .5) * side);
  to.stroke();
  to.strokeRect(outline[0][0] * side + 1, outline[0][1] * side + 1, side - 3, side - 3);
}

function label(to, name, cells) {
  const [x, y] = [...cells][0].split(",").map(Number);
  const words = [...name].length > 24 ? `${[...name].slice(0, 23).join("")}…` : name;
  to.save();
  to.font = `600 ${Math.max(10, Math.min(12, side * .5))}px system-ui, sans-serif`;
  to.textAlign = "left";
  to.textBaseline = "top";
  const left = Math.max(2, Math.min(x * side + 4, width() * side - to.measureText(words).width - 2));
  to.lineWidth = 4;
  to.lineJoin = "round";
  to.strokeStyle = colour("--panel");
  to.strokeText(words, left, y * side + 3);
  to.fillText(words, left, y * side + 3);
  to.restore();
}

/** The list of the areas. Its fields stay in place, so that a field that has the keyboard keeps it. */
function showAreas() {
  const list = $("areas");
  while (list.children.length > hall.areas.length) list.lastElementChild.remove();
  while (list.children.length < hall.areas.length) list.append(areaRow());
  hall.areas.forEach(({ name, probability }, index) => {
    const row = list.children[index], [called, share] = row.querySelectorAll("input"), discard = row.querySelector("button");
    row.setAttribute("aria-label", name);
    called.value = name;
    share.value = probability;
    discard.textContent = say("editor-area-discard", { name });
    for (const field of [called, share, discard]) field.disabled = !mayAct;
  });
  $("rest").textContent = hall.areas.length ? say("editor-rest", { rest: rest() }) : "";
}

function areaRow() {
  const row = $("area-row").content.firstElementChild.cloneNode(true), [called, share] = row.querySelectorAll("input");
  const index = () => [...row.parentElement.children].indexOf(row);
  called.addEventListener("change", () => {
    const at = index();
    change(() => { hall.areas[at].name = called.value.trim(); });
  });
  share.addEventListener("change", () => {
    const number = share.value.trim() === "" ? NaN : Number(share.value.replace(",", "."));
    if (!(number >= 0 && number <= 1)) return tell(say("editor-probability"));
    const at = index();
    tell("");
    change(() => { hall.areas[at].probability = number; });
  });
  row.querySelector("button").addEventListener("click", () => {
    const at = index();
    canvas.focus();
    change(() => { hall.areas.splice(at, 1); });
  });
  return row;
}

const NAMES = { [FLOOR]: say("editor-floor"), [WALL]: say("editor-wall"), [HOME]: say("editor-home"), [PLAIN]: say("editor-luggage") };
const BEGUN = { brush: "editor-begun-brush", line: "editor-begun-line", rectangle: "editor-begun-rectangle" };

/** Something that a search would not come to, in words. */
const said = (found) => say(`editor-found-${found.code}`, found);

/** A cell of the drawing in words, counted from home as in the map. */
function placed(column, row, text, rows = hall.rows) {
  const home = Math.max(0, rows.findIndex((line) => line.includes(HOME)));
  return say("editor-at", { x: column - Math.max(0, rows[home].indexOf(HOME)), y: row - home, text });
}

/** Where something was found, if it is somewhere. */
const isPlaced = ({ column }) => column !== undefined;

/** What is under the cursor, for whoever does not see it. */
function under() {
  const mark = at(cursor.x, cursor.y);
  const bag = hall.bags[mark];
  const what = bag ? say(bag.dangerous ? "editor-dangerous" : "editor-marked", { mark }) : NAMES[mark] ?? mark;
  const found = findings.find(({ column, row }) => column === cursor.x && row === cursor.y);
  const area = hall.areas.find(({ corners }) => cellsIn(corners).has(`${cursor.x},${cursor.y}`));
  const begun = outline.length ? [say("editor-begun-outline", { corners: outline.length })] : [];
  const words = [what, ...(area ? [say("editor-in-area", area)] : []), ...begun, ...(found ? [said(found)] : []), ...(anchor ? [say(BEGUN[chosen("shape")])] : [])];
  return placed(cursor.x, cursor.y, words.join(", "));
}

function moved() {
  $("cursor").textContent = under();
  paint();
}

function showFields() {
  $("columns").value = width();
  $("rows").value = height();
  $("name").value = hall.head.match(/^name = "(.*)"$/m)?.[1] ?? "";
  showAreas();
  $("undo").disabled = !mayAct || !done.length;
  $("redo").disabled = !mayAct || !undone.length;
  $("download").href = `data:application/toml;charset=utf-8,${encodeURIComponent(text.value)}`;
  $("download").download = `${($("name").value || "hall").replaceAll(/[^\w-]/g, "-")}.toml`;
  if (!isNamed && document.activeElement !== $("keep-as")) $("keep-as").value = $("name").value.toLowerCase().replaceAll(/[^a-z0-9]+/g, "-").replaceAll(/^-|-$/g, "").slice(0, 40);
  $("cursor").textContent = under();
}

/** Takes a hall that the program has read. */
function take(toml, words) {
  const next = parse(toml);
  if (!next) return tell(say("editor-undrawable"));
  tell("");
  change(() => { hall = next; });
  $("cursor").textContent = words ?? under();
}

// ---- by pointer ----

function cellAt(event) {
  const { left, top } = canvas.getBoundingClientRect();
  const within = (value, size) => Math.max(0, Math.min(size - 1, Math.floor(value / side)));
  return { x: within(event.clientX - left, width()), y: within(event.clientY - top, height()) };
}

canvas.addEventListener("pointerdown", (event) => {
  if (event.button !== 0 || !mayAct) return;
  event.preventDefault();
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  cursor = cellAt(event);
  tell("");
  if (chosen("shape") === "brush") {
    stroke = { before: copy(), last: cursor };
    draw(cursor.x, cursor.y);
  } else if (isOutline()) {
    addCorner(cursor);
  } else {
    anchor = cursor;
  }
  moved();
});

canvas.addEventListener("pointermove", (event) => {
  if (!stroke && !outline.length && !(anchor && canvas.hasPointerCapture(event.pointerId))) return;
  cursor = cellAt(event);
  if (stroke) {
    for (const { x, y } of between(stroke.last, cursor)) draw(x, y);
    stroke.last = cursor;
  }
  moved();
});

canvas.addEventListener("pointerup", (event) => {
  if (stroke) {
    const { before } = stroke;
    stroke = null;
    remember(before);
  } else if (anchor && canvas.hasPointerCapture(event.pointerId)) {
    drawShape(cellAt(event));
  }
  moved();
});

canvas.addEventListener("pointercancel", () => {
  if (stroke) hall = JSON.parse(stroke.before);
  stroke = anchor = null;
  outline = [];
  moved();
});

// ---- by keyboard ----

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const CHOICES = { w: "wall", e: "floor", b: "bag", d: "danger", h: "home", a: "area", f: "brush", l: "line", r: "rectangle" };

canvas.addEventListener("keydown", (event) => {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (event.ctrlKey || event.metaKey) {
    const back = key === "z" && !event.shiftKey;
    if (!mayAct || !(key === "z" || key === "y")) return;
    event.preventDefault();
    return back ? step(done, undone) : step(undone, done);
  }
  if (event.altKey) return;
  if (ARROWS[key]) {
    const [dx, dy] = ARROWS[key];
    cursor = { x: Math.max(0, Math.min(width() - 1, cursor.x + dx)), y: Math.max(0, Math.min(height() - 1, cursor.y + dy)) };
    if (event.shiftKey && mayAct && chosen("shape") === "brush") change(() => draw(cursor.x, cursor.y));
  } else if (CHOICES[key]) {
    const choice = document.querySelector(`.tools input[value=${CHOICES[key]}]`);
    choice.checked ||= !choice.disabled;
    suit();
  } else if (key === "c") {
    anchor = null;
    outline = [];
  } else if ((key === " " || key === "Enter") && mayAct) {
    tell("");
    if (chosen("shape") === "brush") change(() => draw(cursor.x, cursor.y));
    else if (isOutline()) addCorner(cursor);
    else if (anchor) drawShape(cursor);
    else anchor = cursor;
  } else {
    return;
  }
  event.preventDefault();
  moved();
});

// ---- buttons and files ----

$("keep-as").addEventListener("input", () => { isNamed = true; });
$("undo").addEventListener("click", () => step(done, undone));
$("redo").addEventListener("click", () => step(undone, done));

$("size").addEventListener("submit", (event) => {
  event.preventDefault();
  const columns = Number($("columns").value), rows = Number($("rows").value), name = $("name").value.trim();
  if (!(columns >= 1 && rows >= 1 && columns <= most && rows <= most)) return tell(say("editor-sides", { most }));
  const home = hall.rows.findIndex((row) => row.includes(HOME));
  if (home >= rows || hall.rows[home].indexOf(HOME) >= columns) return tell(say("editor-home-outside"));
  tell("");
  change(() => {
    const line = (row = "") => row.slice(0, columns).padEnd(columns, FLOOR);
    hall.rows = Array.from({ length: rows }, (_, y) => line(hall.rows[y]));
    const head = hall.head.replace(/^name = .*\n/m, "");
    hall.head = name ? `name = ${JSON.stringify(name)}\n${head}` : head;
  });
});

$("file").addEventListener("change", async () => {
  const files = [...$("file").files];
  const ends = (file, ...endings) => endings.some((ending) => file.name.toLowerCase().endsWith(ending));
  const image = files.find((file) => ends(file, ".pgm", ".png"));
  const yaml = files.find((file) => ends(file, ".yaml", ".yml"));
  const file = yaml ?? image ?? files[0];
  if (!file) return;
  let name = file.name, body = file;
  if (image) {
    const metres = Number($("resolution").value.replace(",", "."));
    const words = yaml ? await yaml.text()
      : `image: ${image.name}\nresolution: ${metres}\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n`;
    body = new Blob([words.replace(/\n*$/, "\n"), "...\n", image]);
    name = yaml?.name ?? image.name.replace(/\.\w+$/, ".yaml");
  }
  const answer = await read(name, body);
  $("file").value = "";
  if (answer.why) return tell(answer.why);
  $("opened")?.remove(); // it is another hall now
  isNamed = false;
  take(answer.toml, say("editor-open", { ...answer, file: file.name }));
});

text.addEventListener("input", () => {
  unchecked();
  paint();
});

text.addEventListener("change", async () => {
  const answer = await read("hall.toml", new Blob([text.value]));
  await released();
  if (!answer.why) take(answer.toml); // what is wrong the check says
});

/** An area has corners, so the brush draws none. */
function suit() {
  const [brush, rectangle] = ["brush", "rectangle"].map((shape) => document.querySelector(`.tools input[value=${shape}]`));
  const isArea = chosen("tool") === "area";
  if (isArea && brush.checked) rectangle.checked = true;
  brush.disabled = !mayAct || isArea;
  if (!isOutline()) outline = [];
}

for (const input of document.querySelectorAll(".tools input")) {
  input.disabled = !mayAct;
  input.addEventListener("change", () => { anchor = null; suit(); moved(); });
}
for (const field of $("size").elements) field.disabled = !mayAct;

const first = parse(text.value);
if (first) {
  hall = first;
  cursor = { x: Math.max(0, ...hall.rows.map((row) => row.indexOf(HOME))), y: Math.max(0, hall.rows.findIndex((row) => row.includes(HOME))) };
  $("draw").append($("acts"), $("said")); // what is done with the drawing stands under it
  $("check").hidden = true; // it is checked by itself
  $("draw").hidden = false;
  showFields();
  paint();
  if (mayAct) check();
  new ResizeObserver(paint).observe($("sheet"));
  addEventListener("themechange", paint);
}
