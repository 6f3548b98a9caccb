// The pallet scenario on the laboratory's page: the yard from above, what happens in words, and the three trees, moved by one player.
// Without this script the page shows a drawing, and the trees at the end; what happened is computed by the program and fetched as it is.

import { element, player, fetched, written } from "./laboratory.js";
import { trees, upTo } from "./trees.js";

const section = document.getElementById("pallet");
const find = (selector) => section.querySelector(selector);
const TRAIL_S = 12; // so much of the ways driven is drawn
const RADIUS = 0.4; // of a robot, in cells, as everything below
const PARCEL = 0.6;
const BORDER = 0.5; // so much wall is drawn round the floor
const REACH = 0.55; // of an arm that holds nothing, from the middle of its robot
const JAW = { open: 0.24, closed: 0.1 }; // half the distance of a gripper's fingers
const FIGURES = { // what is held, in the order of a frame: its unit, what makes it from the number, and the places behind the point
  force: { limits: "forceN", unit: "N", times: 1, places: 1 },
  angle: { limits: "angleRad", unit: "mrad", times: 1000, places: 0 },
  gap: { limits: "gapM", unit: "mm", times: 1000, places: 1 },
};

const mix = (one, other, share) => one + (other - one) * share;
const mixAll = (one, other, share) => one.map((number, index) => mix(number, other[index], share));

/** How everything stands between two frames. What is in the grippers is not mixed with what is not. */
function between(one, other, t) {
  const share = other.t > one.t ? Math.min(Math.max((t - one.t) / (other.t - one.t), 0), 1) : 0;
  const body = ([x, y, theta, closed], [toX, toY, toTheta]) => {
    const turned = Math.atan2(Math.sin(toTheta - theta), Math.cos(toTheta - theta));
    return { x: mix(x, toX, share), y: mix(y, toY, share), theta: theta + turned * share, closed };
  };
  const both = (from, to) => (from && to ? mixAll(from, to, share) : from);
  return {
    bodies: one.bodies.map((from, index) => body(from, other.bodies[index])),
    load: both(one.load, other.load), held: both(one.held, other.held), delivered: one.delivered,
  };
}

/** The yard from above. */
class Yard {
  constructor(told, frames) {
    Object.assign(this, { told, yard: told.yard, frames, canvas: find("canvas") });
    find(".drawn").hidden = true;
    this.canvas.hidden = false;
    this.fit();
  }

  /** As many dots as the screen has for the place, and the floor anew. */
  fit() {
    const { least, most } = this.yard;
    const [columns, rows] = [most[0] - least[0] + 1 + 2 * BORDER, most[1] - least[1] + 1 + 2 * BORDER];
    this.side = Math.max(4, (this.canvas.clientWidth * devicePixelRatio) / columns);
    this.colours = getComputedStyle(section);
    this.floor ??= document.createElement("canvas");
    for (const canvas of [this.canvas, this.floor]) {
      canvas.width = Math.round(columns * this.side);
      canvas.height = Math.round(rows * this.side);
    }
    this.context = this.floor.getContext("2d");
    this.paint();
    this.context = this.canvas.getContext("2d");
  }

  colour(name) {
    return this.colours.getPropertyValue(`--${name}`).trim();
  }

  /** Where the middle of a cell is drawn, and of a place in metres. */
  cell([x, y]) {
    return [(x - this.yard.least[0] + 0.5 + BORDER) * this.side, (y - this.yard.least[1] + 0.5 + BORDER) * this.side];
  }

  metres(x, y) {
    return this.cell([x / this.yard.cellM, y / this.yard.cellM]);
  }

  square([x, y], side, fill) {
    this.context.fillStyle = this.colour(fill);
    this.context.fillRect(x - side / 2, y - side / 2, side, side);
  }

  text([x, y], words, size, fill) {
    const { context } = this;
    Object.assign(context, { font: `700 ${size}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle", fillStyle: this.colour(fill) });
    context.fillText(words, x, y);
  }

  /** How many parcels the target area has taken in: over whatever stands there, with an edge of its own. */
  count([x, y], words) {
    const { context, side } = this;
    Object.assign(context, { strokeStyle: this.colour("floor"), lineWidth: side * 0.14, lineJoin: "round", font: `700 ${side * 0.5}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle" });
    context.strokeText(words, x, y);
    this.text([x, y], words, side * 0.5, "text");
  }

  /** What never changes. */
  paint() {
    const { least, most, walls, pallet, target } = this.yard;
    const { context, floor, side } = this;
    context.fillStyle = this.colour("wall-yard");
    context.fillRect(0, 0, floor.width, floor.height);
    const isWall = new Set(walls.map(String));
    const free = side - Math.max(1, side / 28);
    for (let y = least[1]; y <= most[1]; y += 1) {
      for (let x = least[0]; x <= most[0]; x += 1) {
        if (!isWall.has(String([x, y]))) this.square(this.cell([x, y]), free, "floor");
      }
    }
    for (const cell of pallet) this.square(this.cell(cell), free, "pallet");
    if (target) this.square(this.cell(target), free, "target");
  }

  /** The ways of the last seconds. */
  trails(t, now) {
    const { context, side, frames } = this;
    const first = Math.max(upTo(frames, t - TRAIL_S) - 1, 0);
    const past = frames.slice(first, upTo(frames, t));
    Object.assign(context, { lineJoin: "round", lineCap: "round" });
    const way = (points, colour, width) => {
      Object.assign(context, { strokeStyle: this.colour(colour), lineWidth: width * side });
      context.setLineDash(colour === "two" ? [0.18 * side, 0.16 * side] : []); // it follows SRM1, who is to be seen below
      context.beginPath();
      points.forEach((point, index) => (point && (index > 0 && points[index - 1] ? context.lineTo(...point) : context.moveTo(...point))));
      context.stroke();
    };
    const load = (one) => one.load && this.metres(one.load[0], one.load[1]);
    way([...past, now].map(load), "carried", 0.2);
    [0, 1].forEach((which) => way([...past.map(({ bodies }) => this.metres(bodies[which][0], bodies[which][1])),
      this.metres(now.bodies[which].x, now.bodies[which].y)], ["one", "two"][which], 0.07));
    context.setLineDash([]);
  }

  parcel(at, height) {
    const { context, side } = this;
    const size = PARCEL * (1 + 0.18 * height) * side;
    context.save();
    if (height > 0) Object.assign(context, { shadowColor: "rgb(0 0 0 / .55)", shadowBlur: 0.3 * height * side, shadowOffsetY: 0.16 * height * side });
    this.square(at, size, "parcel");
    context.restore();
    Object.assign(context, { strokeStyle: this.colour("parcel-edge"), lineWidth: Math.max(1, side * 0.05) });
    context.strokeRect(at[0] - size / 2, at[1] - size / 2, size, size);
    context.beginPath(); // its tape
    context.moveTo(at[0] - size / 2, at[1]);
    context.lineTo(at[0] + size / 2, at[1]);
    context.stroke();
  }

  /** A body with its nose and its number, and its arm: towards the parcel in the grippers, else ahead. */
  robot(which, body, load) {
    const { context, side } = this;
    const [x, y] = this.metres(body.x, body.y);
    const [toX, toY] = load ? this.metres(load[0], load[1]) : [x + Math.cos(body.theta), y + Math.sin(body.theta)];
    const distance = Math.hypot(toX - x, toY - y) || 1;
    const [ux, uy] = [(toX - x) / distance, (toY - y) / distance];
    const reach = load ? Math.max(distance / side - PARCEL / 2, RADIUS) : REACH;
    const jaw = body.closed && !load ? JAW.closed : JAW.open;
    const at = (along, across) => [x + (ux * along - uy * across) * side, y + (uy * along + ux * across) * side];
    Object.assign(context, { strokeStyle: this.colour("arm-yard"), lineWidth: 0.09 * side, lineCap: "round", lineJoin: "round" });
    const fingers = load ? 0 : 0.14; // a paddle lies against the parcel
    const lines = [[at(0, 0), at(reach, 0)], [at(reach + fingers, -jaw), at(reach, -jaw), at(reach, jaw), at(reach + fingers, jaw)]];
    for (const points of lines) {
      context.beginPath();
      points.forEach((point, index) => (index ? context.lineTo(...point) : context.moveTo(...point)));
      context.stroke();
    }
    const name = ["one", "two"][which];
    context.fillStyle = this.colour(name);
    context.beginPath();
    context.arc(x, y, RADIUS * side, 0, 2 * Math.PI);
    context.fill();
    const on = (angle, far) => [x + Math.cos(body.theta + angle) * far * side, y + Math.sin(body.theta + angle) * far * side];
    context.beginPath(); // the nose: a point on the side it faces
    [on(-0.6, RADIUS), on(0, RADIUS * 1.42), on(0.6, RADIUS)].forEach((point, index) => (index ? context.lineTo(...point) : context.moveTo(...point)));
    context.fill();
    this.text([x, y + side * 0.02], which + 1, side * 0.42, "on-robot");
  }

  show(t, now) {
    const { context, side, yard } = this;
    context.drawImage(this.floor, 0, 0);
    this.trails(t, now);
    const lying = this.told.lying[Math.max(upTo(this.lying, t) - 1, 0)];
    for (const cell of lying[1]) this.parcel(this.cell(cell), 0);
    if (yard.target && now.delivered > 0) this.parcel(this.cell(yard.target), 0);
    if (now.load && now.load[2] <= 0) this.parcel(this.metres(now.load[0], now.load[1]), 0);
    now.bodies.forEach((body, which) => this.robot(which, body, now.load));
    if (now.load && now.load[2] > 0) this.parcel(this.metres(now.load[0], now.load[1]), now.load[2]);
    if (yard.target && now.delivered > 0) {
      const [x, y] = this.cell(yard.target);
      this.count([x + side * 0.5, y - side * 0.5], `${now.delivered}×`);
    }
  }

  get lying() {
    return (this.changes ??= this.told.lying.map(([t]) => ({ t })));
  }
}

/** What happens, in words and figures. Every place keeps its size, whatever stands in it. */
class Words {
  constructor(told, go) {
    Object.assign(this, { told, list: find(".events"), stage: find(".stage"), calls: find(".calls") });
    this.lines = [...this.list.children];
    // The page has them in its language; what was fetched is in English.
    this.words = new Map(told.events.map((event, index) => [event, this.lines[index].dataset.words]));
    this.lines.forEach((line, index) => {
      const jump = element("button", { type: "button", className: "jump", textContent: line.querySelector(".seq").textContent });
      jump.setAttribute("aria-label", say("pallet-show", { time: jump.textContent }));
      jump.addEventListener("click", () => go(told.events[index].t));
      line.querySelector(".seq").replaceWith(jump);
    });
    for (const place of [this.stage, this.calls, find(".held")]) place.hidden = false;
    find(".still").hidden = true;
    this.figures = Object.entries(FIGURES).map(([name, about]) => {
      const [least, most] = told.limits[about.limits];
      const place = find(`[data-figure="${name}"]`);
      return { ...about, least, most, value: place.querySelector("dd"), needle: place.querySelector("circle") };
    });
  }

  show(t, now) {
    const { events, parcels, seconds, fault } = this.told;
    const last = upTo(events, t) - 1;
    this.follow(last);
    const past = events.slice(0, last + 1);
    const phase = past.findLast(({ kind }) => kind === "phase");
    const parcel = say(!now.load ? "pallet-nothing-held" : now.load[2] > 0 ? "pallet-lifted" : "pallet-on-floor");
    const stage = phase ? say("pallet-phase", { phase: phase.phase, parcel: phase.parcel, parcels }) : say("pallet-before");
    const what = phase ? this.words.get(phase) : say("pallet-at-the-start");
    const where = say("pallet-where", { delivered: now.delivered, parcels, parcel });
    if (this.staged !== stage + where) {
      this.staged = stage + where;
      this.stage.replaceChildren(element("strong", { textContent: stage }), ` ${what}`, element("span", { className: "quiet", textContent: where }));
    }
    const waits = past.findLast(({ kind }) => ["alarm", "acknowledged", "start"].includes(kind));
    const end = t >= seconds;
    const calls = end && fault ? this.calls.dataset.ended
      : end ? say("pallet-all-there")
      : waits?.kind === "alarm" ? this.words.get(waits)
      : say(waits?.kind === "acknowledged" ? "pallet-acknowledged" : "pallet-nothing-waits");
    if (this.calls.textContent !== calls) this.calls.textContent = calls;
    this.calls.className = `calls ${!end && (!waits || waits.kind === "start") ? "" : end && !fault ? "well" : waits?.kind === "acknowledged" && !end ? "waits" : "alarm"}`;
    this.figures.forEach((figure, index) => this.figure(figure, now.held?.[index]));
  }

  figure({ unit, times, places, least, most, value, needle }, held) {
    const write = (number) => written(number * times, places).replace("-", "−");
    value.textContent = held === undefined ? `– ${unit}` : `${write(held)} ${unit}`;
    needle.toggleAttribute("hidden", held === undefined);
    const share = held === undefined ? 0.5 : Math.min(Math.max((held - least) / (most - least), -0.06), 1.06);
    needle.setAttribute("cx", 10 + share * 100);
    needle.setAttribute("class", held !== undefined && (held < least || held > most) ? "beyond" : "");
  }

  /** Marks the line that is due, and keeps it in sight within the list. */
  follow(last) {
    if (last === this.last) return;
    this.last = last;
    this.lines.forEach((line, index) => {
      line.classList.toggle("later", index > last);
      if (index === last) line.setAttribute("aria-current", "true");
      else line.removeAttribute("aria-current");
    });
    const line = this.lines[Math.max(last, 0)];
    if (line) this.list.scrollTop = line.offsetTop - (this.list.clientHeight - line.offsetHeight) / 2;
  }
}

async function begin() {
  const told = await fetched(section.dataset.run);
  const frames = told.frames.map(([t, one, two, load, held, delivered]) => ({ t, bodies: [one, two], load, held, delivered }));
  const yard = new Yard(told, frames);
  let played;
  const words = new Words(told, (t) => {
    played.pause();
    played.go(t);
  });
  const moveTrees = trees(section.querySelector("#trees"), section.querySelector("#blackboard"), told);
  played = player(find(".player"), {
    name: "pallet", labels: { slider: say("pallet-slider"), player: say("pallet-player") }, seconds: told.seconds, show: (t) => {
      const at = Math.max(upTo(frames, t) - 1, 0);
      const now = between(frames[at], frames[Math.min(at + 1, frames.length - 1)], t);
      yard.show(t, now);
      words.show(t, now);
      moveTrees(t);
    },
  });
  const anew = () => {
    yard.fit();
    played.again();
  };
  new ResizeObserver(anew).observe(yard.canvas);
  addEventListener("themechange", anew);
}

begin().catch((error) => {
  const place = find(".player");
  place.replaceChildren(element("p", { className: "why", textContent: say("laboratory-cannot-move", { why: error.message }) }));
  place.hidden = false;
});
