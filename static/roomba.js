// The Roomba on the laboratory's page: machine and tree side by side, moved by one player. Without this script the page shows both
// as drawings; what happened in a run is computed by the program and fetched as it is.

import { element, player, fetched, written } from "./laboratory.js";

const section = document.getElementById("roomba");
const [T, X, Y, THETA, PHASE, PASSED] = [0, 1, 2, 3, 4, 5]; // of a frame
const ROUNDED = 1e-4; // a frame's time is rounded to this, a transition's is not
const COLOURS = { MoveForward: "--forward", MoveInSpiral: "--spiral", GoBack: "--back", Rotate: "--turn" };

/** How many of these, sorted by time, were at `t` or before. */
function upTo(list, t, timeOf) {
  const latest = t + ROUNDED;
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timeOf(list[middle]) <= latest) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Where the robot is between two frames. */
function between(one, other, t) {
  const share = other[T] > one[T] ? Math.max(t - one[T], 0) / (other[T] - one[T]) : 0;
  const turned = other[THETA] - one[THETA];
  const short = Math.atan2(Math.sin(turned), Math.cos(turned));
  return [one[X] + (other[X] - one[X]) * share, one[Y] + (other[Y] - one[Y]) * share, one[THETA] + short * share];
}

/** One room, drawn up to a time. What was passed over and driven stays on layers, to which only what is new is added. */
class Room {
  constructor(figure, told, run) {
    Object.assign(this, { told, run, canvas: figure.querySelector("canvas"), now: figure.querySelector(".now") });
    this.diagram = figure.querySelector(".diagram");
    this.floor = document.createElement("canvas");
    this.way = document.createElement("canvas");
    this.done = 0;
    figure.querySelector(".drawn").hidden = true;
    this.canvas.hidden = false;
    this.now.hidden = false;
    this.fit();
  }

  /** As many dots as the screen has for the place; everything is to be drawn anew. */
  fit() {
    const width = Math.max(1, Math.round(this.canvas.clientWidth * devicePixelRatio));
    const { lengthM, widthM } = this.told.room;
    this.scale = width / lengthM;
    for (const canvas of [this.canvas, this.floor, this.way]) {
      canvas.width = width;
      canvas.height = Math.round(widthM * this.scale);
    }
    this.done = 0;
  }

  colour(name) {
    return getComputedStyle(section).getPropertyValue(name).trim();
  }

  /** Adds the frames from the last one that is drawn to this one, or begins anew when that is behind. */
  draw(last) {
    if (last < this.done) {
      for (const canvas of [this.floor, this.way]) canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
      this.done = 0;
    }
    const { frames } = this.run;
    const floor = this.floor.getContext("2d");
    Object.assign(floor, { lineCap: "round", lineJoin: "round", lineWidth: 2 * this.told.robot.radiusM * this.scale });
    floor.strokeStyle = this.colour("--passed");
    floor.beginPath();
    floor.moveTo(frames[this.done][X] * this.scale, frames[this.done][Y] * this.scale);
    for (let index = this.done; index <= last; index += 1) floor.lineTo(frames[index][X] * this.scale, frames[index][Y] * this.scale);
    floor.stroke();
    const way = this.way.getContext("2d");
    Object.assign(way, { lineCap: "round", lineJoin: "round", lineWidth: 0.025 * this.scale });
    for (let index = this.done + 1; index <= last;) {
      const phase = frames[index][PHASE];
      way.strokeStyle = this.colour(COLOURS[this.told.phases[phase]]);
      way.beginPath();
      way.moveTo(frames[index - 1][X] * this.scale, frames[index - 1][Y] * this.scale);
      while (index <= last && frames[index][PHASE] === phase) {
        way.lineTo(frames[index][X] * this.scale, frames[index][Y] * this.scale);
        index += 1;
      }
      way.stroke();
    }
    this.done = last;
  }

  show(t) {
    const { frames, transitions } = this.run;
    const at = upTo(frames, t, (frame) => frame[T]) - 1;
    this.draw(at);
    const context = this.canvas.getContext("2d");
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.floor, 0, 0);
    context.drawImage(this.way, 0, 0);
    const past = transitions.slice(0, upTo(transitions, t, (change) => change.t));
    const walls = past.filter((change) => change.to === "GoBack");
    for (const wall of walls) this.mark(context, wall);
    const next = frames[Math.min(at + 1, frames.length - 1)];
    this.body(context, between(frames[at], next, t));
    const phase = past.at(-1)?.to ?? this.told.phases[frames[0][PHASE]];
    this.diagram.dataset.at = phase;
    this.diagram.dataset.from = walls.at(-1)?.from ?? "";
    const share = (100 * frames[at][PASSED]) / this.run.figures.reachableSquares;
    this.now.textContent = say("roomba-now", { phase, share: written(share, 1), walls: walls.length });
  }

  /** The wall that was met at a transition: a dot where the body touched it. */
  mark(context, wall) {
    const frame = this.run.frames[upTo(this.run.frames, wall.t, (one) => one[T]) - 1];
    const { room: { lengthM, widthM }, robot: { radiusM } } = this.told;
    const near = (at, most) => (at <= radiusM + 1e-3 ? 0 : at >= most - radiusM - 1e-3 ? most : at);
    context.fillStyle = this.colour("--wall-met");
    context.beginPath();
    context.arc(near(frame[X], lengthM) * this.scale, near(frame[Y], widthM) * this.scale, 0.05 * this.scale, 0, 2 * Math.PI);
    context.fill();
  }

  body(context, [x, y, theta]) {
    const [cx, cy, r] = [x * this.scale, y * this.scale, this.told.robot.radiusM * this.scale];
    context.fillStyle = this.colour("--robot-body");
    context.strokeStyle = this.colour("--edge");
    context.lineWidth = 0.03 * this.scale;
    context.beginPath();
    context.arc(cx, cy, r, 0, 2 * Math.PI);
    context.fill();
    context.moveTo(cx, cy);
    context.lineTo(cx + r * Math.cos(theta), cy + r * Math.sin(theta));
    context.stroke();
  }
}

async function begin() {
  const told = await fetched(section.dataset.runs);
  const figure = (run) => section.querySelector(`figure[data-controller="${run.controller}"]`);
  const rooms = told.runs.map((run) => new Room(figure(run), told, run));
  const played = player(section.querySelector(".player"), {
    name: "Roomba", labels: { slider: say("roomba-slider"), player: say("roomba-player") }, seconds: told.seconds, show: (t) => rooms.forEach((room) => room.show(t)),
  });
  const anew = () => {
    rooms.forEach((room) => room.fit());
    played.again();
  };
  new ResizeObserver(anew).observe(rooms[0].canvas);
  addEventListener("themechange", anew);
}

begin().catch((error) => {
  const place = section.querySelector(".player");
  place.replaceChildren(element("p", { className: "why", textContent: say("laboratory-cannot-move", { why: error.message }) }));
  place.hidden = false;
});
