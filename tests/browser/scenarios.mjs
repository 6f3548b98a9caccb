// What people do at the console, and what they must see. Elements are found by role and visible name, as a person
// finds them.

import { execFileSync } from 'node:child_process';
import { appears, button, danger, fits, hits, home, look, menu, must, numberOf, phase, photoIsShown, resize, safe, start, stop, tab, until } from './person.mjs';

/** Checks that a button can be pressed without scrolling and that STOP does not cover it. */
async function inReach(page, locator) {
  await page.evaluate(() => scrollTo(0, 0));
  const box = await locator.boundingBox();
  const { bottom, high } = await page.evaluate(() => {
    const { top } = document.getElementById('stop').getBoundingClientRect();
    return { bottom: top > innerHeight / 2 ? top : innerHeight, high: innerHeight };
  });
  must(box && box.y >= 0 && box.y + box.height <= bottom, `not in reach on ${high} pixels: ${JSON.stringify(box)}`);
}

/** A whole mission: one piece is safe, the next is dangerous, and the robot is home with the bomb located. */
async function mission({ page, url, picture, patience }, { reload = false, touch = false } = {}) {
  const waiting = { patience, reload };
  await page.goto(url);
  await phase(page, /idle/i, waiting);
  await fits(page);
  await picture('idle');
  await start(page).click();

  await appears(page, safe(page), waiting);
  const first = await numberOf(safe(page));
  await photoIsShown(page, first);
  await fits(page);
  await picture('asked');
  await inReach(page, safe(page));
  await inReach(page, danger(page));
  if (touch) {
    for (const one of [safe(page), danger(page), start(page), home(page)]) {
      const box = await one.boundingBox();
      must(box.height >= 44, `${await one.innerText()} is ${box.height} pixels high`);
    }
  }
  await look(page);
  await safe(page).click();

  const next = button(page, new RegExp(`DANGER #(?!${first}\\b)\\d+`)).first();
  await appears(page, next, waiting);
  const second = await numberOf(next);
  must(second > first, `luggage #${second} came after #${first}`);
  await look(page);
  await next.click();
  await picture('sure');
  await confirmDanger(page, url, second);

  await phase(page, /bomb located/i, waiting);
  await picture('home');
  const state = await (await fetch(`${url}/api/v1/state`)).json();
  must(state.robot.position.x === 0 && state.robot.position.y === 0, 'the robot is not home');
  must(state.robot.led === 'off', 'the LED still blinks');
  must(state.luggage.find(({ id }) => id === second).verdict === 'danger', 'the verdict is not on record');
}

/** DANGER asks for confirmation: the first press decides nothing, the second press decides. */
async function confirmDanger(page, url, id) {
  const record = await (await fetch(`${url}/api/v1/luggage/${id}`)).json();
  must(record.verdict === 'pending', `one press was enough to decide: ${record.verdict}`);
  const dialog = page.getByRole('dialog').or(page.getByRole('alertdialog'));
  const inside = (await dialog.count()) > 0 ? dialog.first() : page.locator('main, body').last();
  await inside.getByRole('button', { name: /DANGER/ }).last().click();
}

export const missionOnScreen = { play: (person) => mission(person) };
export { missionOnScreen as mission };

export const phone = {
  browser: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark' },
  async play(person) {
    const { page, url } = person;
    await page.goto(url);
    await page.locator('html[data-live="on"]').waitFor();
    // A finger cannot hover over a button that is dead: a press on it tells why.
    for (const part of [home(page), home(page).locator('svg')]) {
      const { x, y, width, height } = await part.boundingBox();
      await page.touchscreen.tap(x + width / 2, y + height - 4);
      await page.locator('#why-page').getByText('not possible while idle').waitFor();
      await page.evaluate(() => (document.getElementById('why-page').textContent = ''));
    }
    await mission(person, { touch: true });
  },
};

export const plain = {
  browser: { javaScriptEnabled: false },
  play: (person) => mission(person, { reload: true }),
};

const stopping = {
  async play({ page, url, picture, patience }) {
    const state = async () => (await fetch(`${url}/api/v1/state`)).json();
    await page.goto(url);
    // A search order that was chosen but never sent is not shown once it can no longer be sent.
    const order = page.getByLabel('Search order', { exact: true });
    await tab(page, 'Drive');
    await order.selectOption('snail');
    await start(page).click();
    await phase(page, /exploring/i, { patience });
    await until(async () => (await order.inputValue()) === (await state()).mission.strategy, 'the order in use', patience);
    await stop(page).click();
    const banner = page.getByText(/^Held: stopped by the operator/);
    await banner.waitFor();
    const held = await state();
    must(held.robot.state === 'stopped', `after STOP the robot is ${held.robot.state}`);
    must(held.mission.holds.includes('operator'), `after STOP the holds are ${held.mission.holds}`);
    must((await page.getByRole('dialog').count()) === 0, 'STOP asks no questions');
    await picture('stopped');
    await start(page).click();
    await banner.waitFor({ state: 'hidden' });
    must((await state()).mission.holds.length === 0, 'START did not release the robot');

    // Changes by another client appear without a reload, and START then shows why it would be refused.
    const headers = { 'content-type': 'application/json' };
    await fetch(`${url}/api/v1/temperature`, { method: 'PUT', headers, body: '{"status":"tooHigh"}' });
    await page.waitForFunction(() => [...document.querySelectorAll('button')]
      .some((one) => /START/.test(one.innerText) && one.disabled && /temperature/i.test(one.title)));
    await picture('too-hot');
    await look(page);
    await page.locator('#holds').getByRole('button', { name: 'TEMPERATURE OK' }).click();
    await until(async () => !(await state()).mission.holds.includes('tooHigh'), 'OK beside what holds', patience);
    must((await state()).mission.holds.includes('awaitingStart'), 'OK alone set the robot moving');
    must(await stop(page).isEnabled(), 'STOP is always there');
  },
};

export { stopping as stop };

export const besideCoap = {
  async play({ page, url, coap, picture, patience }) {
    const mission = async () => JSON.parse((await coap('GET mission')).replace('2.05 ', ''));
    const model = () => coap('GET resourcemodel');
    await page.goto(url);
    must((await mission()).phase === 'idle', 'nothing was started yet');
    must((await model()).startsWith('2.05 robot( state(stopped), direction(downDir), position(0, 0)'), await model());

    await start(page).click();
    await phase(page, /exploring/i, { patience });
    must((await mission()).phase === 'exploring', 'START on the page is not seen over CoAP');
    await until(async () => /robot\( state\((moving|rotate)/.test(await model()), 'a robot that moves, over CoAP', patience);

    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    must((await mission()).holds.includes('operator'), 'STOP on the page is not seen over CoAP');
    const robot = JSON.parse((await coap('GET robot')).replace('2.05 ', ''));
    must(robot.state === 'stopped', `after STOP the robot is ${robot.state} over CoAP`);
    await page.getByText(`(${robot.position.x}, ${robot.position.y})`).first().waitFor();
    await picture('stopped');

    must((await coap('POST commands/start')).startsWith('2.04'), 'START over CoAP was refused');
    await page.getByText(/^Held: stopped by the operator/).waitFor({ state: 'hidden' });
    must((await coap('PUT resourcemodel h')).startsWith('2.04'), 'h over CoAP was refused');
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await picture('stopped-over-coap');
  },
};

export const lost = {
  browser: { timezoneId: 'Asia/Kathmandu' },
  tolerated: ['ERR_CONNECTION_REFUSED', 'ERR_INCOMPLETE_CHUNKED_ENCODING', 'ERR_CONNECTION_RESET', 'ERR_EMPTY_RESPONSE'],
  async play({ page, url, please, picture, patience }) {
    await page.goto(url);
    await phase(page, /idle/i, { patience });
    const banner = page.getByText(/connection (is )?lost|lost (the )?connection/i).first();
    must(!(await banner.isVisible()), 'the connection is said to be lost while it stands');
    await please('kill');
    await banner.waitFor();
    await picture('lost');
    // The page shows times in the program's time zone, although the browser is in another.
    const [, hours, minutes] = /state at (\d+):(\d+):\d+ \(UTC/.exec(await page.locator('#lost').innerText()) ?? [];
    const here = new Date();
    const apart = Math.abs(hours * 60 + Number(minutes) - here.getHours() * 60 - here.getMinutes());
    must(Math.min(apart, 1440 - apart) <= 5, `the page says ${hours}:${minutes}, the program's clock says ${here}`);
    must(await stop(page).isEnabled(), 'STOP stays when the connection is lost');
    must(await start(page).isDisabled(), 'START would act blindly');
    await please('start');
    await banner.waitFor({ state: 'hidden' });
    await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
    await phase(page, /exploring/i, { patience });
    await picture('back');
  },
};

/** The bar of other pages is updated without a reload, and says when hallsweep does not answer. */
export const elsewhere = {
  tolerated: ['404', 'ERR_CONNECTION_REFUSED', 'ERR_CONNECTION_RESET', 'ERR_EMPTY_RESPONSE'],
  async play({ page, url, please, picture, patience }) {
    const bar = page.locator('#elsewhere #bar');
    for (const path of ['/missions', '/laboratory', '/api', '/simulator', '/simulator/editor', '/console/confirm/reset', '/nowhere']) {
      await page.goto(url + path);
      await bar.filter({ hasText: /idle[^]*LED[^]*as of \d+:\d+:\d+/i }).waitFor();
      for (const [width, height] of [[320, 640], [390, 844], [768, 1024], [1280, 800]]) {
        await resize(page, width, height);
        await hits(page, `${path} with its bar`);
      }
    }
    await page.goto(`${url}/laboratory`);
    await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
    await bar.filter({ hasText: /exploring/i }).waitFor();
    await picture('follows');
    const silent = page.getByText('hallsweep does not answer');
    must(!(await silent.isVisible()), 'the bar is called old while hallsweep answers');
    await please('kill');
    await silent.waitFor();
    await bar.filter({ hasText: /as of \d+:\d+:\d+/ }).waitFor();
    await picture('old');
    await please('start');
    await silent.waitFor({ state: 'hidden' });
  },
};

/** Places of the controls that an operator uses; they must not move by themselves. */
const places = (page) => page.evaluate(() => Object.fromEntries(['stop-button', 'actions', 'temperature', 'celsius'].map((id) => {
  const { x, y, width } = document.getElementById(id).getBoundingClientRect();
  return [id, `${Math.round(x)},${Math.round(y)},${Math.round(width)}`];
})));

export const steady = {
  async play({ page, url, picture, patience }) {
    const stays = async (before, when) => {
      const after = JSON.stringify(await places(page));
      must(after === JSON.stringify(before), `${when} the controls moved from ${JSON.stringify(before)} to ${after}`);
    };
    await page.goto(url);
    await phase(page, /idle/i, { patience });
    const before = await places(page);
    await start(page).click();
    await phase(page, /exploring/i, { patience });
    await stays(before, 'when the search began');
    await appears(page, safe(page), { patience });
    await picture('arrived');
    await stays(before, 'when a piece arrived');
    const waits = page.locator('#inspect [data-since]');
    const first = await waits.innerText();
    await page.waitForTimeout(1500);
    must(await waits.innerText() !== first, `the time a piece waits stands still at ${first}`);
    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await stays(before, 'after STOP');

    // Typed and chosen values survive changes by other clients, and a temperature that is too high shows what ends
    // the hold.
    const headers = { 'content-type': 'application/json' };
    await fetch(`${url}/api/v1/temperature`, { method: 'PUT', headers, body: '{"celsius":31.5}' });
    await page.getByText('An operator reported 31.5 °C').waitFor();
    must((await page.locator('#temperature .reading').innerText()) === '31.5 °C', 'the headline is not the reading that is too high');
    await picture('too-hot');
  },
};

/** The robot moves home while a question is open: STOP needs one press, and Escape presses STOP. */
const question = {
  async play({ page, url, picture, patience }) {
    const state = async () => (await fetch(`${url}/api/v1/state`)).json();
    const moves = async (what) => {
      for (const end = Date.now() + patience; ; await page.waitForTimeout(20)) {
        const { mission: { phase: now, holds }, robot } = await state();
        if (now === 'returningHome' && holds.length === 0 && robot.state !== 'stopped') return;
        // At full speed the robot may already be home between two checks; STOP must be reachable there too.
        if (now === 'atHome' && holds.length === 0) return;
        must(Date.now() < end, `the robot does not move home ${what}`);
      }
    };
    const stopped = async (what) => {
      for (const end = Date.now() + patience; ; await page.waitForTimeout(20)) {
        const { mission, robot } = await state();
        if (mission.holds.includes('operator') && robot.state === 'stopped') return;
        must(Date.now() < end, `${what} did not stop the robot`);
      }
    };
    const dialog = page.getByRole('dialog');
    await page.goto(url);
    await start(page).click();
    await appears(page, danger(page), { patience });
    await look(page);
    await home(page).click();
    await moves('at first');

    await danger(page).click();
    await dialog.waitFor();
    await stop(page).click();
    await stopped('one click on STOP');
    await fits(page);
    await picture('asked');
    // The operator resumes after seeing the stop. A command from before the stop is refused as outdated.
    await page.getByText('stopped by the operator').first().waitFor();
    await dialog.getByRole('button', { name: /No/ }).click();
    await dialog.waitFor({ state: 'hidden' });

    await home(page).click();
    await moves('again');
    await danger(page).click();
    await dialog.waitFor();
    await page.keyboard.press('Escape');
    await stopped('one Escape');
    must(await dialog.isHidden(), 'the question is still open');
    must((await state()).luggage[0].verdict === 'pending', 'a question that was taken back decided something');
  },
};
export { question };
export const questionOnPhone = { ...question, browser: phone.browser };

export const hung = {
  async play({ page, url, please, picture, patience }) {
    await page.goto(url);
    await phase(page, /idle/i, { patience });
    const before = await places(page);
    await please('freeze');
    await stop(page).click();
    const why = page.locator('#why-stop').filter({ hasText: /not confirmed.*own switch/ });
    await why.waitFor();
    must(await stop(page).isEnabled(), 'STOP is disabled');
    const opacity = await stop(page).evaluate((one) => getComputedStyle(one).opacity);
    must(opacity === '1', 'STOP looks disabled');
    await page.getByText(/connection lost/i).waitFor();
    await picture('hung');
    must(JSON.stringify(await places(page)) === JSON.stringify(before), 'the controls moved when the connection was lost');
    await please('thaw');
    await page.getByText(/connection lost/i).waitFor({ state: 'hidden' });
    await stop(page).click();
    await why.waitFor({ state: 'hidden' });
  },
};

/** The message about a missing answer never covers STOP, the photo, the verdict or a question, at any window size. */
export const said = {
  tolerated: ['ERR_'],
  async play({ page, url, please, picture, patience }) {
    await page.goto(url);
    await start(page).click();
    await appears(page, safe(page), { patience });
    await photoIsShown(page, await numberOf(safe(page)));
    await please('freeze');
    await stop(page).click();
    await page.locator('#why-stop').filter({ hasText: /not confirmed/ }).waitFor();
    await page.locator('#lost').waitFor();
    await page.evaluate(() => ask(document.querySelector('#inspect [data-confirm]')));
    for (const [width, height] of [[390, 844], [844, 390], [1000, 700], [1280, 800], [2560, 1300]]) {
      await resize(page, width, height);
      await page.evaluate(() => scrollTo(0, 0));
      const wrong = await page.evaluate(() => {
        const boxes = (which) => [...document.querySelectorAll(which)].map((one) => [one, one.getBoundingClientRect()]);
        const lies = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
        for (const [words, box] of boxes('#why-stop, #lost')) {
          if (box.top < 0 || box.left < 0 || box.right > innerWidth || box.bottom > innerHeight) return `${words.id} is not whole`;
          const others = boxes('#why-stop, #lost, #stop-button, #inspect .photo img, #inspect .pair, #confirm').filter(([one]) => one !== words);
          const under = others.find(([, other]) => lies(box, other));
          if (under) return `${words.id} lies over ${under[0].id || under[0].outerHTML}`;
        }
        return null;
      });
      await picture(`${width}`);
      must(wrong === null, `on ${width} by ${height} pixels ${wrong}`);
    }
    await please('thaw');
    await page.locator('#lost').waitFor({ state: 'hidden' });
  },
};

/** An operator signs in by a link, a viewer by typing the token; an unknown client is sent to the sign-in page. */
const signedIn = {
  tolerated: ['401', '403', 'ERR_INCOMPLETE_CHUNKED_ENCODING'],
  async play({ page, url, picture, patience }) {
    const { OPERATOR, VIEWER, DATA, PROGRAM } = process.env;
    const field = page.getByLabel('Token');
    const signIn = button(page, 'Sign in');
    const state = async () => (await fetch(`${url}/api/v1/state`, { headers: { authorization: `Bearer ${OPERATOR}` } })).json();

    await page.goto(url);
    await page.waitForURL(/\/sign-in$/);
    await field.fill('not a token');
    await signIn.click();
    await page.getByText('This token is not known here').waitFor();
    await picture('unknown');
    await field.fill(VIEWER);
    await signIn.click();
    await phase(page, /idle/i, { patience });
    await menu(page);
    await page.getByText('lobby').waitFor();
    await fits(page);
    must(await start(page).isDisabled(), 'a viewer could start');
    await page.getByText('START: you are signed in as a viewer.').waitFor();
    const notice = await page.getByText('You are signed in as a viewer: you see everything and may press STOP.').boundingBox();
    must(notice && notice.y + notice.height < page.viewportSize().height, 'a viewer is not told at once why the buttons are dead');
    // Zooming, the timeline, the list of keys and the language are available to everybody.
    const living = await page.locator('button:enabled:visible:not(.lens *, .transport *, .keys-open, .languages *)').allInnerTexts();
    must(living.length === 2 && /STOP/.test(living.join()) && /Sign out/.test(living.join()), `alive for a viewer: ${living}`);
    await hits(page, 'the console of a viewer');
    await picture('viewer');
    await page.goto(`${url}/sign-in?token=${OPERATOR}`);
    await hits(page, 'the page where one signs in, for somebody who is signed in');
    await page.goto(url);

    // Changes by others appear, and the buttons stay disabled when a piece arrives.
    const headers = { authorization: `Bearer ${OPERATOR}` };
    await fetch(`${url}/api/v1/commands/start`, { method: 'POST', headers });
    await danger(page).waitFor();
    must(await danger(page).isDisabled() && await safe(page).isDisabled(), 'a viewer could give a verdict');
    await photoIsShown(page, await numberOf(danger(page)));
    await picture('viewer-asked');
    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    must((await state()).mission.holds.includes('operator'), 'a viewer could not stop');

    await menu(page);
    await button(page, 'Sign out').click();
    await page.waitForURL(/\/sign-in$/);
    await page.goto(`${url}/sign-in?token=${OPERATOR}`);
    must((await field.inputValue()) === OPERATOR, 'the link does not fill the field');
    await picture('link');
    await signIn.click();
    await appears(page, safe(page), { patience });
    must(await safe(page).isEnabled(), 'an operator could not answer');
    await fits(page);
    await picture('operator');

    // After a key is replaced, its users get the sign-in page without pressing anything.
    execFileSync(PROGRAM, ['token', 'rotate', 'operator', '--data', DATA]);
    await page.waitForURL(/\/sign-in\?undone=watching$/);
    await page.getByText('You are not signed in any more').waitFor();
    await picture('shut-out');

    // The page does not treat a STOP that was not accepted as given.
    await page.goto(`${url}/sign-in?token=${VIEWER}`);
    await signIn.click();
    await page.waitForURL(`${url}/`);
    await page.goto(`${url}/missions`);
    execFileSync(PROGRAM, ['token', 'rotate', 'lobby', '--data', DATA]);
    const asked = () => fetch(`${url}/api/v1/state`, { headers: { authorization: `Bearer ${VIEWER}` } });
    await until(async () => (await asked()).status === 401, 'that the old key is not known any more', patience);
    await stop(page).click();
    await page.waitForURL(/\/sign-in\?undone=stop$/);
    await page.getByText(/^STOP was not carried out/).waitFor();

    // The STOP is sent when somebody has signed in again.
    const keys = execFileSync(PROGRAM, ['token', '--data', DATA]).toString();
    const tokenOf = (name) => keys.split(`${name} (`)[1].split('\n')[1].trim().split(/\s+/)[1];
    const again = { authorization: `Bearer ${tokenOf('operator')}` };
    const epoch = async () => (await (await fetch(`${url}/api/v1/state`, { headers: again })).json()).mission.epoch;
    const before = await epoch();
    await field.fill(tokenOf('lobby'));
    await signIn.click();
    await page.waitForURL(`${url}/`);
    await page.getByText('STOP is confirmed.').waitFor();
    must(await epoch() === before + 1, 'the STOP that was not given was not sent once');
  },
};
export { signedIn };
export const signedInOnPhone = { ...signedIn, browser: phone.browser };
