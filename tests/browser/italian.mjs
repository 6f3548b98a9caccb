// A whole mission in Italian, by keyboard. No visited page contains a phrase of the English files; phrases with
// values in them and phrases shorter than `SHORTEST` are not searched for. The language switch works in both
// directions. Other rules for phrases are tested elsewhere.

import { readFileSync, readdirSync } from 'node:fs';
import { appears, button, look, menu, must, numberOf, phase, stop } from './person.mjs';

const FOLDER = new URL('../../src/phrases/', import.meta.url);
const SHORTEST = 12; // shorter phrases could be parts of other words

/** Phrases of a language by id; only those of one line without values. */
function phrases(language) {
  const folder = new URL(`${language}/`, FOLDER);
  const lines = readdirSync(folder).flatMap((file) => readFileSync(new URL(file, folder), 'utf8').split('\n'));
  return new Map(lines.map((line) => /^([a-z][\w-]*) = ([^{<]+)$/.exec(line)).filter(Boolean).map(([, id, said]) => [id, said.trim()]));
}

const [inEnglish, inItalian] = ['en', 'it'].map(phrases);
const known = [...inItalian.values()].join('\n');
const foreign = [...inEnglish].filter(([id, said]) => said.length >= SHORTEST && inItalian.get(id) !== said && !known.includes(said)).map(([, said]) => said);

/** All text of the page that is shown or read aloud. */
const words = (page) => page.evaluate(() => {
  const attributes = ['title', 'aria-label', 'alt', 'placeholder'].flatMap((name) => [...document.querySelectorAll(`[${name}]`)].map((one) => one.getAttribute(name)));
  return [document.title, document.body.textContent, ...attributes].join('\n').replace(/\s+/g, ' ');
});

async function readsNoEnglish(page, where) {
  const read = await words(page);
  const left = foreign.filter((said) => read.includes(said));
  must(await page.evaluate(() => document.documentElement.lang) === 'it', `${where} is in Italian`);
  const month = /\b\d{1,2} (Jan|May|Jun|Jul|Aug|Sep|Oct|Dec) \d{4}/.exec(read);
  must(!month, `${where} has an English month: ${month?.[0]}`);
  must(left.length === 0, `${where} has English: ${left.join(' | ')}`);
}

const safe = (page) => button(page, /SICURO #\d+/).first();
const danger = (page) => button(page, /PERICOLO #\d+/).first();


export const italian = {
  browser: { locale: 'it-IT' },
  tolerated: ['404', '409'],
  async play({ page, url, picture, patience }) {
    must(foreign.length > 200, `${foreign.length} English phrases are looked for`);
    await page.goto(url);
    await phase(page, /in attesa/i, { patience });
    await readsNoEnglish(page, 'the console before the first mission');
    await button(page, /AVVIA/).first().click();
    await appears(page, safe(page), { patience });
    await look(page);
    await readsNoEnglish(page, 'a piece that waits');
    await picture('waits');
    const id = await numberOf(safe(page));
    await page.keyboard.press('s');
    await page.locator(`#piece-${id}`).filter({ hasText: 'sicuro' }).waitFor({ state: 'attached' });
    await stop(page).click();
    await page.getByText('fermato dall\'operatore').first().waitFor();
    await readsNoEnglish(page, 'a mission that is held');
    const start = button(page, /AVVIA/).first();
    if (await start.isEnabled()) await start.click();
    await appears(page, danger(page), { patience });
    await look(page);
    // The key of a verdict is the first letter of its word in the chosen language.
    await page.keyboard.press('d');
    must(!(await page.getByRole('dialog').isVisible()), 'D is no key here');
    await page.keyboard.press('p');
    await page.getByRole('dialog').getByText(/è pericoloso\?/).waitFor();
    await page.getByRole('dialog').getByRole('button', { name: /PERICOLO/ }).click();
    await phase(page, /bomba localizzata|con allarme/i, { patience });
    if (await start.isEnabled()) await start.click();
    await phase(page, /bomba localizzata/i, { patience });
    await readsNoEnglish(page, 'an incident');
    await picture('incident');
    await look(page);
    await button(page, /Conferma/).first().click();
    await page.getByText('confermato da').first().waitFor();

    // A refusal at the button is in Italian.
    const refused = await page.evaluate(async () => {
      const headers = { accept: 'application/json', 'content-type': 'application/x-www-form-urlencoded' };
      const answers = await Promise.all([['safe', 'id=99'], ['move', 'move=w']].map(async ([act, body]) =>
        (await (await fetch(`/console/${act}`, { method: 'POST', headers, body })).json()).detail));
      return answers.join('\n');
    });
    must(/non c'è nessun bagaglio #99/.test(refused), refused);
    must(!foreign.some((said) => refused.includes(said)) && !/\b(the|is|of)\b/.test(refused), `refusals have English: ${refused}`);

    for (const path of ['/missions', '/missions/1', '/missions/1?show=all', '/missions/1/moment?at=30', `/luggage/${id}`, '/console/confirm/reset', `/console/confirm/danger/${id}`,
      '/simulator', '/simulator/editor', '/laboratory', '/nowhere']) {
      await page.goto(url + path);
      await page.waitForTimeout(300);
      await readsNoEnglish(page, path);
    }

    await page.goto(url);
    await menu(page);
    await button(page, 'English').click();
    await phase(page, /home, bomb located/i, { patience });
    await menu(page);
    must((await page.getByRole('button', { name: 'Italiano' }).count()) === 1, 'the way back');
    await page.goto(`${url}/missions/1`);
    must(/What was done and found/.test(await words(page)), 'the choice holds on every page');
    await page.goto(url);
    await menu(page);
    await button(page, 'Italiano').click();
    await phase(page, /bomba localizzata/i, { patience });
  },
};
