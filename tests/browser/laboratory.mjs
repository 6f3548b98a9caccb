// A person in the laboratory: watches the Roomba and the pair with its parcels, stops the time, drags it, and
// requests other runs, also on a phone and without scripts.

import { button, fits, must, stop, until } from './person.mjs';

const roomba = (page) => page.locator('#roomba');
const pallet = (page) => page.locator('#pallet');

/** Seconds that the player of a panel shows. */
const clock = async (panel) => parseFloat(await panel.locator('.player output').innerText());

/** Number of pixels of a picture that are drawn on. */
const drawn = (panel, controller) => panel.locator(`figure[data-controller=${controller}] canvas`).evaluate((canvas) => {
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let alpha = 3; alpha < data.length; alpha += 4) count += data[alpha] > 0;
  return count;
});

const watching = {
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/laboratory?seed=1&seconds=60`);
    const panel = roomba(page);
    await panel.locator('.player output').waitFor();
    await fits(page);
    must(await clock(panel) === 0, 'it has begun by itself');
    const before = await drawn(panel, 'machine');
    must(before > 0, 'no robot is drawn');

    await panel.getByText('16×').click();
    await button(panel, 'Play').click();
    await until(async () => await clock(panel) > 20, 'that time passes', patience);
    await button(panel, 'Pause').click();
    const stood = await clock(panel);
    must(await drawn(panel, 'machine') > before && await drawn(panel, 'tree') > before, 'nothing has been driven');
    await picture('moving');

    const slider = panel.getByRole('slider');
    const at = async (seconds) => {
      await slider.fill(String(seconds));
      return [await panel.locator('.now').allInnerTexts(), await panel.locator('.diagram').evaluateAll((all) => all.map((one) => one.dataset.at))];
    };
    const [said, shown] = await at(2);
    must(said.every((words) => words.startsWith('MoveForward')) && shown.every((phase) => phase === 'MoveForward'), `at 2 s: ${said}`);
    must(stood > 20 && (await at(10))[0].every((words) => words.startsWith('MoveInSpiral')), 'at 10 s it is not in a spiral');
    await slider.press('ArrowRight');
    must(await clock(panel) > 10, 'the slider does not heed the keyboard');
    const [end] = await at(60);
    must(end[0] === end[1] && /walls met [1-9]/.test(end[0]), `at the end: ${end}`);
    await picture('end');
    await page.getByText('Machine and tree made the same').waitFor();

    await panel.getByLabel('Seed').fill('7');
    await button(panel, 'Run').click();
    await page.waitForURL(/seed=7/);
    await panel.locator('.player output').waitFor();
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
    must(await roomba(page).locator('.drawn svg').count() === 2, 'the runs are not drawn');
    must(!(await page.locator('canvas').first().isVisible()), 'an empty picture is shown');
    await roomba(page).getByLabel('Seed').fill('5');
    await button(roomba(page), 'Run').click();
    await page.waitForURL(/seed=5/);
    await page.getByText('Behaviour tree, seed 5, 120 s', { exact: true }).waitFor();
    await picture('drawn');
  },
};

export const laboratoryCalm = {
  browser: { reducedMotion: 'reduce' },
  async play({ page, url, patience }) {
    await page.goto(`${url}/laboratory?seed=1&seconds=60`);
    const panel = roomba(page);
    await panel.locator('.player output').waitFor();
    const pictures = new Set();
    await button(panel, 'Play').click();
    const began = Date.now();
    await until(async () => pictures.add(await clock(panel)) && await clock(panel) >= 3, 'that time passes', patience);
    must(pictures.size <= 3 + (Date.now() - began) / 1000, `the picture moves all the time: ${[...pictures]}`);
  },
};

/** Picture of the yard as a data URL. */
const yard = (panel) => panel.locator('canvas').evaluate((canvas) => canvas.toDataURL());

/** Node of a tree with this name, and its status. */
const node = (panel, name) => panel.locator('.node').filter({ has: panel.page().locator(`b:text-is("${name}")`) }).first();
const stands = async (panel, name) => (await node(panel, name).getAttribute('class')).replace('node ', '');

const carrying = {
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/laboratory?seed=5&seconds=60&palletSeed=1&parcels=2&fault=lost&at=2#pallet`);
    const panel = pallet(page);
    await panel.locator('.player output').waitFor();
    await fits(page);
    must(await clock(panel) === 0, 'it has begun by itself');
    const first = await yard(panel);
    const heights = () => panel.locator('.told').evaluate((told) => [told.offsetHeight, told.querySelector('.held').offsetTop]);
    const before = String(await heights());

    await panel.getByText('16×').click();
    await button(panel, 'Play').click();
    await until(async () => await clock(panel) > 8, 'that time passes', patience);
    await button(panel, 'Pause').click();
    const stood = await yard(panel);
    must(stood !== first, 'nothing moves');
    await page.waitForTimeout(300);
    must(await yard(panel) === stood, 'it moves although it is paused');
    await picture('moving');

    const slider = panel.getByRole('slider');
    const at = async (seconds) => {
      await slider.fill(String(seconds));
      return panel.locator('.stage').innerText();
    };
    const carried = await at(20);
    must(/Phase 5 of 8, parcel 1 of 2/.test(carried) && carried.includes('lifted and carried'), `at 20 s: ${carried}`);
    must(await stands(panel, 'TransportSequence') === 'running ticked' && await stands(panel, 'Pick-UpPrepSequence') === 'success', 'the trees do not stand as at 20 s');
    must(await stands(panel, 'DropSequence') === 'idle' && await node(panel, 'TransportSequence').locator('i').innerText() === '▶', 'the trees do not stand as at 20 s');
    must(/^[56]\d\.\d N$/.test(await panel.locator('[data-figure=force] dd').innerText()), 'the force is not told');
    must(await panel.locator('#blackboard dd').count() > 3, 'the blackboard is empty');
    await panel.locator('.carrying').evaluate((place) => place.scrollIntoView());
    await picture('carrying');

    const lost = await panel.locator('.events li.alarm').getAttribute('data-t');
    await at(Number(lost) - 1);
    must(!/ALARM/.test(await panel.locator('.calls').innerText()), 'there is an alarm before there is one');
    await button(panel, `Show ${lost} s`).last().click();
    must(await clock(panel) === Number(lost) && /ALARM: the pair has lost the parcel/.test(await panel.locator('.calls').innerText()), 'the alarm is not shown at its time');
    must(await panel.locator('.events li[aria-current]').getAttribute('class') === 'alarm', 'the list does not follow the time');
    must(await stands(panel, 'TransportSequence') === 'failure ticked', 'the trees do not stand as when it was lost');
    must(String(await heights()) === before, `what is told jumps: ${before} was ${await heights()}`);
    await picture('alarm');

    await slider.press('End');
    must(/2 of 2 in the target area/.test(await panel.locator('.stage').innerText()), 'the parcels are not in the target area at the end');
    must(/All parcels are in the target area/.test(await panel.locator('.calls').innerText()), 'the end is not told');
    await picture('end');

    await panel.getByLabel('lost on the way').uncheck();
    await panel.getByLabel('target closed').check();
    await panel.getByLabel('at parcel').fill('1');
    await button(panel, 'Run').click();
    await page.waitForURL(/fault=blocked/);
    must(/seed=5&seconds=60/.test(page.url()), `the Roomba is forgotten: ${page.url()}`);
    await panel.locator('.player output').waitFor();
    await slider.press('End');
    must(/The run ends: the pair finds no way/.test(await panel.locator('.calls').innerText()), 'the fault is not told');
    await roomba(page).getByLabel('Seed').fill('6');
    await button(roomba(page), 'Run').click();
    await page.waitForURL(/seed=6/);
    must(/fault=blocked/.test(page.url()), `the pallet is forgotten: ${page.url()}`);
    await fits(page);
  },
};

export const pallets = carrying;
export const palletsOnPhone = { ...carrying, browser: laboratoryOnPhone.browser };

export const palletsPlain = {
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture }) {
    await page.goto(`${url}/laboratory`);
    await fits(page);
    const panel = pallet(page);
    await panel.getByLabel('lost on the way').check();
    await panel.getByLabel('no operator').check();
    await button(panel, 'Run').click();
    await page.waitForURL(/fault=lost&fault=absent/);
    must(await panel.locator('.drawn svg').isVisible() && !(await panel.locator('canvas').isVisible()), 'the yard is not drawn');
    must(await panel.locator('.events li').count() > 5 && await panel.locator('.events .alarm').isVisible(), 'the phases are not listed');
    must(await panel.locator('.tree .node').count() === 50 && await stands(panel, 'Supervisor') === 'failure ticked', 'the trees are not shown');
    await panel.getByText('The run ends here: the operator was called and has not come').waitFor();
    await panel.getByText('0 of 3 in the target area').waitFor();
    await panel.scrollIntoViewIfNeeded();
    await panel.evaluate((place) => place.scrollIntoView());
    await picture('drawn');
  },
};
