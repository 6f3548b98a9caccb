// The line of time: drags the page to any moment of the mission, plays it forwards and backwards, and comes back to now. What a moment
// looks like is drawn by the server, from the same parts as now; this asks for what differs and hands it to the console's `show`.
"use strict";

const time = (() => {
  const TICK_MS = 100;
  const LEAST = 200; // units: a shorter line is drawn so long
  const LEAP_MS = 10_000; // shift and an arrow
  const NOW_PART = 0.995; // whoever drags to the right edge wants now

  // The address moves with the moment that is shown; what the page's other addresses count from does not.
  if (!document.querySelector("base")) document.head.append(Object.assign(document.createElement("base"), { href: "./" }));

  const panel = at("time");
  const track = at("track");
  let line = JSON.parse(panel.dataset.line); // how the line is to be read
  let then = JSON.parse(panel.dataset.then); // the moment of the past that is shown; null: now
  let present = then ? null : line?.mission; // the mission that goes on
  let place = 0; // where the replay is, in units
  let direction = 0; // of the replay; 0 while it does not play
  let wanted = null; // what is to be asked next
  let asking = false;
  let visit = 0; // each way back to now ends what was asked before

  const serverNow = () => performance.now() + ahead;

  /** Between two leaps of the clock, which are while the program is off and when somebody sets it: from when to when, and what it is ahead of the line. */
  function stretches() {
    const all = [];
    let from = line.began;
    let off = 0;
    for (const [leaptFrom, leaptTo, shown] of line.breaks) {
      all.push([from, leaptFrom, off]);
      off += leaptTo - leaptFrom - shown;
      from = leaptTo;
    }
    return [...all, [from, end(), off]];
  }

  /** Where a moment is on the line, in units: where a clock that was set back showed it twice, the later of the two. */
  function unitOf(moment) {
    let place = 0;
    let isFound = false;
    for (const [index, [from, to, off]] of stretches().entries()) {
      const isHere = from <= moment && moment <= to;
      if (isHere || (from <= moment && !isFound)) place = (index === line.breaks.length ? moment : Math.min(moment, to)) - line.began - off;
      isFound ||= isHere;
    }
    return Math.max(0, place / line.unit);
  }

  /** The moment at a place of the line. */
  function momentAt(unit) {
    let moment = line.began + unit * line.unit;
    for (const [from, to, shown] of line.breaks) {
      if (moment < from + shown) break;
      moment += to - from - shown;
    }
    return Math.round(moment);
  }

  const isPresent = () => line && line.mission === present && line.open;
  const end = () => (isPresent() ? Math.max(line.end, serverNow()) : line.end);
  const width = () => Math.max(LEAST, unitOf(end()));

  let drawn = 0; // so many units are drawn

  function paint(id, attribute, value) {
    if (at(id).getAttribute(attribute) !== value) at(id).setAttribute(attribute, value);
  }

  const HOUR_PX = 84; // so much room an hour has
  const HOURS_S = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 21600, 43200, 86400];
  let hoursOf = ""; // what the hours stand for that are drawn

  /** The hours under the line, in the hall's zone, as many as have room. */
  function hours(wide) {
    const room = Math.max(1, Math.floor(track.clientWidth / HOUR_PX));
    const lasts = wide * line.unit / 1000;
    const days = HOURS_S.at(-1);
    const step = (HOURS_S.find((step) => lasts / step <= room) ?? Math.ceil(lasts / days / room) * days) * 1000;
    const what = [line.mission, line.breaks.length, step, wide, Math.floor(end() / step)].join();
    if (hoursOf === what) return;
    hoursOf = what;
    const zone = Number(at("zone").dataset.offset) * 1000;
    const next = (moment) => Math.ceil((moment + zone) / step) * step - zone;
    const marks = [];
    let before = -1; // where the last of them stands
    for (const [from, to, off] of stretches()) {
      for (let moment = next(from); moment <= to && marks.length <= room; moment += step) {
        const part = (moment - line.began - off) / line.unit / wide;
        const fromEdge = Math.min(part, 1 - part) * track.clientWidth;
        if (fromEdge < HOUR_PX / 3 || (part - before) * track.clientWidth < HOUR_PX * .7) continue;
        before = part;
        const mark = document.createElementNS("http://www.w3.org/2000/svg", "text");
        mark.setAttribute("x", `${100 * part}%`);
        mark.setAttribute("y", "80%");
        mark.textContent = step < days * 1000 ? clockTime(moment - ahead).slice(0, step < 60_000 ? 8 : 5) : new Date(moment + zone).toLocaleDateString(root.lang, { timeZone: "UTC", day: "numeric", month: "short" });
        marks.push(mark);
      }
    }
    at("hours").replaceChildren(...marks);
  }

  const LETTER_PX = 7; // maximum width of a letter
  const SHOT_PX = 40; // minimum distance of two photos
  const SHOTS = 24; // number of the latest pieces whose photos are shown, as in the list of luggage
  let namesOf = ""; // mission and scale of the drawn names and photos; empty: they are drawn anew

  /** The names of the phases that have room, and the photos of the pieces where they were found. */
  function label(wide, present) {
    const what = [line.mission, wide, track.clientWidth].join();
    if (namesOf === what) return;
    namesOf = what;
    const marks = (which) => [...at("times").querySelectorAll(which)];
    const bands = marks(".phase");
    const startOf = (path) => Number(/^M(-?\d+)/.exec(path.getAttribute("d"))[1]);
    const pixels = (unit) => unit / wide * track.clientWidth;
    at("names").replaceChildren(...bands.flatMap((band, index) => {
      const from = startOf(band);
      const to = Math.min(index + 1 < bands.length ? startOf(bands[index + 1]) : present, wide);
      const words = band.dataset.name;
      if (pixels(to - from) < words.length * LETTER_PX + 8) return [];
      const text = document.createElementNS("http://www.w3.org/2000/svg", "text");
      text.setAttribute("x", `${100 * from / wide}%`);
      text.setAttribute("dx", 5);
      text.setAttribute("y", 12);
      text.setAttribute("class", band.getAttribute("class"));
      text.textContent = words;
      return [text];
    }));
    const verdicts = new Map(marks(".mark:is(.safe, .danger)").map((mark) => [mark.dataset.piece, mark.classList[1]]));
    const there = new Map([...at("shots").children].map((shot) => [shot.dataset.photo, shot]));
    let last = -SHOT_PX;
    at("shots").replaceChildren(...marks(".found[data-take]").slice(-SHOTS).flatMap((find) => {
      const { piece, take } = find.dataset;
      const place = pixels(startOf(find));
      if (place - last < SHOT_PX) return [];
      last = place;
      const photo = `./api/v1/luggage/${piece}/photo?take=${take}`;
      const shot = there.get(photo) ?? Object.assign(new Image(), { fetchPriority: "low", src: photo, alt: "", onerror: () => shot.remove() });
      shot.dataset.photo = photo;
      shot.className = verdicts.get(piece) ?? "pending";
      shot.style.left = `max(1.1rem, ${100 * startOf(find) / wide}%)`;
      return [shot];
    }));
  }

  /** Draws where we are. */
  function draw() {
    panel.classList.toggle("empty", !line);
    if (!line) return;
    // What would move it by less than a point of the screen is not painted anew.
    if (width() < drawn || width() > drawn * (1 + 1 / track.clientWidth)) drawn = width();
    const wide = drawn;
    const present = Math.min(unitOf(end()), wide);
    const whole = (unit) => Math.round(unit / wide * track.clientWidth) / track.clientWidth * wide || 0; // a whole pixel
    const [here, future] = [whole(then ? unitOf(then.time) : present), whole(present)];
    paint("future", "d", `M${future} -1H${wide * 2}V65H${future}z`);
    paint("time-line", "viewBox", `0 0 ${wide} 64`);
    paint("cursor", "d", `M${here} 0v64`);
    hours(wide);
    label(wide, present);
    at("time-ends").hidden = !line.cut;
    const words = then ? say("time-moment", { ...then, time: clockTime(then.time - ahead) }) : say("time-now");
    if (at("moment").textContent !== words) at("moment").textContent = words;
    track.setAttribute("aria-valuemax", Math.round(wide / 10));
    track.setAttribute("aria-valuenow", Math.round(here / 10));
    track.setAttribute("aria-valuetext", then ? `${words}: ${document.querySelector("#bar .phase").textContent}` : words);
    at("to-now").hidden = !then;
    at("play").setAttribute("aria-pressed", direction > 0);
    at("play").querySelector("use").setAttribute("href", `./static/vendor/icons.svg#${direction > 0 ? "pause" : "play"}`);
    at("play").setAttribute("aria-label", say(direction > 0 ? "time-pause" : "time-play"));
    at("backwards").setAttribute("aria-pressed", direction < 0);
    at("step-back").disabled = then ? !then.earlier : false;
    at("step-on").disabled = !then;
  }

  /** The page shows this now: of the present, or of the past. */
  function shown(message) {
    if (message.line) line = message.line;
    if (Object.keys(message.parts).some((id) => id.startsWith("time_"))) namesOf = "";
    if (!message.then) present = message.line?.mission ?? present;
    then = message.then;
    if (then) root.dataset.past = "yes";
    else delete root.dataset.past;
    draw();
  }

  /** Something happens now while the past is shown: it is said, and the picture stays. */
  function meanwhile(message) {
    ahead = message.now - performance.now();
    if (document.title !== message.title) document.title = message.title;
    present = message.line?.mission ?? present;
    if (line?.mission === message.line?.mission) line = message.line;
    const words = message.title.replace(/ · hallsweep$/, "");
    at("now-words").textContent = `: ${words}`;
    at("to-now").title = `${say("time-now")}: ${words}`;
    draw();
  }

  /** Shows a moment; of many that are asked for quickly, the last. */
  async function go(to) {
    if (!line) return;
    wanted = to;
    if (asking) return;
    asking = true;
    const here = visit;
    while (wanted && here === visit) {
      const query = new URLSearchParams(wanted);
      wanted = null;
      if (then) {
        query.set("from", then.seq);
        query.set("shown", then.time);
      }
      const answer = await fetch(`./console/missions/${line.mission}/moment?${query}`, { signal: AbortSignal.timeout(SEND_MS) }).catch(() => null);
      if (here !== visit) break;
      if (answer?.status === 401) signIn("watching");
      if (!answer?.ok) {
        pause();
        const said = await answer?.json().catch(() => null);
        at("moment").textContent = said?.detail ?? say("time-cut");
        break;
      }
      const message = await answer.json();
      if (here !== visit) break;
      show(message);
      history.replaceState(null, "", `./missions/${line.mission}/moment?at=${then.seq}`);
    }
    asking = false;
  }

  /** Back to now: the stream's first message holds everything. */
  function now() {
    pause();
    visit += 1;
    asking = false;
    wanted = null;
    then = null;
    at("now-words").textContent = "";
    history.replaceState(null, "", "./");
    delete root.dataset.past;
    join();
    draw();
  }

  function toUnit(unit) {
    place = Math.min(Math.max(0, unit), width());
    go({ time: Math.max(0, momentAt(place)) });
  }

  function start() {
    pause();
    go({});
  }

  function step(by) {
    pause();
    if (by < 0) go({ at: then ? then.earlier ?? then.seq : line.last });
    else if (then?.later) go({ at: then.later });
    else if (then && isPresent()) now();
  }

  function leap(ms) {
    pause();
    if (!then && ms > 0) return;
    const to = (then ? then.time : end()) + ms;
    if (to >= end() && isPresent()) now();
    else toUnit(unitOf(to));
  }

  function play(way) {
    const was = direction;
    pause();
    if (was === way) return;
    if (!line || (way > 0 && !then)) return;
    direction = way;
    place = then ? unitOf(then.time) : width();
    draw();
  }

  function pause() {
    direction = 0;
    draw();
  }

  let ticks = 0;
  setInterval(() => {
    if (!line) return;
    if (!direction) {
      ticks += 1;
      if (!then && isPresent() && ticks % 10 === 0) draw();
      return;
    }
    place += direction * Number(at("speed").value) * TICK_MS / line.unit;
    if (place >= width()) {
      if (isPresent()) return now();
      go({ at: line.last });
      return pause();
    }
    if (place <= 0) return start();
    toUnit(place);
  }, TICK_MS);

  // ---- hands ----

  function drag(event) {
    const box = at("time-line").getBoundingClientRect();
    const part = Math.min(Math.max(0, (event.clientX - box.left) / box.width), 1);
    if ((part >= NOW_PART || part * width() > unitOf(end())) && isPresent()) {
      if (then) now();
    } else {
      toUnit(part * width());
    }
  }

  track.addEventListener("pointerdown", (event) => {
    if (event.button > 0 || !line) return;
    track.setPointerCapture(event.pointerId);
    pause();
    drag(event);
  });
  track.addEventListener("pointermove", (event) => track.hasPointerCapture(event.pointerId) && drag(event));

  track.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !line) return;
    const keys = {
      ArrowLeft: () => (event.shiftKey ? leap(-LEAP_MS) : step(-1)),
      ArrowRight: () => (event.shiftKey ? leap(LEAP_MS) : step(1)),
      PageDown: () => leap(-6 * LEAP_MS),
      PageUp: () => leap(6 * LEAP_MS),
      Home: start,
      End: () => (isPresent() ? then && now() : go({ at: line.last })),
      " ": () => play(1),
    };
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });

  at("to-start").addEventListener("click", start);
  at("play").addEventListener("click", () => play(1));
  at("backwards").addEventListener("click", () => play(-1));
  at("step-back").addEventListener("click", () => step(-1));
  at("step-on").addEventListener("click", () => step(1));
  at("to-now").addEventListener("click", (event) => {
    event.preventDefault();
    now();
  });

  new ResizeObserver(draw).observe(track);
  return { shown, meanwhile, go, isPast: () => then !== null };
})();
