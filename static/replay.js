// A retrieval that is on record, moved through its time: trees, blackboard and the list of what happened follow the player. Without this
// script the page shows one moment, and links to the others.

import { element, player, fetched } from "./laboratory.js";
import { trees, upTo } from "./trees.js";

const section = document.getElementById("replay");
const place = section.querySelector(".player");

async function begin() {
  const told = await fetched(section.dataset.record);
  const show = trees(document.getElementById("trees"), document.getElementById("blackboard"), told);
  const lines = [...document.querySelectorAll("#happened li")];
  section.querySelector(".moments").hidden = true;
  section.querySelector("h2 span").hidden = true;
  player(place, {
    name: "retrieval", labels: { slider: say("replay-slider"), player: say("replay-player") }, seconds: told.seconds, show: (t) => {
      show(t);
      const last = upTo(told.events, t) - 1;
      lines.forEach((line, index) => (index === last ? line.setAttribute("aria-current", "true") : line.removeAttribute("aria-current")));
    },
  });
}

if (place) {
  begin().catch((error) => {
    place.replaceChildren(element("p", { className: "why", textContent: say("replay-cannot-move", { why: error.message }) }));
    place.hidden = false;
  });
}
