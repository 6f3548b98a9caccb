// The operator orders the areas of a hall, closes one, and has it searched again: by keys, by dragging, and without
// scripts. The hall has two areas, and a third on whose name markup would stand out. The map shows how well each cell
// was searched.

import { button, fits, must, phase, resize, start, tab, until } from './person.mjs';

const NAME = 'bar & <b>';
const drive = (page) => tab(page, 'Drive');
const rows = (page) => page.locator('#areas li b').allInnerTexts();
const isOrder = (expected) => async (page) => (await rows(page)).join() === expected.join();

async function mission(page, url) {
  return (await page.request.get(`${url}/api/v1/mission`)).json();
}

/** Places in the order that the program has, by name. */
async function places(page, url) {
  const { areas } = await mission(page, url);
  return Object.fromEntries(areas.map(({ name, order }) => [name, order]));
}

async function close(page, url, picture) {
  await page.getByRole('link', { name: 'gate 2: close…' }).click();
  await page.getByRole('heading', { name: 'Close the area gate 2' }).waitFor();
  await fits(page);
  must(/cells not searched: \d+/.test(await page.locator('main').innerText()), 'the page does not say what is open');
  await page.getByLabel('Name of the person in charge').fill('Rossi');
  await page.getByLabel('Note').fill('dogs were there');
  await picture('an-area-is-closed');
  await button(page, 'Close the area').click();
  await page.locator('#stop').waitFor();
  const { areas } = await mission(page, url);
  const { closed } = areas.find(({ name }) => name === 'gate 2');
  must(closed.name === 'Rossi' && closed.note === 'dogs were there' && closed.open.cells > 0, `closed: ${JSON.stringify(closed)}`);
}

function byKeys(browser) {
  return {
    browser,
    async play({ page, url, picture, patience }) {
      await page.goto(url);
      await drive(page);
      const shows = (expected, words) => until(() => isOrder(expected)(page), words, patience);
      await shows(['gate 2', 'hall', NAME], 'the most probable area first');
      must((await page.locator('#hall-areas text').allTextContents()).join().includes(NAME), 'the picture names the areas');
      await picture('areas');
      await fits(page);

      // The button keeps the keyboard while its row moves, so that a second press moves it on.
      await button(page, `${NAME}: earlier`).focus();
      await page.keyboard.press('Enter');
      await shows(['gate 2', NAME, 'hall'], 'one place earlier');
      must(await page.evaluate((name) => document.activeElement.getAttribute('aria-label') === `${name}: earlier`, NAME), 'the keyboard is elsewhere');
      await page.keyboard.press('Enter');
      await shows([NAME, 'gate 2', 'hall'], 'and another one');
      const order = await places(page, url);
      must(order[NAME] === 1 && order['gate 2'] === 2 && order.hall === 3, `the order: ${JSON.stringify(order)}`);
      await picture('ordered-by-keys');

      // With a mouse a row is dragged.
      if (!browser.hasTouch) {
        await resize(page, 1280, 1400);
        const from = await page.locator('#areas li b').filter({ hasText: /^hall$/ }).boundingBox();
        const to = await page.locator('#areas li').first().boundingBox();
        await page.mouse.move(from.x + 5, from.y + 5);
        await page.mouse.down();
        for (let part = 1; part <= 10; part += 1) await page.mouse.move(from.x + 5, from.y + 5 + (to.y + 3 - from.y - 5) * part / 10);
        await page.mouse.up();
        await resize(page, 1280, 800);
        await shows(['hall', NAME, 'gate 2'], 'a dragged row in its new place');
        await until(async () => (await places(page, url)).hall === 1, 'the dragged order at the program', patience);
      }

      await start(page).click();
      await phase(page, /exploring|waits for your verdict/, { patience });
      await close(page, url, picture);
      await drive(page);
      await until(async () => /closed by Rossi at/.test(await page.locator('#areas').innerText()), 'who has closed it', patience);
      must((await page.locator('#hall-areas text').allTextContents()).some((words) => words.includes('gate 2 (closed)')), 'the picture says that it is closed');
      must(await page.getByRole('link', { name: 'gate 2: close…' }).count() === 0, 'a closed area is closed again');
      await picture('an-area-was-closed');
      await fits(page);
      await button(page, 'Leave the order to the search').click();
      await until(async () => (await places(page, url)).hall === null, 'the automatic order', patience);
    },
  };
}

export const areasByKeys = byKeys({});
export const areasOnPhone = byKeys({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark' });

export const areasPlain = {
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture, patience }) {
    const waiting = { patience, reload: true };
    await page.goto(url);
    await drive(page);
    must(await isOrder(['gate 2', 'hall', NAME])(page), `the order: ${await rows(page)}`);
    // The tab stays open after each press.
    await button(page, 'hall: earlier').click();
    must(await isOrder(['hall', 'gate 2', NAME])(page), `the order: ${await rows(page)}`);
    await button(page, 'gate 2: later').click();
    must(await isOrder(['hall', NAME, 'gate 2'])(page), `the order: ${await rows(page)}`);
    await start(page).click();
    await phase(page, /exploring|waits for your verdict/, waiting);
    await drive(page);
    await close(page, url, picture);
    must(/closed by Rossi at/.test(await page.locator('#areas').innerText()), 'the list does not say who has closed it');
    await picture('closed-without-scripts');

    // What cannot be done now is said beside the list.
    await page.request.post(`${url}/api/v1/commands/stop`);
    await page.goto(url);
    await drive(page);
    await button(page, 'gate 2: search again').click();
    await until(async () => {
      const { closed } = (await mission(page, url)).areas.find(({ name }) => name === 'gate 2');
      return closed === null || (await page.locator('#why-areas').innerText()) !== '';
    }, 'it is open again, or the page says why not', patience);
  },
};

export const coverageLayer = {
  async play({ page, url, picture, patience }) {
    /** Number of cells that are drawn with a level. */
    const looked = () => page.locator('#hall-coverage > path').evaluateAll((paths) => paths.reduce((sum, path) => {
      const lengths = [...path.getAttribute('d').matchAll(/h(\d+)v/g)].map(([, length]) => Number(length) / 10);
      return lengths.reduce((cells, length) => cells + length, sum);
    }, 0));
    const layer = button(page, 'Coverage');
    const levels = page.locator('#legend .of-coverage:visible');
    const isOff = async () => must(await layer.getAttribute('aria-pressed') === 'false' && await looked() === 0
      && await levels.count() === 0, 'the layer is on');
    await page.goto(url);
    await page.locator('#legend summary').click();
    await start(page).click();
    await phase(page, /exploring/, { patience });
    await isOff();

    await layer.click();
    await until(async () => await looked() > 0, 'cells with a level', patience);
    must((await levels.allInnerTexts()).join() === 'looked at from one place,from two places,from three places,from four or more places',
      `the legend: ${await levels.allInnerTexts()}`);
    const before = await looked();
    await until(async () => await looked() > before, 'more cells with a level after a drive', patience);
    await picture('coverage');
    await fits(page);

    await page.locator('#stage').focus();
    await page.keyboard.press('c');
    await isOff();
    await page.keyboard.press('c');
    await until(async () => await looked() > before, 'the layer again', patience);
    await page.reload();
    await start(page).waitFor();
    await isOff();
  },
};
