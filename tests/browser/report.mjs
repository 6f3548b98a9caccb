// The report of a mission: it is saved from its page, which does not change, then opened as a file and printed.

import { readFileSync, writeFileSync } from 'node:fs';
import { checkOne } from './access.mjs';
import { appears, button, look, must, numberOf, phase, resize, safe, start, stop } from './person.mjs';

/** Runs a search with one safe and one dangerous piece, until the robot is home. */
async function search(page, url, waiting) {
  await page.goto(url);
  await phase(page, /idle/i, waiting);
  await start(page).click();
  await appears(page, safe(page), waiting);
  const first = await numberOf(safe(page));
  await look(page);
  await safe(page).click();
  const next = button(page, new RegExp(`DANGER #(?!${first}\\b)\\d+`)).first();
  await appears(page, next, waiting);
  await look(page);
  await next.click();
  await page.getByRole('dialog').getByRole('button', { name: /DANGER/ }).last().click();
  await phase(page, /bomb located/i, waiting);
}

/** Saves the file of a link; the page must stay open with its STOP. */
async function saved(page, name, to) {
  const before = page.url();
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name, exact: true }).click()]);
  must(download.suggestedFilename() === 'hallsweep-mission-1.html', download.suggestedFilename());
  await download.saveAs(to);
  must(page.url() === before && await stop(page).isVisible(), 'the page was left, and STOP with it');
}

/** Checks the file alone: it contains all pictures, fits on paper and on a phone, is accessible, and prints. */
async function opened(page, path, file) {
  const context = await page.context().browser().newContext();
  const paper = await context.newPage();
  const asked = [];
  paper.on('request', (request) => { if (!/^(data|file):/.test(request.url())) asked.push(request.url()); });
  await paper.goto(`file://${path}`);
  const pictures = await paper.evaluate(() => [...document.images].map(({ naturalWidth }) => naturalWidth));
  must(pictures.length === 2 && pictures.every((width) => width > 0), `pictures: ${pictures}`);
  for (const width of [390, 794, 1280]) {
    await resize(paper, width, 1000);
    const need = await paper.evaluate(() => document.documentElement.scrollWidth);
    must(need <= width, `the report is ${need} pixels wide, the screen ${width}`);
  }
  const found = [];
  await checkOne(paper, file, found);
  must(found.length === 0, found.join('\n'));
  const pdf = await paper.pdf({ preferCSSPageSize: true });
  writeFileSync(path.replace('.html', '.pdf'), pdf);
  const pages = pdf.toString('latin1').match(/\/Type\s*\/Page\b/g).length;
  must(pages >= 3 && pages <= 6, `${pages} pages of paper for two pieces`);
  must(asked.length === 0, `it asks for ${asked}`);
  await context.close();
}

export const report = {
  async play({ page, url, picture, patience }) {
    await search(page, url, { patience });
    await page.goto(`${url}/missions/1`);
    await picture('mission');
    const shots = new URL('../../target/tmp/browser/', import.meta.url).pathname;
    for (const [name, words] of [['English', 'Report of mission 1'], ['Italiano', 'Rapporto della missione 1']]) {
      const path = `${shots}report-${name}.html`;
      await saved(page, name, path);
      must(readFileSync(path, 'utf8').includes(`<h1>${words}</h1>`), `${words} is not its title`);
      await opened(page, path, name);
    }
  },
};
