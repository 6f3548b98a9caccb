// Areas are dragged into another order. Without this script the buttons of each row do the same.
"use strict";
{
  let dragged = null; // the row under way
  let before = []; // the rows as the server has ordered them
  const list = () => document.querySelector("#areas ul");
  const row = ({ target }) => target.closest?.("#areas li");

  /** Puts the rows as they were: another order is shown when the server shows it. */
  function restore() {
    list()?.append(...before.filter((item) => item.isConnected));
    for (const item of before) item.classList.remove("dragged");
    if (list()) delete list().dataset.touched;
    dragged = null;
  }

  document.addEventListener("pointerdown", (event) => {
    const item = row(event);
    const isFree = event.pointerType === "mouse" && !event.target.closest("button, a") && item?.querySelector("button");
    if (item) item.draggable = Boolean(isFree);
  });

  document.addEventListener("dragstart", (event) => {
    if (!row(event)?.draggable) return;
    [dragged, before] = [row(event), [...list().children]];
    dragged.classList.add("dragged");
    event.dataTransfer.setData("text/plain", dragged.dataset.area);
    list().dataset.touched = "yes"; // what comes from the server meanwhile does not move the rows
  });

  document.addEventListener("dragover", (event) => {
    if (!dragged || !event.target.closest?.("#areas")) return;
    event.preventDefault();
    const over = row(event);
    if (!over || over === dragged) return;
    const { top, height } = over.getBoundingClientRect();
    over[event.clientY < top + height / 2 ? "before" : "after"](dragged);
  });

  document.addEventListener("drop", (event) => {
    if (!dragged) return;
    event.preventDefault();
    const form = dragged.closest("form");
    const shown = form.elements.areas.value;
    form.elements.areas.value = [...list().children].map((item) => item.dataset.area).join("\n");
    form.requestSubmit();
    form.elements.areas.value = shown;
    restore();
  });

  document.addEventListener("dragend", () => dragged && restore());
}
