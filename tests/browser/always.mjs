// What an operator must always be able to do: press STOP, see its true state, and continue by keyboard from the
// current place.

import { appears, button, danger, hits, look, must, numberOf, phase, resize, safe, start, stop, until } from './person.mjs';

/** Screen sizes, portrait and landscape, from the smallest that can zoom to a large one. */
const SCREENS = [[320, 568], [320, 256], [390, 844], [640, 360], [760, 900], [761, 600], [844, 390], [960, 540], [961, 700], [1024, 768], [1181, 640],
  [1280, 800], [1401, 900], [1920, 1080], [2560, 1440]];

/** Every page that exists while a piece waits. */
const pages = (id) => ['/', '/missions', '/missions/1', '/missions/1?show=all', '/missions/1/moment', `/luggage/${id}`,
  `/api/v1/luggage/${id}/photo`, '/console/confirm/reset', `/console/confirm/danger/${id}`, '/api', '/missions/99', '/nowhere'];

const stateOf = (url) => async () => (await fetch(`${url}/api/v1/state`)).json();
const isHeld = (url) => async () => (await stateOf(url)()).mission.holds.includes('operator');

/** Starts a search and waits until it has found a piece; returns the id of the piece. */
async function atAPiece(page, url, patience) {
  await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
  const state = stateOf(url);
  await until(async () => (await state()).luggage.length > 0, 'a piece', patience);
  return (await state()).luggage[0].id;
}

async function onEveryScreen(page, where, extra = async () => {}) {
  for (const [width, height] of SCREENS) {
    await resize(page, width, height);
    await hits(page, where);
    await extra();
  }
}

/** STOP is reachable on every page, on every screen, at any scroll position. */
export const reach = {
  tolerated: ['404'],
  async play({ page, url, picture, patience }) {
    const id = await atAPiece(page, url, patience);
    for (const path of pages(id)) {
      await page.goto(url + path);
      await onEveryScreen(page, path);
      must((await page.getByRole('heading', { level: 1 }).count()) === 1, `${path} has no heading of the first level`);
    }
    await page.goto(url);
    await appears(page, danger(page), { patience });
    const opened = page.context().waitForEvent('page');
    await page.locator('#inspect a.photo').click();
    const photo = await opened;
    await photo.waitForLoadState();
    await hits(photo, 'a photo opened from the console');
    await photo.close();
    for (const [width, height] of SCREENS) {
      await resize(page, width, height);
      await danger(page).click();
      await page.getByRole('dialog').waitFor();
      await hits(page, 'the console with a question open');
      const no = page.getByRole('dialog').getByRole('button', { name: /No/ });
      await no.click();
    }
    await resize(page, 844, 390);
    await danger(page).click();
    await picture('question');
    await page.evaluate(() => scrollTo(0, 600));
    await picture('scrolled');
    await stop(page).click();
    await until(isHeld(url), 'a STOP from a page that is scrolled, with a question open', patience);
    // The operator sees "held by STOP" even where a waiting piece fills the screen.
    for (const [width, height] of [[320, 568], [390, 844], [844, 390]]) {
      await resize(page, width, height);
      await page.evaluate(() => scrollTo(0, 0));
      const held = await page.getByText('held by STOP').boundingBox();
      must(held && held.y >= 0 && held.y + held.height <= height && held.x + held.width <= width, `"held by STOP" is not seen at ${width}×${height}`);
    }
    await picture('held');
  },
};

/** Without scripts STOP is a plain form, which halts the robot from every page. */
export const reachPlain = {
  browser: { javaScriptEnabled: false },
  tolerated: ['404'],
  async play({ page, url, patience }) {
    const id = await atAPiece(page, url, patience);
    for (const path of pages(id)) {
      await page.goto(url + path);
      await onEveryScreen(page, path);
      await fetch(`${url}/api/v1/commands/backHome`, { method: 'POST' });
      must(!(await isHeld(url)()), 'the robot was released');
      await stop(page).click();
      await page.waitForURL(`${url}/`);
      must(await isHeld(url)(), `the plain STOP on ${path} did not halt`);
    }
  },
};

/**
 * Two fingers enlarge a photo or a page beyond the screen, and STOP stays on the visible part. On the map they zoom.
 */
export const magnified = {
  browser: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
  async play({ page, url, picture, patience }) {
    const id = await atAPiece(page, url, patience);
    const fingers = await page.context().newCDPSession(page);
    for (const path of ['/', '/missions/1', `/luggage/${id}`]) {
      // Beside the rail, too.
      for (const [width, height, beside] of [[390, 844], [844, 390], [1024, 768], [1024, 768, 40]]) {
        await resize(page, width, height);
        await page.goto(url + path);
        const x = beside ?? (path === '/' && width > 760 ? width - 150 : width / 3);
        await fingers.send('Input.synthesizePinchGesture', { x, y: height / 2.5, scaleFactor: 2.5 });
        const seen = () => page.evaluate(() => {
          const { scale, offsetLeft, offsetTop, width: wide, height: high } = visualViewport;
          const button = document.querySelector('#stop button');
          const { left, top, right, bottom } = button.getBoundingClientRect();
          const isIn = left >= offsetLeft - 1 && top >= offsetTop - 1 && right <= offsetLeft + wide + 1 && bottom <= offsetTop + high + 1;
          const isHit = document.elementFromPoint((left + right) / 2, (top + bottom) / 2)?.closest('button') === button;
          return { scale, isLarge: (bottom - top) * scale >= 44, isIn, isHit };
        });
        await until(async () => (await seen()).scale > 2, 'a magnified page', patience);
        await until(async () => (({ isIn, isHit, isLarge }) => isIn && isHit && isLarge)(await seen()),
          `STOP on the part of ${path} that is seen at ${width}×${height}`, patience);
        await picture('magnified');
      }
    }
  },
};

/** Errors that the browser itself reports about a cut connection; they are no fault of the page. */
const CUT = ['ERR_CONNECTION_REFUSED', 'ERR_CONNECTION_RESET', 'ERR_EMPTY_RESPONSE', 'ERR_INCOMPLETE_CHUNKED_ENCODING', 'ERR_CONNECTION_CLOSED',
  'ERR_SOCKET_NOT_CONNECTED', 'ERR_FAILED'];

/**
 * A STOP on a cut connection is shown as unconfirmed for as long as the cut lasts, and is sent when the connection
 * works again.
 */
export const unconfirmed = {
  tolerated: [...CUT, '404', '503'],
  async play({ page, url, picture, patience, network }) {
    const held = isHeld(url);
    const go = async () => {
      await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
      await until(async () => !(await held()), 'the robot on its way', patience);
    };
    const net = await network();
    const warning = page.locator('#why-stop').filter({ hasText: /not confirmed.*own switch/ });
    const confirmed = page.locator('#why-stop').filter({ hasText: 'STOP is confirmed' });
    let tries = 0;
    page.on('request', (request) => (tries += request.url().endsWith('/console/stop') ? 1 : 0));
    await page.clock.install();

    for (const path of ['/', '/missions', '/luggage/1']) {
      await go();
      await page.goto(net.url + path);
      for (const away of [() => net.cut(), () => net.hold()]) {
        await go();
        await away();
        tries = 0;
        await page.evaluate(() => {
          const isWatched = globalThis.tried !== undefined;
          globalThis.tried = [];
          if (isWatched) return;
          const real = globalThis.fetch;
          globalThis.fetch = (...request) => {
            if (String(request[0]).endsWith('/console/stop')) globalThis.tried.push(performance.now());
            return real(...request);
          };
        });
        await stop(page).click();
        await warning.waitFor();
        await until(() => page.evaluate(() => globalThis.tried.length > 2), `on ${path} a third attempt by itself`, patience);
        for (const seconds of [16, 60, 3600]) {
          await page.clock.fastForward(seconds * 1000);
          await warning.waitFor();
        }
        const gaps = await page.evaluate(() => globalThis.tried.slice(1).map((at, n) => at - globalThis.tried[n]));
        must(gaps.length > 0 && gaps.every((gap) => gap >= 999), `on ${path} STOP was tried again after ${gaps} ms`);
        must(!(await held()), 'a STOP got through a connection that is cut');
        await picture('unconfirmed');
        await net.mend();
        await until(held, `on ${path} the STOP that was pressed while the connection was cut`, patience);
        await confirmed.waitFor();
        must(!(await warning.isVisible()), 'the warning outlived the confirmation');
        // A confirmed STOP must not be sent again, because the operator may have pressed START since.
        const sent = tries;
        await go();
        await page.clock.fastForward(60_000);
        must(tries === sent && !(await held()), 'a confirmed STOP was sent again');
      }
    }

    // A page that is reloaded before the confirmation keeps trying to send the STOP.
    await page.goto(`${net.url}/`);
    await net.cut();
    await stop(page).click();
    await warning.waitFor();
    await page.reload().catch(() => {});
    must(!(await held()), 'a STOP got through a connection that is cut');
    await net.mend();
    // The browser may still show its own error page about the cut connection.
    await until(() => page.goto(`${net.url}/`).then(() => true, () => false), 'the page again', patience);
    await until(held, 'after a reload the STOP that was not confirmed', patience);
    await confirmed.waitFor();

    // An answer to an earlier attempt does not confirm a second press, because somebody may have pressed START
    // between the two.
    await page.goto(`${url}/missions`);
    let answer;
    const second = new Promise((done) => (answer = done));
    let came = 0;
    await page.route('**/console/stop', async (route) => {
      came += 1;
      if (came === 1) {
        await second;
        return route.fulfill({ json: { accepted: true, revision: 1, epoch: 1 } });
      }
      if (came > 2) return route.continue();
      await route.abort();
      return answer();
    });
    await stop(page).click();
    await stop(page).click();
    await until(() => came > 2, 'a third attempt, after the first was confirmed and the second was not', patience);
    await confirmed.waitFor();
    await page.unroute('**/console/stop');

    // Many presses must not use up the few connections that a browser opens.
    const atOnce = await page.evaluate(() => {
      const real = globalThis.fetch;
      let tries = 0;
      globalThis.fetch = (...request) => {
        tries += 1;
        return real(...request);
      };
      for (let press = 0; press < 9; press += 1) document.getElementById('stop').requestSubmit();
      globalThis.fetch = real;
      return tries;
    });
    must(atOnce > 0 && atOnce < 6, `nine presses made ${atOnce} attempts at once`);
    await until(() => page.evaluate(() => sessionStorage.length === 0), 'all nine confirmed', patience);

    // An answer other than acceptance confirms nothing.
    await page.goto(`${url}/missions`);
    const answers = [{ status: 503, json: { detail: 'it is ending' } }, { json: { accepted: false, detail: 'not now' } }];
    const names = [];
    await page.route('**/console/stop', (route) => {
      names.push(route.request().headers()['idempotency-key']);
      return answers.length > 0 ? route.fulfill(answers.shift()) : route.continue();
    });
    await page.evaluate(() => {
      const place = document.getElementById('why-stop');
      globalThis.said = [];
      new MutationObserver(() => globalThis.said.push(place.textContent)).observe(place, { childList: true, characterData: true, subtree: true });
    });
    await stop(page).click();
    const said = (words) => page.evaluate((wanted) => globalThis.said.findIndex((one) => one.includes(wanted)), words);
    await until(async () => (await said('STOP is confirmed')) >= 0, 'the confirmation after two answers that are none', patience);
    const order = [await said('it is ending'), await said('not now'), await said('STOP is confirmed')];
    must(order[0] >= 0 && order[0] < order[1] && order[1] < order[2], `what was said of STOP came as ${order}`);

    // All attempts of a press have the same idempotency key and become one entry in the record; another press has
    // another key.
    await stop(page).click();
    await until(() => names.length > 3, 'another press', patience);
    const [name, again, last, other] = names;
    must(name && name === again && name === last && name !== other, `the attempts were called ${names}`);
    await until(() => page.evaluate(() => sessionStorage.length === 0), 'the other press confirmed', patience);

    // A page that is reloaded before the confirmation sends the same press.
    answers.push(...Array(99).fill({ status: 503, json: { detail: 'not yet' } }));
    names.length = 0;
    await stop(page).click();
    await until(() => names.length > 0, 'a press that is not confirmed', patience);
    await page.reload();
    answers.length = 0;
    await until(() => page.evaluate(() => sessionStorage.length === 0), 'the press confirmed after the page was loaded anew', patience);
    must(names.length > 1 && new Set(names).size === 1, `the attempts before and after were called ${names}`);
    await page.unroute('**/console/stop');

    // STOP is sent as soon as the connection works again, without waiting for the next attempt. Here the timer of the
    // next attempt never fires.
    await go();
    await page.addInitScript(() => {
      const real = globalThis.setTimeout;
      globalThis.setTimeout = (call, ms, ...rest) => (ms === 1000 ? 0 : real(call, ms, ...rest));
    });
    await page.goto(`${net.url}/`);
    await phase(page, /exploring/i, { patience });
    await net.cut();
    await stop(page).click();
    await warning.waitFor();
    await net.mend();
    await until(held, 'the STOP, once the stream stood again', patience);
    await confirmed.waitFor();
  },
};

/** Cell in which the middle of the robot is drawn. */
const drawnAt = (page) => page.evaluate(() => {
  const { left, top, width, height } = document.querySelector('#hall-robot .body').getBoundingClientRect();
  const { x, y } = new DOMPoint(left + width / 2, top + height / 2).matrixTransform(document.getElementById('hall').getScreenCTM().inverse());
  return `${Math.floor(x / 10)},${Math.floor(y / 10)}`;
});

/** The robot is drawn in its cell wherever it is stopped, and nothing on the page moves where that is not wished. */
export const drawn = {
  async play({ page, url, patience }) {
    const state = stateOf(url);
    await page.goto(url);
    const cells = new Set();
    for (let turn = 0; turn < 5; turn += 1) {
      await start(page).click();
      await phase(page, /exploring/i, { patience });
      await page.waitForTimeout(400);
      await stop(page).click();
      await until(async () => (({ robot, mission }) => robot.state === 'stopped' && !robot.halting && mission.holds.includes('operator'))(await state()), 'the robot standing', patience);
      const { revision, robot: { position: { x, y } } } = await state();
      cells.add(`${x},${y}`);
      await page.waitForFunction((seen) => Number(document.getElementById('revision').textContent) >= seen, revision);
      const drawn = await drawnAt(page);
      must(drawn === `${x},${y}`, `the robot stands at ${x},${y} and is drawn at ${drawn}`);
    }
    must(cells.size > 2, `it was looked at in ${[...cells]} only`);
    await page.emulateMedia({ reducedMotion: 'reduce' });
    const moving = await page.evaluate(() => document.getAnimations().length);
    must(moving === 0, `${moving} parts move although nothing is to move`);
  },
};

/** Texts of the bar that are cut off or overlap something else. */
const faultsOfBar = () => {
  const top = document.getElementById('top');
  const edge = top.getBoundingClientRect();
  const walker = document.createTreeWalker(top, NodeFilter.SHOW_TEXT);
  const texts = [];
  const wrong = [];
  while (walker.nextNode()) {
    const { data, parentElement: one } = walker.currentNode;
    const isUnseen = [one, one.parentElement].some((part) => getComputedStyle(part).clipPath !== 'none');
    if (!data.trim() || isUnseen || one.closest('#notes, #why-stop') || !one.checkVisibility()) continue;
    const range = document.createRange();
    range.selectNodeContents(walker.currentNode);
    const boxes = [...range.getClientRects()];
    texts.push(...boxes.map((box) => [data.trim(), box]));
    const isOut = (box) => boxes.some((text) => text.right > box.right + 1 || text.bottom > box.bottom + 1 || text.left < box.left - 1);
    for (let up = one; up !== top; up = up.parentElement) {
      if (getComputedStyle(up).overflowX !== 'visible' && isOut(up.getBoundingClientRect())) wrong.push(`"${data.trim()}" is cut`);
    }
    if (isOut({ left: 0, right: innerWidth, bottom: one.closest('#command-bar') ? innerHeight : edge.bottom })) wrong.push(`"${data.trim()}" is out of the bar`);
  }
  texts.forEach(([a, p], place) => texts.slice(place + 1).forEach(([b, q]) => {
    if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 2 && q.top < p.bottom - 2) wrong.push(`"${a}" lies over "${b}"`);
  }));
  return texts.length > 5 ? [...new Set(wrong)] : [`only ${texts.length} texts`];
};

/**
 * In the bar no text is cut off or overlaps another: in each language, at each width, with any message, and for a
 * viewer.
 */
export const barWhole = {
  async play({ page, url, picture, patience }) {
    const { OPERATOR, VIEWER } = process.env;
    const headers = { authorization: `Bearer ${OPERATOR}`, 'content-type': 'application/json' };
    const send = (method, path, body) => fetch(`${url}/api/v1/${path}`, { method, headers, body: body && JSON.stringify(body) });
    const state = async () => (await fetch(`${url}/api/v1/state`, { headers })).json();
    await page.goto(`${url}/sign-in?token=${VIEWER}`);
    await page.locator('form:has([name=token]) button').first().click();
    await page.waitForURL(`${url}/`);
    const found = [];
    const whole = async (when) => {
      for (const language of ['it', 'en']) {
        await page.context().setExtraHTTPHeaders({ 'accept-language': language });
        await resize(page, 1280, 800);
        await page.goto(url);
        await page.locator('html[data-live=on]').waitFor();
        must(await page.evaluate(() => document.documentElement.lang) === language, `the page is in ${language}`);
        for (const width of [320, 360, 390, 480, 640, 760, 761, 768, 900, 960, 961, 1024, 1180, 1181, 1280, 1400, 1401, 1500, 1501, 1600, 1920]) {
          await resize(page, width, 800);
          found.push(...(await page.evaluate(faultsOfBar)).map((fault) => `${when}, ${language}, ${width}: ${fault}`));
          if (width === 768) await picture(`${when}-${language}`);
        }
      }
    };
    await whole('idle');
    await send('POST', 'commands/start');
    await until(async () => (await state()).luggage.length > 0, 'a piece', patience);
    await whole('waits');
    await send('POST', 'commands/stop');
    await send('PUT', 'temperature', { celsius: 101.5 });
    await until(async () => (await state()).mission.holds.includes('temperature'), 'the heat', patience);
    await whole('held and too hot');
    await send('POST', `luggage/${(await state()).luggage[0].id}/verdict`, { verdict: 'danger' });
    await until(async () => (await state()).mission.phase === 'returningWithAlarm', 'the alarm', patience);
    await whole('returning with alarm');
    must(found.length === 0, `${found.length} faults of the bar:\n${found.join('\n')}`);
  },
};

/** A mission by keyboard alone: the focus is on the next action or a few steps from it. */
export const keyboard = {
  async play({ page, url, picture, patience }) {
    const here = () => page.evaluate(() => {
      const { innerText, tagName } = document.activeElement;
      return tagName === 'BODY' ? tagName : innerText || tagName;
    });
    /** Waits until the focus is on STOP or on the photo of a new piece, not on the piece that was answered. */
    const isOnNext = async (answered, when) => {
      const next = () => page.evaluate(() => {
        const here = document.activeElement.closest('#stop, #inspect a.photo');
        return here && (here.id || document.getElementById('inspect').dataset.luggage);
      });
      await until(async () => ![null, answered].includes(await next()), `${when} the keyboard on STOP or on the next photo`, patience);
      return next();
    };
    const isOn = async (pattern, when) => {
      const end = Date.now() + patience;
      while (!pattern.test(await here())) must(Date.now() < end, `${when} the keyboard is on ${JSON.stringify(await here())}`);
    };
    /** Presses Tab until the matching element has the focus, at most `most` times. */
    const tabTo = async (pattern, most) => {
      for (let steps = 0; !pattern.test(await here()); steps += 1) {
        must(steps < most, `${most} steps do not lead to ${pattern}, but to ${JSON.stringify(await here())}`);
        await page.keyboard.press('Tab');
      }
    };
    const ask = async () => {
      await appears(page, safe(page), { patience });
      return numberOf(safe(page));
    };
    await page.goto(url);
    await tabTo(/START/, 6);
    await page.keyboard.press('Enter');
    const led = await isOnNext('', 'after START');
    const first = await ask();
    must(led !== 'stop' || /^STOP/.test(await here()), 'the piece that arrives takes the keyboard away from STOP');
    await tabTo(/SAFE #/, 3);
    await picture('safe');
    await look(page);
    await page.keyboard.press('Enter');
    await isOnNext(String(first), 'after SAFE');

    await appears(page, button(page, new RegExp(`DANGER #(?!${first}\\b)\\d+`)).first(), { patience });
    await page.goto(url);
    await tabTo(/SAFE #/, 6);
    await tabTo(/DANGER #/, 1);
    await page.keyboard.press('Enter');
    await isOn(/No, go back/, 'when DANGER asks');
    await tabTo(/Yes: DANGER/, 1);
    await look(page);
    await page.keyboard.press('Enter');
    // The next act gets the focus if the robot is already home.
    await isOn(/^STOP|^Acknowledge/, 'after DANGER');
    await page.locator('#stop-button').focus();
    // A key that is held down presses once, whichever element has the focus.
    for (const key of ['Enter', 'Escape']) {
      let presses = 0;
      const count = (request) => (presses += request.url().endsWith('/console/stop') ? 1 : 0);
      page.on('request', count);
      const answered = page.waitForResponse((response) => response.url().endsWith('/console/stop'));
      for (let times = 0; times < 4; times += 1) await page.keyboard.down(key);
      await page.keyboard.up(key);
      // Waits until the page has read the answer, because an earlier press would cause another attempt.
      await (await answered).finished();
      await page.evaluate(() => fetch('/healthz').then((answer) => answer.text()));
      must(presses === 1, `${key} was held down and pressed STOP ${presses} times`);
      page.off('request', count);
    }
    await until(isHeld(url), 'the keyboard’s STOP', patience);
    await picture('stopped');
  },
};

/** The script of STOP does not arrive: pages still follow the state, and STOP halts as it does without scripts. */
export const halfLoaded = {
  tolerated: ['ERR_FAILED'],
  async play({ page, url, picture, patience }) {
    const state = async () => (await fetch(`${url}/api/v1/state`)).json();
    await page.route('**/static/stop.js', (route) => route.abort());
    for (const path of ['/missions', '/']) {
      await page.goto(url + path);
      await page.locator('#bar .phase').waitFor();
      await page.waitForTimeout(4000);
      must(await page.locator('#lost, #elsewhere .why').isHidden(), `${path} says that nothing answers`);
      must(!(await page.locator('.esc').isVisible()), `${path} offers a key that nobody hears`);
      await hits(page, 'a page with half its scripts');
      await picture('half');
      await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
      await until(async () => (await state()).mission.holds.length === 0, 'the robot goes on', patience);
      await stop(page).click();
      await until(async () => (await state()).mission.holds.includes('operator'), `STOP without its script on ${path}`, patience);
    }
  },
};

/** Nothing moves away from under a pointer: from opening the page to the secured bag, no shift of the layout is above 0.02. */
export const unmoved = {
  browser: { viewport: { width: 1280, height: 720 } },
  async play({ page, url, patience }) {
    const ask = async (method, path, body) => {
      const answer = await fetch(`${url}/api/v1/${path}`, { method, headers: { 'content-type': 'application/json' }, body: body && JSON.stringify(body) });
      return answer.json();
    };
    const state = () => ask('GET', 'state');
    await page.addInitScript(() => {
      globalThis.shifts = [];
      const what = ({ node, previousRect: from, currentRect: to }) => `${node?.id || node?.className || node?.nodeName}: ${from.x},${from.y} to ${to.x},${to.y}`;
      new PerformanceObserver((list) => list.getEntries().forEach(({ value, sources }) => shifts.push([value, sources.map(what)])))
        .observe({ type: 'layout-shift', buffered: true });
    });
    await page.goto(url);
    const stays = async (when) => {
      await look(page);
      const [most] = await page.evaluate(() => shifts.splice(0).sort(([one], [other]) => other - one));
      must(!most || most[0] <= 0.02, `${when}: ${most}`);
    };
    // Another client sends the commands, so every shift is unexpected.
    const verdict = async (count, verdict) => {
      await until(async () => (await state()).luggage.length === count && (await state()).mission.phase === 'inspecting', `piece ${count}`, patience);
      await stays(`piece ${count}`);
      await until(async () => (await ask('POST', `luggage/${(await state()).luggage.at(-1).id}/verdict`, { verdict })).accepted, `a verdict on piece ${count}`, patience);
    };
    await stays('open');
    await ask('POST', 'commands/start');
    await stays('started');
    await verdict(1, 'safe');
    await ask('PUT', 'temperature', { status: 'tooHigh' });
    await stays('too hot');
    await ask('PUT', 'temperature', { status: 'ok' });
    await ask('POST', 'commands/start');
    await verdict(2, 'danger');
    const place = async () => {
      const { x, width } = await page.getByRole('button', { name: 'Acknowledge' }).boundingBox();
      return `${x}, ${width} px wide`;
    };
    const before = await place();
    await page.getByRole('button', { name: 'RETRIEVE' }).waitFor();
    must(before === await place(), `Acknowledge was at ${before}, and is at ${await place()} when RETRIEVE appears`);
    await until(async () => (await state()).mission.phase === 'bombLocated', 'the robot at home', patience);
    await stays('the incident');
    for (const alarm of (await state()).alarms) await ask('POST', `alarms/${alarm.id}/acknowledge`);
    await stays('acknowledged');
    await ask('POST', 'commands/retrieve');
    await stays('the retrieval');
    await until(async () => (await state()).mission.phase === 'bagSecured', 'the bag secured', patience);
    await stays('secured');
  },
};
