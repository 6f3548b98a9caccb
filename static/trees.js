// Trees that stand on a page, moved through the log of their ticks. The page shows all nodes, in preorder (templates/console/trees.html),
// and the blackboard; here it only changes how they stand. When what is shown is the business of whoever uses it.

import { element } from "./laboratory.js";

const SIGNS = { IDLE: "○", RUNNING: "▶", SUCCESS: "✓", FAILURE: "✗", SKIPPED: "⤼" };
const WORDS = { IDLE: "trees-idle", RUNNING: "trees-running", SUCCESS: "trees-success", FAILURE: "trees-failure", SKIPPED: "trees-skipped" };

/** How many of these, sorted by their `t`, were at this time or before. */
export function upTo(list, t) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle].t <= t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Draws a node as it stands. */
function draw(row, [status, isTicked]) {
  row.className = `node ${status.toLowerCase()}${isTicked ? " ticked" : ""}`;
  row.querySelector("i").textContent = SIGNS[status];
  row.querySelector("span").textContent = say(WORDS[status]);
}

/** Moves the trees in `place` and the blackboard `board` to the time that the returned function is called with, as `told` by the program. */
export function trees(place, board, told) {
  const rows = [...place.querySelectorAll(".tree")].map((tree) => [...tree.querySelectorAll(".node")]);
  // Sorting keeps the order of the trees in which they are ticked at one time.
  const ticks = told.trees.flatMap(({ ticks }, tree) => ticks.map((tick) => ({ tree, ...tick }))).sort((one, other) => one.t - other.t);
  let stood, entries, done;

  function begin() {
    stood = told.trees.map(({ nodes }) => nodes.map(() => ["IDLE", false]));
    entries = new Map();
    done = 0;
  }

  function apply({ tree, nodes, entries: written }) {
    for (const [index, status, isTicked] of nodes) stood[tree][index] = [status, isTicked];
    for (const [name, value] of Object.entries(written)) {
      if (value === null) entries.delete(name);
      else entries.set(name, value);
    }
  }

  function write() {
    const line = ([name, value]) => {
      const held = value === "" ? element("span", { className: "quiet", textContent: say("trees-empty") }) : value;
      return element("div", {}, element("dt", { textContent: name }), element("dd", {}, held));
    };
    board.querySelector("dl").replaceChildren(...[...entries].sort(([one], [other]) => (one < other ? -1 : 1)).map(line));
    board.querySelector("h3 span").textContent = say("trees-tick", { tick: Math.max(0, ...ticks.slice(0, done).slice(-told.trees.length).map(({ tick }) => tick)) });
  }

  let shown = [];
  begin();
  return (t) => {
    const until = upTo(ticks, t);
    if (until === done && shown.length > 0) return;
    if (until < done) begin();
    for (; done < until; done += 1) apply(ticks[done]);
    stood.forEach((nodes, tree) => nodes.forEach((node, index) => {
      if (String(shown[tree]?.[index]) !== String(node)) draw(rows[tree][index], node);
    }));
    shown = stood.map((nodes) => [...nodes]);
    write();
  };
}
