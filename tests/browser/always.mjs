// What an operator must always be able to do: press STOP, be told the truth about it, and go on by keyboard from where he is.

import { appears, button, danger, hits, look, must, numberOf, phase, safe, start, stop, until } from './person.mjs';

/** Screens from the smallest on which one can zoom to a large one, upright and lying. */
const SCREENS = [[320, 568], [320, 256], [390, 844], [640, 360], [760, 900], [761, 600], [844, 390], [960, 540], [961, 700], [1024, 768], [1181, 640],
  [1280, 800], [1401, 900], [1920, 1080], [2560, 1440]];

/** The pages there are while a piece waits. */
const pages = (id) => ['/', '/missions', '/missions/1', '/missions/1?show=all', `/luggage/${id}`, `/api/v1/luggage/${id}/photo`,
  '/console/confirm/reset', `/console/confirm/danger/${id}`, '/missions/99', '/nowhere'];

const stateOf = (url) => async () => (await fetch(`${url}/api/v1/state`)).json();
const isHeld = (url) => async () => (await stateOf(url)()).mission.holds.includes('operator');

/** A search that has come to a piece. */
async function atAPiece(page, url, patience) {
  await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
  const state = stateOf(url);
  await until(async () => (await state()).luggage.length > 0, 'a piece', patience);
  return (await state()).luggage[0].id;
}

async function onEveryScreen(page, where, extra = async () => {}) {
  for (const [width, height] of SCREENS) {
    await page.setViewportSize({ width, height });
    await hits(page, where);
    await extra();
  }
}

/** On every page there is, on every screen, at any scroll. */
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
      await page.setViewportSize({ width, height });
      await danger(page).click();
      await page.getByRole('dialog').waitFor();
      await hits(page, 'the console with a question open');
      const no = page.getByRole('dialog').getByRole('button', { name: /No/ });
      await no.click();
    }
    await page.setViewportSize({ width: 844, height: 390 });
    await danger(page).click();
    await picture('question');
    await page.evaluate(() => scrollTo(0, 600));
    await picture('scrolled');
    await stop(page).click();
    await until(isHeld(url), 'a STOP from a page that is scrolled, with a question open', patience);
  },
};

/** The same without scripts, where STOP is a plain form: on each page it halts. */
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

/** What the browser itself says of a connection that is cut is no fault of the page. */
const CUT = ['ERR_CONNECTION_REFUSED', 'ERR_CONNECTION_RESET', 'ERR_EMPTY_RESPONSE', 'ERR_INCOMPLETE_CHUNKED_ENCODING', 'ERR_CONNECTION_CLOSED',
  'ERR_SOCKET_NOT_CONNECTED'];

/** A STOP whose connection is cut stays unconfirmed on the page however long that lasts, and is sent when the connection stands. */
export const unconfirmed = {
  tolerated: [...CUT, '404'],
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
        const began = Date.now();
        await stop(page).click();
        await warning.waitFor();
        for (const seconds of [16, 60, 3600]) {
          await page.clock.fastForward(seconds * 1000);
          await warning.waitFor();
        }
        // By hand once more: as often as one presses, and by itself at most once a second and once for each jump of the clock.
        const most = (Date.now() - began) / 1000 + 8;
        must(tries >= 2 && tries <= most, `on ${path} STOP was tried ${tries} times, at most ${most} was meant`);
        must(!(await held()), 'a STOP got through a connection that is cut');
        await picture('unconfirmed');
        await net.mend();
        await until(held, `on ${path} the STOP that was pressed while the connection was cut`, patience);
        await confirmed.waitFor();
        must(!(await warning.isVisible()), 'the warning outlived the confirmation');
        // What follows is the person's: a STOP that is confirmed is not sent again.
        const sent = tries;
        await go();
        await page.clock.fastForward(60_000);
        must(tries === sent && !(await held()), 'a confirmed STOP was sent again');
      }
    }

    // A page that is loaded anew in between goes on with it.
    await page.goto(net.url);
    await net.cut();
    await stop(page).click();
    await warning.waitFor();
    await page.reload().catch(() => {});
    must(!(await held()), 'a STOP got through a connection that is cut');
    await net.mend();
    await page.goto(net.url);
    await until(held, 'after a reload the STOP that was not confirmed', patience);
    await confirmed.waitFor();
  },
};

/** The robot is drawn at its cell before the next update comes; it was 2 to 6 cells behind. */
export const drawn = {
  async play({ page, url, patience }) {
    await page.goto(url);
    await start(page).click();
    await phase(page, /exploring/i, { patience });
    const updates = await page.evaluate((wanted) => new Promise((done) => {
      const robot = document.getElementById('hall-robot');
      const cell = (text) => text.match(/-?\d+(\.\d+)?/g).map(Number);
      const seen = [];
      let target = cell(robot.getAttribute('transform'));
      let came = performance.now();
      new MutationObserver(() => {
        const next = cell(robot.getAttribute('transform'));
        if (next.join() === target.join()) return;
        const { e, f } = new DOMMatrix(getComputedStyle(robot).transform);
        const now = performance.now();
        seen.push({ gap: now - came, behind: Math.hypot(e - target[0], f - target[1]) / 10, step: Math.hypot(next[0] - target[0], next[1] - target[1]) / 10 });
        [target, came] = [next, now];
        if (seen.length === wanted) done(seen);
      }).observe(robot, { attributes: true, attributeFilter: ['transform'] });
    }), 45);
    // Two updates that the network brought together are one to the eye.
    const apart = updates.filter(({ gap }) => gap >= 100);
    const late = apart.filter(({ behind }) => behind > 0.5);
    must(apart.length >= 10, `updates came too close together to tell: ${JSON.stringify(updates)}`);
    must(late.length === 0, `the drawn robot is behind by ${late.map(({ behind }) => behind.toFixed(1))} cells`);
    const lasts = await page.locator('#hall-robot').evaluate((robot) => parseFloat(getComputedStyle(robot).transitionDuration));
    must(lasts < 0.1, `the robot glides for ${lasts} s, updates come every 0.1 s`);
    await page.emulateMedia({ reducedMotion: 'reduce' });
    const still = await page.locator('#hall-robot').evaluate((robot) => parseFloat(getComputedStyle(robot).transitionDuration));
    must(still === 0, 'the robot glides although nothing is to move');
  },
};

/** A mission by keyboard alone: the keyboard is where the next act is, or a few steps from it. */
export const keyboard = {
  async play({ page, url, picture, patience }) {
    const here = () => page.evaluate(() => {
      const { innerText, tagName } = document.activeElement;
      return tagName === 'BODY' ? tagName : innerText || tagName;
    });
    const isOn = async (pattern, when) => {
      const end = Date.now() + patience;
      while (!pattern.test(await here())) must(Date.now() < end, `${when} the keyboard is on ${JSON.stringify(await here())}`);
    };
    /** Presses Tab until this has the keyboard, at most so often. */
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
    await isOn(/^STOP/, 'after START');

    const first = await ask();
    await isOn(/^STOP/, 'when a piece arrives');
    await tabTo(/SAFE #/, 3);
    await picture('safe');
    await look(page);
    await page.keyboard.press('Enter');
    await isOn(/^STOP/, 'after SAFE');

    await appears(page, button(page, new RegExp(`DANGER #(?!${first}\\b)\\d+`)).first(), { patience });
    await page.goto(url);
    await tabTo(/SAFE #/, 6);
    await tabTo(/DANGER #/, 1);
    await page.keyboard.press('Enter');
    await isOn(/No, go back/, 'when DANGER asks');
    await tabTo(/Yes: DANGER/, 1);
    await look(page);
    await page.keyboard.press('Enter');
    await isOn(/^STOP/, 'after DANGER');
    await page.keyboard.press('Enter');
    await until(isHeld(url), 'the keyboard’s STOP', patience);
    await picture('stopped');
  },
};
