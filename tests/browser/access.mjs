// Accessibility of the pages: axe-core finds no fault against WCAG 2.2 AA on any page in any state, in both colour
// schemes and both languages.

import { readFileSync } from 'node:fs';
import { appears, danger, look, menu, must, numberOf, phase, resize, safe, start, stop, tab } from './person.mjs';

const AXE = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');
const RULES = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa'];
const SCREENS = [[320, 640], [768, 1024], [1280, 800], [2560, 1440]];

/** Violations that axe finds in both languages; the Italian page is another client in the same state. */
async function check(page, where, found) {
  await checkOne(page, where, found);
  const context = await page.context().browser().newContext({ locale: 'it-IT' });
  const italian = await context.newPage();
  await italian.goto(page.url());
  await italian.waitForTimeout(300);
  if (await page.locator('#confirm[open]').count()) {
    await look(italian);
    await italian.locator('#inspect button.danger').click();
    await italian.getByRole('dialog').waitFor();
  }
  await checkOne(italian, `${where}, in Italian`, found);
  await context.close();
}

/** Violations that axe finds, on every screen and in both colour schemes. */
export async function checkOne(page, where, found) {
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    // A long page takes minutes on a slow machine, and a scenario that says nothing counts as hanging.
    console.log(`axe looks at: ${where}, ${colorScheme}`);
    for (const [width, height] of SCREENS) {
      await resize(page, width, height);
      await page.evaluate(AXE);
      const violations = await page.evaluate(async (rules) => {
        const { violations } = await axe.run(document, { runOnly: { type: 'tag', values: rules }, resultTypes: ['violations'] });
        return violations.map(({ id, help, nodes }) => `${id} (${help}): ${nodes.slice(0, 3).map(({ target, failureSummary }) => `${target} ${failureSummary}`).join(' | ')}`);
      }, RULES);
      for (const words of violations) found.push(`${where}, ${width}×${height}, ${colorScheme}: ${words.replace(/\s+/g, ' ')}`);
    }
  }
  await resize(page, 1280, 800);
}

export const accessible = {
  tolerated: ['404'],
  async play({ page, url, picture, patience }) {
    const found = [];
    await page.goto(url);
    await phase(page, /idle/i, { patience });
    await check(page, 'before the first mission', found);
    await start(page).click();
    await appears(page, safe(page), { patience });
    await look(page);
    const id = await numberOf(safe(page));
    await check(page, 'a piece waits', found);
    await danger(page).click();
    await page.getByRole('dialog').waitFor();
    await check(page, 'a question is open', found);
    await page.getByRole('button', { name: /No, go back/ }).click();
    await safe(page).click();
    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await look(page);
    await check(page, 'held', found);
    for (const name of ['Drive', 'Log', 'Status']) {
      await tab(page, name);
      await checkOne(page, `the tab ${name}`, found);
    }
    await menu(page);
    await checkOne(page, 'the menu is open', found);
    await page.locator('#theme').selectOption('contrast');
    await checkOne(page, 'high contrast', found);
    await page.locator('#theme').selectOption('');
    await menu(page);
    if (await start(page).isEnabled()) await start(page).click();
    await appears(page, danger(page), { patience });
    await look(page);
    await danger(page).click();
    await page.getByRole('dialog').getByRole('button', { name: /DANGER/ }).click();
    await phase(page, /bomb located|alarm/i, { patience });
    if (await page.getByText(/^Held: stopped by the operator/).isVisible()) await start(page).click();
    await phase(page, /bomb located/i, { patience });
    await check(page, 'a bomb is located', found);
    for (const path of ['/missions/1/moment?at=30', '/missions', '/missions/1', `/luggage/${id}`, '/console/confirm/reset', '/simulator', '/simulator/editor', '/laboratory', '/api', '/nowhere']) {
      await page.goto(url + path);
      await page.waitForTimeout(300);
      await check(page, path, found);
    }
    await picture('last');
    must(found.length === 0, `${found.length} findings:\n${found.join('\n')}`);
  },
};
