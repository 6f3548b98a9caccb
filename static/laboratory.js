// The laboratory's player: start, pause, speed and a slider over the time of something that was computed before. What is shown at a
// time is the business of whoever uses it: roomba.js.

const SPEEDS = [1, 4, 16];
const STEP_S = 0.1; // of the slider
const LONG_S = 0.1; // a picture that took longer was not seen: the page was hidden
const CALM_MS = 1000; // where motion is to be reduced, a picture stands so long before the next one

const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** An element with these properties and these children. */
export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** Fills `place` with the controls over `seconds`; `show` is called with every time that is to be seen, at first with `from`. */
export function player(place, { name, seconds, show, from = 0 }) {
  let time = from;
  let speed = SPEEDS[0];
  let playing = false;
  let last = 0; // when the clock was looked at
  let shown = -Infinity; // when a picture was changed

  const button = element("button", { type: "button", className: "start loud" });
  const slider = element("input", { type: "range", min: 0, max: Math.ceil(seconds / STEP_S) * STEP_S, step: STEP_S });
  slider.setAttribute("aria-label", `Time of the ${name}, in seconds`);
  const clock = element("output", { className: "num" });
  const choice = (times) => {
    const radio = element("input", { type: "radio", name: `speed-${name}`, value: times, checked: times === speed });
    radio.addEventListener("change", () => { speed = times; });
    return element("label", {}, radio, `${times}×`);
  };
  const speeds = element("fieldset", { className: "speeds" }, element("legend", { textContent: "Speed" }), ...SPEEDS.map(choice));
  place.replaceChildren(button, speeds, slider, clock);
  place.setAttribute("role", "group");
  place.setAttribute("aria-label", `Player of the ${name}`);
  place.hidden = false;

  function go(to) {
    time = Math.min(Math.max(to, 0), seconds);
    slider.value = time;
    slider.setAttribute("aria-valuetext", `${time.toFixed(1)} of ${seconds} seconds`);
    clock.textContent = `${time.toFixed(1)} of ${seconds} s`;
    show(time);
  }

  function label() {
    button.textContent = playing ? "Pause" : "Start";
  }

  function pause() {
    playing = false;
    label();
  }

  function start() {
    if (time >= seconds) go(0);
    playing = true;
    last = performance.now();
    label();
    requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!playing) return;
    if (!calm.matches || now - shown >= CALM_MS) {
      const most = calm.matches ? CALM_MS / 1000 + LONG_S : LONG_S;
      const passed = Math.min(Math.max(now - last, 0) / 1000, most);
      last = now;
      shown = now;
      go(time + passed * speed);
      if (time >= seconds) return pause();
    }
    requestAnimationFrame(tick);
  }

  button.addEventListener("click", () => (playing ? pause() : start()));
  slider.addEventListener("input", () => go(Number(slider.value)));
  label();
  go(time);
  /** `again` shows the same time anew, as after a change of size or colours; `go` another one. */
  return { again: () => show(time), go, pause };
}
