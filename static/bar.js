// The bar of every page but the console, which has its own: what is so in the hall, asked for every second and rendered by the server.
// Without an answer the bar turns grey, keeps the time that it shows, and the page says that it is not live.
"use strict";

(() => {
  const LOOK_MS = 1000;
  const SILENCE_MS = 3000; // an answer that takes longer is given up; after this the bar is not to be believed
  const place = document.getElementById("elsewhere");
  const why = place.querySelector(".why");
  let heard = performance.now();
  let isAsking = false;

  async function look() {
    if (isAsking || document.hidden) return;
    isAsking = true;
    try {
      const answer = await fetch("./console/bar", { redirect: "error", signal: AbortSignal.timeout(SILENCE_MS) });
      const markup = await answer.text();
      if (typeof stopping !== "undefined") stopping.connected();
      if (answer.ok) document.getElementById("bar").outerHTML = markup;
      if (document.querySelector("#bar .is-simulated")) document.documentElement.dataset.simulated = "";
      if (answer.ok) heard = performance.now();
      if (answer.status === 401) why.textContent = why.dataset.over;
    } catch {
      // Silence is what tick() tells.
    }
    isAsking = false;
    tick();
  }

  function tick() {
    if (document.hidden) return;
    const isOld = performance.now() - heard > SILENCE_MS;
    place.classList.toggle("old", isOld);
    why.hidden = !isOld;
  }

  document.addEventListener("visibilitychange", () => {
    heard = performance.now();
    look();
  });
  setInterval(() => {
    tick();
    look();
  }, LOOK_MS);
  look();
})();
