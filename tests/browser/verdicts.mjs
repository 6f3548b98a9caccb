// The moment of the verdict: close look at the photo, notes, keys, the question beside the photo, notifications to
// people who look elsewhere, and the incident.

import { appears, button, danger, fits, hits, look, menu, must, numberOf, phase, photoIsShown, resize, safe, start, until } from './person.mjs';

const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

const record = async (url, id) => (await fetch(`${url}/api/v1/luggage/${id}`)).json();
const dialog = (page) => page.getByRole('dialog', { name: /dangerous\?/ });
const note = (page) => page.getByRole('textbox', { name: /Note/ });

/** Number of the next piece that waits. */
async function asked(page, patience, after = 0) {
  const next = button(page, after ? new RegExp(`SAFE #(?!${after}\\b)\\d+`) : /SAFE #\d+/).first();
  await appears(page, next, { patience });
  const id = await numberOf(next);
  await photoIsShown(page, id);
  return id;
}

/** Factor by which the photo is enlarged. */
const scale = (page) => page.locator('#inspect .viewer img').evaluate((image) => new DOMMatrix(getComputedStyle(image).transform).a);

/** Checks that the question does not cover the photo, and that the photo is on the screen. */
async function isBeside(page, when) {
  const [question, photo] = await Promise.all([dialog(page).boundingBox(), page.locator('#inspect .viewer img').boundingBox()]);
  const apart = question.x >= photo.x + photo.width || photo.x >= question.x + question.width
    || question.y >= photo.y + photo.height || photo.y >= question.y + question.height;
  const { width, height } = page.viewportSize();
  must(apart, `${when} at ${width}×${height} the question lies over the photo: ${JSON.stringify([question, photo])}`);
  must(photo.y >= 0 && photo.y + photo.height <= height, `${when} the photo is not to be seen: ${JSON.stringify(photo)}`);
  // While a question is open the photo accepts no clicks, so `elementFromPoint` does not return the photo.
  const over = await page.evaluate(({ x, y, width, height }) => [0.1, 0.5, 0.9].some((part) =>
    document.elementFromPoint(x + width * part, y + height * part)?.closest('dialog, #top, #stop')), photo);
  must(!over, `${when} something lies over the photo`);
  await hits(page, when);
}

/** A key that is pressed at the moment when another piece appears is not sent. */
async function pressesOnChange(page) {
  await page.evaluate(() => {
    const inspect = document.getElementById('inspect');
    globalThis.changed = 0;
    new MutationObserver(() => {
      if (!inspect.dataset.luggage) return;
      globalThis.changed += 1;
      // Runs after the page's own observers.
      queueMicrotask(() => document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 's', bubbles: true, cancelable: true })));
    }).observe(document.getElementById('desk'), { subtree: true, attributeFilter: ['data-luggage'] });
  });
}

/** Presses a key. If the page says that it sent nothing, presses again, as a person does, and prints the reason. */
async function pressUntil({ page, key, isDone, patience }) {
  const reason = page.locator('#why-verdict');
  // A page that has heard nothing for some seconds offers no button until it is told what holds.
  await until(() => safe(page).isEnabled(), 'SAFE on offer', patience);
  await page.keyboard.press(key);
  let presses = 1;
  await until(async () => {
    if (await isDone()) return true;
    const said = await reason.innerText();
    if (said) {
      must(presses < 4, `${key} was pressed ${presses} times, and the page still says: ${said}`);
      console.log(`${key} did nothing, because: ${said}`);
      await look(page);
      if (await isDone()) return true;
      presses += 1;
      await page.keyboard.press(key);
    }
    return false;
  }, `what ${key} does`, patience);
}

async function giveBoth({ page, url, picture, patience }) {
  await page.goto(url);
  await start(page).click();
  const first = await asked(page, patience);
  const isPending = async (id, when) => must((await record(url, id)).verdict === 'pending', `${when} decided luggage #${id}`);

  const photo = page.locator('#inspect a.photo');
  await photo.focus();
  await page.keyboard.press('+');
  await page.keyboard.press('+');
  must(await scale(page) > 2, `two presses of + enlarge ${await scale(page)} times`);
  const before = await page.locator('#inspect .viewer img').boundingBox();
  await page.keyboard.press('ArrowRight');
  must((await page.locator('#inspect .viewer img').boundingBox()).x < before.x, 'an arrow does not move the photo');
  await picture('closely');
  await page.keyboard.press('0');
  must(await scale(page) === 1, '0 does not show the whole photo');
  await photo.hover();
  await page.mouse.wheel(0, -400);
  await until(async () => await scale(page) > 1.5, 'the wheel enlarging the photo', patience);
  await page.keyboard.press('0');

  // Typed text and keys with a modifier are not commands.
  await note(page).fill('');
  await note(page).pressSequentially('sad <b>bag</b>? ');
  for (const key of ['Control+s', 'Alt+d', 'Meta+s', 'Shift+S']) {
    await photo.focus();
    await page.evaluate((combined) => {
      const [modifier, key] = combined.split('+');
      const flags = { ctrlKey: modifier === 'Control', altKey: modifier === 'Alt', metaKey: modifier === 'Meta', shiftKey: modifier === 'Shift' };
      document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key, ...flags, bubbles: true, cancelable: true }));
    }, key);
    must(await dialog(page).isHidden(), `${key} asked`);
  }
  await isPending(first, 'typing, or a key with a modifier');
  await page.keyboard.press('?');
  await page.getByRole('dialog', { name: 'Keys' }).waitFor();
  await page.keyboard.press('s');
  await page.getByRole('dialog', { name: 'Keys' }).waitFor({ state: 'hidden' });
  await isPending(first, 'a key while the list of keys is open');

  await pressesOnChange(page);
  await photo.focus();
  await pressUntil({ page, key: 's', isDone: async () => (await record(url, first)).verdict === 'safe', patience });
  must((await record(url, first)).decided.note === 'sad <b>bag</b>?', `noted: ${(await record(url, first)).decided.note}`);

  const second = await asked(page, patience, first);
  await page.getByText('The page changed just before you pressed').waitFor();
  must(await page.evaluate(() => globalThis.changed) > 0, 'nothing was pressed in that moment');
  await isPending(second, 'a key in the moment in which the piece came up');
  must(await note(page).inputValue() === '', 'the note on one piece stands at the next');

  await note(page).fill('wires');
  await look(page);
  for (const [width, height] of [[1280, 800], [1920, 1080], [768, 1024], [390, 844], [844, 390]]) {
    await resize(page, width, height);
    await photo.focus();
    await page.keyboard.press('d');
    await dialog(page).waitFor();
    await isBeside(page, 'when D asks');
    if (width === 1280) await picture('beside');
    await dialog(page).getByRole('button', { name: /No/ }).click();
    await dialog(page).waitFor({ state: 'hidden' });
  }
  await resize(page, 1280, 800);
  await isPending(second, 'a question that was taken back');
  await page.keyboard.press('f');
  const large = await page.locator('#inspect .viewer img').boundingBox();
  must(large.width > 500, `the large photo is ${large.width} pixels wide`);
  await hits(page, 'beside the large photo');
  await picture('large');
  await page.keyboard.press('d');
  await dialog(page).waitFor();
  await isBeside(page, 'beside the large photo');
  // The second click of a double click on DANGER must not answer the question.
  await page.evaluate(() => document.getElementById('confirm-no').click());
  await page.evaluate(() => {
    document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'd', bubbles: true, cancelable: true }));
    const second = new MouseEvent('click', { detail: 2, bubbles: true, cancelable: true });
    return new Promise((done) => setTimeout(() => done(document.getElementById('confirm-yes').dispatchEvent(second)), 0));
  });
  await isPending(second, 'an answer that came with the question');
  await look(page);
  await dialog(page).getByRole('button', { name: /Yes/ }).click();
  await phase(page, /bomb located/i, { patience });
  must((await record(url, second)).decided.note === 'wires', 'the note did not go with the question');
}
export const verdictKeys = { play: giveBoth };

/** A question that another operator has answered closes, and the page says what happened. */
export const overtaken = {
  async play({ page, url, picture, patience }) {
    await page.goto(url);
    await start(page).click();
    for (const [verdict, word] of [['safe', 'SAFE'], ['danger', 'DANGER']]) {
      const id = await asked(page, patience);
      await look(page);
      await page.keyboard.press('d');
      await dialog(page).waitFor();
      await fetch(`${url}/api/v1/luggage/${id}/verdict`,
        { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ verdict }) });
      await page.getByText(new RegExp(`luggage #${id} was judged ${word} by operator at \\d+:\\d+:\\d+\\.`)).waitFor();
      must(await dialog(page).isHidden(), 'the question about a piece that was judged is open');
      await picture(verdict);
      // When another piece follows, the page still announces the verdict; then the next piece is judged.
      if (verdict === 'safe') await appears(page, button(page, new RegExp(`SAFE #(?!${id}\\b)\\d+`)).first(), { patience });
    }
  },
};

/** Nothing can be pressed through a dialog that covers the page; Escape, which is STOP, closes the dialog. */
export const covers = {
  async play({ page, url, picture, patience }) {
    const keys = page.getByRole('dialog', { name: 'Keys' });
    const through = async (one, what) => {
      const { x, y, width, height } = await one.boundingBox();
      await page.mouse.click(x + width / 2, y + height / 2);
      must(!(await one.evaluate((button) => button.focus() ?? button === document.activeElement)), `${what} is reached by keys through the list`);
    };
    await page.goto(url);
    const go = await start(page).elementHandle();
    await page.keyboard.press('?');
    await keys.waitFor();
    await picture('keys');
    await through(go, 'START');
    await look(page);
    must((await (await fetch(`${url}/api/v1/state`)).json()).mission.phase === 'idle', 'START was pressed through the list of keys');
    await page.keyboard.press('Escape');
    await keys.waitFor({ state: 'hidden' });
    // Escape was a STOP as well, and a START that is pressed before the page shows it is refused.
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await start(page).click();
    const id = await asked(page, patience);
    await look(page);
    const yes = await safe(page).elementHandle();
    await page.keyboard.press('?');
    await keys.waitFor();
    await through(yes, 'SAFE');
    for (let press = 0; press < 30; press++) {
      await page.keyboard.press('Tab');
      const beside = await page.evaluate(() => {
        const one = document.activeElement;
        return one !== document.body && !one.closest('dialog, #stop') && one.outerHTML.slice(0, 100);
      });
      must(!beside, `Tab leads through the list of keys to ${beside}`);
    }
    await page.keyboard.press('Escape');
    await keys.waitFor({ state: 'hidden' });
    await page.keyboard.press('f');
    await page.locator('html[data-large]').waitFor();
    await page.keyboard.press('Escape');
    await page.locator('html:not([data-large])').waitFor();
    must((await record(url, id)).verdict === 'pending', 'SAFE was pressed through the list of keys');
    await page.keyboard.press('s');
    await until(async () => (await record(url, id)).verdict === 'safe', 'S after Escape giving the verdict', patience);
  },
};

export const verdictOnPhone = {
  browser: phone,
  async play({ page, url, picture, patience }) {
    await page.goto(url);
    await start(page).click();
    const id = await asked(page, patience);
    await fits(page);
    await look(page);
    await danger(page).click();
    await dialog(page).waitFor();
    await isBeside(page, 'on a phone');
    await picture('beside');
    must((await record(url, id)).verdict === 'pending', 'the first press decided');
    await dialog(page).getByRole('button', { name: /No/ }).click();
    // The page of the photo has buttons for people who cannot pinch.
    await page.goto(`${url}/luggage/${id}`);
    await button(page, 'Larger').click();
    const large = await page.locator('.viewer img').evaluate((image) => new DOMMatrix(getComputedStyle(image).transform).a);
    must(large > 1, 'the button does not enlarge the photo');
    await fits(page);
  },
};

export const notePlain = {
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture, patience }) {
    const waiting = { patience, reload: true };
    await page.goto(url);
    await start(page).click();
    await appears(page, safe(page), waiting);
    const first = await numberOf(safe(page));
    await note(page).fill('a lunch box,\nopen');
    await safe(page).click();
    must((await record(url, first)).decided.note === 'a lunch box, open', 'the note did not go with SAFE');
    const next = button(page, new RegExp(`DANGER #(?!${first}\\b)\\d+`)).first();
    await appears(page, next, waiting);
    const second = await numberOf(next);
    await note(page).fill('wires <b>');
    await next.click();
    await page.getByText('wires <b>').waitFor();
    must((await record(url, second)).verdict === 'pending', 'the first press decided');
    await picture('sure');
    await button(page, /Yes/).click();
    must((await record(url, second)).decided.note === 'wires <b>', 'the note did not go with DANGER');
    await phase(page, /bomb located/i, waiting);
    await page.getByRole('heading', { name: /Danger: a bomb/ }).waitFor();
    await picture('incident');
  },
};

export const called = {
  async play({ page, url, picture, patience }) {
    // A headless browser shows no notifications and is always visible, so both are replaced.
    await page.addInitScript(() => {
      globalThis.calls = [];
      globalThis.away = false;
      globalThis.Notification = class {
        static permission = sessionStorage.getItem('permission') ?? 'default';
        static async requestPermission() {
          this.permission = sessionStorage.getItem('answer') ?? 'denied';
          sessionStorage.setItem('permission', this.permission);
          return this.permission;
        }
        constructor(words, { tag }) {
          globalThis.calls.push(`${tag}: ${words}`);
        }
        close() {}
      };
      Object.defineProperty(document, 'hidden', { get: () => globalThis.away });
    });
    const lookElsewhere = (away) => page.evaluate((is) => {
      globalThis.away = is;
      document.dispatchEvent(new Event('visibilitychange'));
    }, away);
    const calls = () => page.evaluate(() => globalThis.calls);
    const notify = page.getByRole('switch', { name: /notify me/ });
    await page.goto(url);
    await menu(page);
    must(!(await notify.isChecked()) && !(await page.getByRole('switch', { name: /sound/ }).isChecked()), 'a switch is on from the start');
    await notify.click();
    await page.getByText('This browser blocks notifications').waitFor();
    must(!(await notify.isChecked()), 'it is on although it was denied');
    await page.evaluate(() => {
      sessionStorage.setItem('answer', 'granted');
      sessionStorage.removeItem('permission');
    });
    await page.reload();
    await menu(page);
    await notify.click();
    await until(() => page.evaluate(() => localStorage.getItem('hallsweep-notify') === 'on'), 'the switch remembered', patience);
    await page.getByRole('switch', { name: /sound/ }).click();
    await picture('switches');
    await page.reload();
    await menu(page);
    await until(() => notify.isChecked(), 'the switch on after a reload', patience);

    await start(page).click();
    const first = await asked(page, patience);
    must((await calls()).length === 0, `called although somebody looks: ${await calls()}`);
    await look(page);
    await lookElsewhere(true);
    const decide = (id, verdict) => fetch(`${url}/api/v1/luggage/${id}/verdict`,
      { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ verdict }) });
    await decide(first, 'safe');
    await until(async () => (await calls()).some((call) => /^hallsweep-waits-\d+ http:\S+: Luggage #\d+ waits for your verdict\.$/.test(call)),
      'the call for the piece that waits', patience);
    const second = Number(/waits-(\d+)/.exec((await calls())[0])[1]);
    await decide(second, 'danger');
    await until(async () => (await calls()).some((call) => /^hallsweep-alarm-\d+ http:\S+: Alarm/.test(call)), 'the call for the alarm', patience);
    must((await calls()).length === 2, `called more than once for each: ${JSON.stringify(await calls())}`);
  },
};

async function bomb({ page, url, picture, patience }) {
  await page.goto(url);
  must(await page.getByRole('heading', { name: /Danger/ }).isHidden(), 'there is an incident before there is a bomb');
  await start(page).click();
  const id = await asked(page, patience);
  await look(page);
  await note(page).fill('wires');
  await danger(page).click();
  await look(page);
  await dialog(page).getByRole('button', { name: /Yes/ }).click();
  const incident = page.getByRole('region', { name: /Danger: a bomb in the hall/ });
  await incident.waitFor();
  await incident.getByText('Nobody has acknowledged this alarm yet').waitFor();
  await incident.getByText('Keep 3 m away').waitFor();
  await incident.getByText(/m (east|south) of home/).waitFor();
  await incident.getByText('wires').waitFor();
  await photoIsShown(page, id);
  const { x, y } = (await record(url, id)).cell;
  const circle = page.locator('#hall-evacuation circle');
  const drawn = await circle.evaluate((one) => [one.getAttribute('cx'), one.getAttribute('cy'), one.getAttribute('r')].map(Number));
  must(JSON.stringify(drawn) === JSON.stringify([x * 10 + 5, y * 10 + 5, 60]), `the circle is ${drawn}`);
  await fits(page);
  await page.evaluate(() => scrollTo(0, 0));
  const top = await incident.boundingBox();
  must(top.y < page.viewportSize().height / 2, `the incident begins at ${top.y}`);
  await picture('incident');
  // Another client acknowledges the alarm. A press that was aimed at the old button does not hit the new one in its place.
  const [{ id: alarm }] = (await (await fetch(`${url}/api/v1/state`)).json()).alarms;
  await page.evaluate(() => new MutationObserver((_, observer) => {
    const next = document.querySelector('.acts .loud');
    if (!/RETRIEVE/.test(next?.textContent)) return;
    observer.disconnect();
    requestAnimationFrame(() => next.click());
  }).observe(document.getElementById('incident').parentElement, { subtree: true, childList: true, attributes: true }));
  await look(page);
  await fetch(`${url}/api/v1/alarms/${alarm}/acknowledge`, { method: 'POST' });
  await page.getByText('The page changed just before you pressed').waitFor();
  await incident.getByText(/acknowledged by operator/).waitFor();
  await phase(page, /bomb located/i, { patience });
  await hits(page, 'at an incident');
  if (page.viewportSize().width >= 1280) {
    for (const [width, height] of [[1280, 720], [1499, 900], [1500, 900], [1999, 1000], [2000, 1000]]) {
      await resize(page, width, height);
      const share = await page.locator('#stage').evaluate((stage) => stage.clientWidth * stage.clientHeight / innerWidth / innerHeight);
      must(share >= 0.5, `at ${width}×${height} the hall has ${share} of the window`);
    }
    await resize(page, 1280, 800);
  }
  await picture('acknowledged');
}
export const incident = { play: bomb };
export const incidentOnPhone = { browser: phone, play: bomb };
