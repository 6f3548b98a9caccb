// Pictures of the console for people to look at: every state at every size, light and dark, in both languages.
// docs/pictures/renew plays these scenarios; the tests play only `components`.

import { readFileSync } from 'node:fs';
import { appears, danger, look, must, phase, resize, safe, start, until } from './person.mjs';

const SIZES = [[1280, 720], [1280, 800], [1920, 1080], [820, 1180], [390, 844]];
const FRAME_MS = 250;
const LANGUAGES = ['en-GB', 'it-IT'];

export const pictures = {
  async play({ page, url, picture, patience }) {
    const json = { 'content-type': 'application/json' };
    const ask = async (method, path, body) => (await fetch(`${url}/api/v1/${path}`, { method, headers: json, body: body && JSON.stringify(body) })).json();
    const state = () => ask('GET', 'state');
    const simulator = (settings) => ask('PUT', 'simulator', settings);
    const command = (name) => ask('POST', `commands/${name}`);
    const isIn = (name) => until(async () => (await state()).mission.phase === name, name, patience);
    const verdict = async (verdict) => {
      const { luggage } = await state();
      await ask('POST', `luggage/${luggage.find((piece) => piece.verdict === 'pending').id}/verdict`, { verdict });
    };

    const pages = [];
    for (const locale of LANGUAGES) {
      const context = await page.context().browser().newContext({ locale });
      pages.push([locale.slice(0, 2), await context.newPage()]);
    }
    const all = async (what, path = '/') => {
      for (const [language, one] of pages) {
        await one.goto(url + path);
        for (const colorScheme of ['light', 'dark']) {
          await one.emulateMedia({ colorScheme });
          for (const [width, height] of SIZES) {
            await resize(one, width, height);
            await one.waitForTimeout(150);
            await picture(`${what}-${language}-${width}x${height}-${colorScheme}`, one);
          }
        }
      }
    };

    const waits = (count) => until(async () => (await state()).luggage.length === count, `piece ${count}`, patience);

    await all('idle');
    await command('start');
    for (const count of [1, 2]) {
      await waits(count);
      await verdict('safe');
    }
    await simulator({ speed: 0.1 });
    await all('exploring');
    await simulator({ speed: 'max' });
    await waits(3);
    await all('waiting');
    const [[, english]] = pages;
    await resize(english, 1280, 800);
    await english.emulateMedia({ colorScheme: 'light' });
    await english.keyboard.press('d');
    await picture('question-en', english);
    await verdict('safe');
    await simulator({ speed: 0.1 });
    await ask('PUT', 'temperature', { status: 'tooHigh' });
    await all('hot');
    await ask('PUT', 'temperature', { status: 'ok' });
    await command('stop');
    await all('stopped');
    await simulator({ speed: 'max' });
    await command('start');
    await waits(4);
    await verdict('danger');
    await isIn('bombLocated');
    await all('incident');
    for (const alarm of (await state()).alarms) await ask('POST', `alarms/${alarm.id}/acknowledge`);
    await simulator({ speed: 1 });
    await command('retrieve');
    await until(async () => (await state()).robots.some((robot) => robot.outside > 0), 'the pair on its way', patience);
    await simulator({ speed: 0.2 });
    await all('retrieving');
    await simulator({ speed: 'max' });
    await isIn('bagSecured');
    await all('secured');
    await all('past', '/missions/1/moment?at=40');
    for (const path of ['missions', 'missions/1', 'missions/1/retrieval', 'luggage/1', 'simulator', 'simulator/editor', 'laboratory', 'api', 'nowhere']) {
      await all(path.replaceAll('/', '-'), `/${path}`);
    }
  },
};

/** Buttons, chips, fields, messages, tables and lists on a page that only this scenario serves. */
export const components = {
  async play({ page, url, picture }) {
    const body = readFileSync(new URL('components.html', import.meta.url));
    await page.route(`${url}/components`, (route) => route.fulfill({ body, contentType: 'text/html' }));
    await page.goto(`${url}/components`);
    await page.evaluate(() => document.fonts.ready);
    must(await page.evaluate(() => document.fonts.check('16px Inter')), 'the typeface is not there');
    await resize(page, 900, 1180);
    for (const [name, media] of [['light', { colorScheme: 'light' }], ['dark', { colorScheme: 'dark' }], ['contrast', { colorScheme: 'light', contrast: 'more' }]]) {
      await page.emulateMedia(media);
      await picture(name);
    }
  },
};

/** A search from START to the secured bag, in frames of which docs/pictures makes the animation of the README. */
export const film = {
  async play({ page, url, picture, patience }) {
    const json = { 'content-type': 'application/json' };
    const ask = async (method, path, body) => (await fetch(`${url}/api/v1/${path}`, { method, headers: json, body: body && JSON.stringify(body) })).json();
    await resize(page, 1120, 700);
    await page.goto(url);
    await start(page).waitFor();
    let isOn = true;
    const filmed = (async () => {
      while (isOn) {
        await picture('frame');
        await page.waitForTimeout(FRAME_MS);
      }
    })();
    await ask('PUT', 'simulator', { speed: 12 });
    await look(page);
    await start(page).click();
    for (const answer of [safe, safe, danger]) {
      await appears(page, answer(page), { patience });
      await page.waitForTimeout(4 * FRAME_MS);
      await answer(page).click();
      await look(page);
    }
    await page.getByRole('button', { name: /Yes: DANGER/ }).click();
    await phase(page, /bomb located/i, { patience });
    await look(page);
    await page.getByRole('button', { name: /acknowledge/i }).click();
    await look(page);
    await page.getByRole('button', { name: /RETRIEVE/ }).click();
    await phase(page, /bag secured/i, { patience });
    await page.waitForTimeout(6 * FRAME_MS);
    isOn = false;
    await filmed;
  },
};
