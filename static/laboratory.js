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

/** A number as the language of the page writes it, with so many places behind the point where that is said. */
export function written(number, places) {
  return number.toLocaleString(document.documentElement.lang, { minimumFractionDigits: places, maximumFractionDigits: places ?? 4, useGrouping: false });
}

/** What the program has computed. */
export async function fetched(address) {
  const answer = await fetch(address, { headers: { accept: "application/json" } });
  if (!answer.ok) throw new Error(say("laboratory-answered", { status: answer.status }));
  return answer.json();
}

/** Fills `place` with the controls over `seconds`; `show` is called with every time that is to be seen, at first with `from`. */
export function player(place, { name, labels, seconds, show, from = 0 }) {
  let time = from;
  let speed = SPEEDS[0];
  let playing = false;
  let last = 0; // when the clock was looked at
  let shown = -Infinity; // when a picture was changed

  const button = element("button", { type: "button", className: "start loud" });
  const slider = element("input", { type: "range", min: 0, max: Math.ceil(seconds / STEP_S) * STEP_S, step: STEP_S });
  slider.setAttribute("aria-label", labels.slider);
  const clock = element("output", { className: "num" });
  const choice = (times) => {
    const radio = element("input", { type: "radio", name: `speed-${name}`, value: times, checked: times === speed });
    radio.addEventListener("change", () => { speed = times; });
    return element("label", {}, radio, `${times}×`);
  };
  const speeds = element("fieldset", { className: "speeds" }, element("legend", { textContent: say("laboratory-speed") }), ...SPEEDS.map(choice));
  place.replaceChildren(button, speeds, slider, clock);
  place.setAttribute("role", "group");
  place.setAttribute("aria-label", labels.player);
  place.hidden = false;

  function go(to) {
    time = Math.min(Math.max(to, 0), seconds);
    slider.value = time;
    const values = { time: written(time, 1), seconds: written(seconds) };
    slider.setAttribute("aria-valuetext", say("laboratory-clock-said", values));
    clock.textContent = say("laboratory-clock", values);
    show(time);
  }

  function label() {
    button.textContent = say(playing ? "laboratory-pause" : "laboratory-start");
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
