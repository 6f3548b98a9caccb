// A person in the laboratory: watches the Roomba, stops the time, drags it, asks for another seed; on a phone and without scripts, too.

import { button, fits, must, stop, until } from './person.mjs';

/** Seconds that the player shows. */
const clock = async (page) => parseFloat(await page.locator('.player output').innerText());

/** How many dots of a picture are drawn on. */
const drawn = (page, controller) => page.locator(`figure[data-controller=${controller}] canvas`).evaluate((canvas) => {
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let alpha = 3; alpha < data.length; alpha += 4) count += data[alpha] > 0;
  return count;
});

const watching = {
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/laboratory?seed=1&seconds=60`);
    await page.locator('.player output').waitFor();
    await fits(page);
    must(await clock(page) === 0, 'it has begun by itself');
    const before = await drawn(page, 'machine');
    must(before > 0, 'no robot is drawn');

    await page.getByText('16×').click();
    await button(page, 'Start').click();
    await until(async () => await clock(page) > 20, 'that time passes', patience);
    await button(page, 'Pause').click();
    const stood = await clock(page);
    must(await drawn(page, 'machine') > before && await drawn(page, 'tree') > before, 'nothing has been driven');
    await picture('moving');

    const slider = page.getByRole('slider');
    const at = async (seconds) => {
      await slider.fill(String(seconds));
      return [await page.locator('.now').allInnerTexts(), await page.locator('.diagram').evaluateAll((all) => all.map((one) => one.dataset.at))];
    };
    const [said, shown] = await at(2);
    must(said.every((words) => words.startsWith('MoveForward')) && shown.every((phase) => phase === 'MoveForward'), `at 2 s: ${said}`);
    must(stood > 20 && (await at(10))[0].every((words) => words.startsWith('MoveInSpiral')), 'at 10 s it is not in a spiral');
    await slider.press('ArrowRight');
    must(await clock(page) > 10, 'the slider does not heed the keyboard');
    const [end] = await at(60);
    must(end[0] === end[1] && /walls met [1-9]/.test(end[0]), `at the end: ${end}`);
    await picture('end');
    await page.getByText('Machine and tree made the same').waitFor();

    await page.getByLabel('Seed').fill('7');
    await button(page, 'Run').click();
    await page.waitForURL(/seed=7/);
    await page.locator('.player output').waitFor();
    await fits(page);
    await stop(page).click();
    await page.getByText('STOP is confirmed').waitFor();
  },
};

export const laboratory = watching;
export const laboratoryOnPhone = {
  ...watching,
  browser: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark' },
};

export const laboratoryPlain = {
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture }) {
    await page.goto(`${url}/laboratory`);
    await fits(page);
    must(await page.locator('.drawn svg').count() === 2, 'the runs are not drawn');
    must(!(await page.locator('canvas').first().isVisible()), 'an empty picture is shown');
    await page.getByLabel('Seed').fill('5');
    await button(page, 'Run').click();
    await page.waitForURL(/seed=5/);
    await page.getByText('Behaviour tree, seed 5, 120 s', { exact: true }).waitFor();
    await picture('drawn');
  },
};

export const laboratoryCalm = {
  browser: { reducedMotion: 'reduce' },
  async play({ page, url, patience }) {
    await page.goto(`${url}/laboratory?seed=1&seconds=60`);
    await page.locator('.player output').waitFor();
    const pictures = new Set();
    await button(page, 'Start').click();
    const began = Date.now();
    await until(async () => pictures.add(await clock(page)) && await clock(page) >= 3, 'that time passes', patience);
    must(pictures.size <= 3 + (Date.now() - began) / 1000, `the picture moves all the time: ${[...pictures]}`);
  },
};
