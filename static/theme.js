// Light, dark, or as the system says: chosen once for all pages of this browser. It runs before anything is drawn, so it also tells the
// styles that scripts run. Pages that draw on a canvas are told by the event `themechange`.
"use strict";

(() => {
  const KEY = "hallsweep-theme";
  // Colours that a canvas asks for: as colours they are given resolved, the light or the dark one.
  const DRAWN = "visited wall bag grid carrier panel red text red-text focus floor passed forward spiral back turn wall-met edge robot-body wall-yard target pallet "
    + "parcel parcel-edge carried one two arm-yard on-robot";
  const kept = () => {
    try {
      return localStorage.getItem(KEY) ?? "";
    } catch {
      return ""; // Without a memory the system's choice holds.
    }
  };

  function show(theme) {
    if (theme) document.documentElement.dataset.theme = theme;
    else delete document.documentElement.dataset.theme;
    dispatchEvent(new Event("themechange"));
  }

  document.documentElement.dataset.scripts = "";
  for (const name of DRAWN.split(" ")) CSS.registerProperty({ name: `--${name}`, syntax: "<color>", inherits: true, initialValue: "transparent" });

  show(kept());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => dispatchEvent(new Event("themechange")));
  addEventListener("storage", (event) => event.key === KEY && show(event.newValue));
  addEventListener("DOMContentLoaded", () => {
    const choice = document.getElementById("theme");
    if (!choice) return;
    choice.value = kept();
    choice.addEventListener("change", () => {
      show(choice.value);
      try {
        localStorage.setItem(KEY, choice.value);
      } catch {
        // Then it holds for this page.
      }
    });
  });
})();
