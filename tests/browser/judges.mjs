// Two people judge: one is unsure at first. What the first answers stays hidden from the second, each on a page in another language. After a
// danger the search goes on, and both bombs are fetched, the second one first.

import { execFileSync } from 'node:child_process';
import { rmSync, writeFileSync } from 'node:fs';

import { appears, button, fits, look, must, numberOf, phase, photoIsShown, safe, start, tab, until } from './person.mjs';

async function signIn(page, url, token) {
  await page.goto(`${url}/sign-in?token=${token}`);
  await page.locator('form.sign-in button').click();
  await page.locator('#phase, .phase').first().waitFor();
}

const judges = {
  async play({ page, url, picture, patience }) {
    const { OPERATOR, SECOND, DATA, PROGRAM } = process.env;
    const waiting = { patience };
    const context = await page.context().browser().newContext({ locale: 'it-IT', viewport: { width: 1280, height: 800 } });
    const other = await context.newPage();
    await signIn(page, url, OPERATOR);
    await signIn(other, url, SECOND);
    const state = async () => (await page.request.get(`${url}/api/v1/state`)).json();
    const record = async (id) => (await page.request.get(`${url}/api/v1/luggage/${id}`)).json();

    // One judge cannot tell from the photo, and says so by a key. The robot goes round the piece, and asks again.
    await start(page).click();
    await appears(page, safe(page), waiting);
    const first = await numberOf(safe(page));
    await look(other);
    await until(() => button(other, new RegExp(`INCERTO: riguardare #${first}`)).isEnabled(), 'INCERTO on offer', patience);
    await other.getByRole('textbox', { name: /Nota/ }).fill('un’ombra');
    await other.locator('#inspect a.photo').focus();
    await other.keyboard.press('i');
    await until(async () => (await record(first)).photo.take === 3, 'two further photos', patience);
    const [doubt] = (await record(first)).unsure;
    must(doubt.by === 'second' && doubt.note === 'un’ombra', `unsure: ${JSON.stringify(doubt)}`);
    await page.locator('#inspect').getByText(`unsure about luggage #${first}, by second (note: un’ombra)`).waitFor();
    await page.locator('#inspect').getByText('another person judges now').waitFor();
    await until(async () => await page.locator('#inspect .takes li').count() === 2, 'the earlier photos beside the latest', patience);
    await picture('unsure');
    await picture('unsure-in-italian', other);

    // Safe by two. The first judge also answers the three questions, by keys.
    await photoIsShown(page, first);
    await look(page);
    for (const key of ['1', '1', '3']) await page.keyboard.press(key);
    must(await page.getByRole('radiogroup', { name: 'Hidden?' }).getByLabel('no', { exact: true }).isChecked(), 'the second press of 1 is no');
    await page.getByRole('textbox', { name: /Note/ }).fill('a lunch box');
    await picture('first-answers');
    await safe(page).click();
    const told = page.locator('#inspect .why').filter({ hasText: `Your answer about luggage #${first} is recorded.` });
    await told.waitFor();
    const isSeen = await told.evaluate((one) => {
      const { left, bottom } = one.getBoundingClientRect();
      return one.contains(document.elementFromPoint(left + 9, bottom - 3));
    });
    must(isSeen, 'what is said of the answer is out of sight');
    await picture('first-kept-back');
    must((await record(first)).verdict === 'pending', 'one key has made a piece safe');
    await look(other);
    const shown = await other.locator('body').innerText();
    must(!/lunch box|riservata|registrata|operator/.test(shown), `the second judge is told of the first: ${shown}`);
    await picture('second-asked', other);
    await other.getByRole('button', { name: new RegExp(`SICURO #${first}`) }).first().click();
    await until(async () => (await record(first)).verdict === 'safe', 'safe by two', patience);
    const { decided, judged } = await record(first);
    must(decided.by === 'second' && judged[0].by === 'operator', `judged by ${JSON.stringify([decided, judged])}`);
    must(judged[0].note === 'a lunch box' && judged[0].hidden === 'no' && judged[0].typical === 'yes', JSON.stringify(judged));

    // One danger is enough. The robot comes home, and the search goes on from there.
    const found = async (before, size) => {
      const asks = button(page, new RegExp(`DANGER #(?!${before}\\b)\\d+`)).first();
      await appears(page, asks, waiting);
      const id = await numberOf(asks);
      await photoIsShown(page, id);
      await look(page);
      await asks.click();
      const dialog = page.getByRole('dialog');
      if (size) await dialog.getByLabel('Size').selectOption(size);
      await fits(page);
      await picture(`danger-${size || 'unknown'}`);
      await dialog.getByRole('button', { name: /DANGER/ }).click();
      await phase(page, /bomb located/i, waiting);
      await look(page);
      await button(page, 'Acknowledge').click();
      await button(page, 'Acknowledge').waitFor({ state: 'hidden' });
      await look(page);
      return id;
    };
    const one = await found(first);
    await picture('one-bomb');
    await button(page, 'GO ON SEARCHING').click();
    const two = await found(one, 'suitcase');
    await fits(page);
    await picture('two-bombs');
    must((await state()).mission.keepOut.length === 2, 'each bomb has its ring');
    const sized = (await record(two)).decided;
    must(sized.size === 'suitcase' && sized.mandatoryM === 46 && sized.preferredM === 564, JSON.stringify(sized));
    await page.locator('#incident').getByText('Between 100 m and 564').waitFor();
    must(await page.locator('#hall-evacuation .evacuation').count() === 3, 'two circles of the suitcase, one of the settings');
    await page.locator('#checklist summary').click();
    await page.getByText('within 15 m of the piece').waitFor();

    // The operator chooses which one is fetched first.
    await button(page, `RETRIEVE #${two}`).click();
    await until(async () => (await record(two)).secured, 'the second bomb in the container', patience);
    await phase(page, /secured|located/i, waiting);
    must(!(await record(one)).secured, 'the other one was fetched too');
    await picture('second-fetched');
    await look(page);
    await button(page, /RETRIEVE/).first().click();
    await until(async () => (await record(one)).secured, 'both bombs in the container', patience);
    await phase(page, /secured/i, waiting);
    await picture('both-fetched');
    must(!(await state()).mission.keepOut, 'a ring is left');

    // An area that was searched is searched again: two cells of the map are its corners.
    const ways = await page.locator('#hall .visited').first().boundingBox();
    await tab(page, 'Drive');
    await page.getByText('Search an area again').click();
    await page.mouse.click(ways.x + 3, ways.y + 3);
    const again = page.locator('#again form');
    await until(async () => await again.getByLabel('Column', { exact: true }).inputValue() !== '', 'the first corner', patience);
    await again.getByLabel('Column', { exact: true }).fill('0');
    await again.getByLabel('to column').fill('1');
    for (const row of await again.getByLabel('row').all()) await row.fill('1');
    await picture('again');
    await again.getByRole('button').click();
    await phase(page, /exploring/i, waiting);
    await until(async () => !(await state()).mission.searchAgain, 'the area searched again', patience);
    await button(page, 'BACK HOME').click();
    await phase(page, /at home|home/i, waiting);
    await until(async () => (await state()).mission.phase === 'atHome', 'home again', patience);

    // The person in charge closes the mission, and has seen what is left open.
    await tab(page, 'Drive');
    await page.getByRole('link', { name: 'Close the mission' }).first().click();
    await page.getByLabel('Name of the person in charge').fill('Anna Rossi');
    const open = await page.locator('main li').allInnerTexts();
    must(open.some((line) => /cells never visited: \d+/.test(line)), `left open: ${open}`);
    await page.getByLabel('Note').fill('handed to the police');
    await picture('closing');
    await page.getByRole('button', { name: 'Close the mission' }).click();
    await tab(page, 'Drive');
    await page.locator('#more').getByText('Closed by Anna Rossi at').waitFor();
    await fits(page);
    await picture('closed');
    const { closed } = (await state()).mission;
    must(closed.by === 'operator' && closed.note === 'handed to the police' && closed.open.bombs === 0, JSON.stringify(closed));
    const report = await (await page.request.get(`${url}/missions/1/report`)).text();
    must(/answer kept back until now/.test(report) && /hidden: no/.test(report) && /unsure about luggage/.test(report)
      && /<dt>Closed<\/dt><dd>[^<]*mission closed by Anna Rossi, key operator/.test(report) && /2 of \d+ judged pieces were judged dangerous/.test(report), `the report says nothing of the judges: ${report}`);

    // The second operator hands the mission over. The code on the receipt and the report agree with the journal.
    await other.goto(`${url}/missions/1/receipts`);
    await other.getByRole('link', { name: 'Consegnare…' }).click();
    await other.getByLabel('Persona o ufficio che prende in consegna').fill('Questura, ispettore Bianchi');
    await other.getByLabel('Nota').fill('con le foto');
    await fits(other);
    await picture('handing-over', other);
    await other.getByRole('button', { name: 'Consegnare', exact: true }).click();
    await other.getByRole('heading', { name: 'Ricevuta della consegna a Questura, ispettore Bianchi' }).waitFor();
    for (const width of [320, 1280]) {
      await other.setViewportSize({ width, height: 800 });
      await fits(other);
    }
    await picture('receipt', other);
    const { receipts: [receipt] } = await (await page.request.get(`${url}/api/v1/missions/1/receipts`)).json();
    must(receipt.by.startsWith('second (console, ') && receipt.note === 'con le foto', JSON.stringify(receipt));
    await page.goto(`${url}/missions/1`);
    await page.getByRole('link', { name: 'Hand-overs' }).click();
    await page.getByText(receipt.code, { exact: true }).waitFor();
    await picture('receipt-in-english');
    writeFileSync(`${DATA}.html`, report);
    const checks = ['journal', '--data', DATA, 'check', '--receipt', receipt.code, '--report', `${DATA}.html`];
    const said = execFileSync(PROGRAM, checks, { encoding: 'utf8' });
    rmSync(`${DATA}.html`);
    must(said.match(/is confirmed/g)?.length === 2, `receipt and report: ${said}`);
    await context.close();
  },
};

export { judges };
