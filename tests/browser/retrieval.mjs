// A person has the dangerous bag fetched: presses RETRIEVE, stops the pair while it holds the bag, acknowledges that
// the bag is lost, sees it secured, and looks at the whole run again, also on a phone and without scripts.

import { appears, button, danger, fits, hits, look, must, phase, start, stop, tab, until } from './person.mjs';

const state = async (url) => (await fetch(`${url}/api/v1/state`)).json();
const retrieve = (page) => button(page, /RETRIEVE/);

/** Searches until the first piece is found, gives the verdict danger, and waits until the robot is home. */
async function locate(page, url, waiting) {
  await page.goto(url);
  must((await retrieve(page).count()) === 0 || await retrieve(page).isDisabled(), 'RETRIEVE is offered before there is anything to fetch');
  await start(page).click();
  await appears(page, danger(page), waiting);
  await look(page);
  await danger(page).click();
  await button(page, /Yes: DANGER|DANGER #\d+/).last().click();
  await phase(page, /bomb located/i, waiting);
  await appears(page, retrieve(page), waiting);
  await look(page);
}

/**
 * Checks that the incident names what is halted, and that the button that resumes is fully visible without scrolling;
 * then presses it.
 */
async function goesOnWith(page, name, words) {
  const incident = page.getByRole('region', { name: /Danger: a bomb in the hall/ });
  const act = incident.getByRole('button', { name });
  await act.waitFor();
  await page.evaluate(() => scrollTo(0, 0));
  const said = await incident.innerText();
  must(said.includes(words) && !/is being fetched/.test(said), `halted, the incident says: ${said}`);
  const isSeen = await act.evaluate((button) => {
    const { left, top, width, height } = button.getBoundingClientRect();
    const hits = [0.1, 0.9].map((part) => document.elementFromPoint(left + width / 2, top + height * part));
    return hits.every((hit) => button.contains(hit));
  });
  must(isSeen, `${name} is not in sight`);
  await look(page);
  await act.click();
}

/** Acknowledges the alarm of the pair and presses START. */
async function answer(page, url, waiting) {
  await appears(page, page.getByText(/lost the parcel/).first(), waiting);
  must((await state(url)).mission.holds.includes('alarm'), 'a lost parcel does not hold the pair');
  // The alarm of the dangerous piece is open too; the newest alarm is the pair's.
  const open = button(page, /acknowledge/i);
  while ((await open.count()) > 0) {
    const left = await open.count();
    await look(page);
    await open.first().click();
    await until(async () => {
      if (waiting.reload) await page.goto(url);
      return (await open.count()) < left;
    }, 'one alarm fewer', waiting.patience);
  }
  await until(async () => !(await state(url)).mission.holds.includes('alarm'), 'the hold gone with the alarm', waiting.patience);
  must((await state(url)).mission.holds.includes('awaitingStart'), 'an acknowledgement alone set the pair moving');
  await look(page);
  if (waiting.reload) await page.goto(url);
  await start(page).click();
}

/** Checks that the bag is in the container according to the page, the record and the robots. */
async function secured(page, url, waiting) {
  await phase(page, /bag secured/i, waiting);
  const { luggage, robots, mission } = await state(url);
  must(mission.phase === 'bagSecured' && luggage.filter((piece) => piece.secured).length === 1, 'no piece is on record as secured');
  const beside = await page.evaluate(() => ['.left', '.engine'].map((name) => {
    const part = document.querySelector(`#bar ${name}`);
    const size = (of) => getComputedStyle(of).fontSize;
    return part && { words: part.innerText.replace(/\s+/g, ' '), isCut: part.offsetWidth === 0 || part.scrollWidth > part.clientWidth + 1, isAsLarge: size(part) === size(part.parentElement) };
  }));
  const [left, engine] = beside;
  must(engine?.words === 'simulated' && !engine.isCut, `the bar does not say that it is simulated: ${JSON.stringify(beside)}`);
  const open = mission.progress.unknown;
  must(open === 0 || (left?.words.startsWith(`· ${open} known place`) && !left.isCut && left.isAsLarge), `what is not searched is not beside it: ${JSON.stringify(beside)}`);
  must(robots.every((robot) => robot.outside === (robot.name !== 'discovery')), 'somebody is not where a mission begins');
}

const fetched = {
  async play({ page, url, picture, patience }) {
    const waiting = { patience };
    await locate(page, url, waiting);
    await picture('located');
    await retrieve(page).click();

    // Three trees run, their nodes show their status, and the robots of the pair are on the map.
    await tab(page, 'Trees');
    await page.locator('#trees .node.running.ticked').first().waitFor();
    must((await page.locator('#trees .tree').count()) === 3, 'not all three trees are shown');
    await phase(page, /retrieving the bag[^]*(clears the way|fetches the bag|carries it out)/i, waiting);
    await until(async () => (await page.locator('#hall-carriers .carrier').count()) === 2, 'both robots on the map', patience);
    await fits(page);
    await until(async () => (await state(url)).robots.some((robot) => robot.arm?.lifted), 'the bag lifted', patience);
    await page.locator('#blackboard dt').filter({ hasText: 'parcel' }).first().waitFor();
    await picture('carried');

    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    const still = async () => (await state(url)).robots.map(({ position, outside, heading }) => JSON.stringify([position, outside, heading])).join();
    await until(async () => (await state(url)).robots.every((robot) => robot.state === 'stopped' && !robot.halting), 'all stand', patience);
    const before = await still();
    const ticks = (await state(url)).retrieval.ticks;
    await picture('stopped');
    must((await still()) === before && (await state(url)).retrieval.ticks === ticks, 'something went on after STOP');
    const headers = { 'content-type': 'application/json' };
    await fetch(`${url}/api/v1/temperature`, { method: 'PUT', headers, body: '{"status":"tooHigh"}' });
    await goesOnWith(page, 'TEMPERATURE OK', 'The retrieval is halted');
    await until(async () => !(await state(url)).mission.holds.includes('tooHigh'), 'OK taking TOO HIGH back', patience);
    must((await state(url)).mission.holds.includes('operator'), 'OK alone set the pair moving');
    await goesOnWith(page, /START/, 'Press START to go on');
    await until(async () => (await state(url)).mission.holds.every((hold) => hold === 'alarm' || hold === 'awaitingStart'), 'START going on', patience);

    await answer(page, url, waiting);
    await secured(page, url, waiting);
    await fits(page);
    await picture('secured');

    await page.getByRole('link', { name: /Replay the retrieval/ }).click();
    await page.locator('.player output').waitFor();
    await fits(page);
    await hits(page, 'the retrieval');
    const slider = page.getByRole('slider');
    const at = async (share) => {
      await slider.fill(String(Number(await slider.getAttribute('max')) * share));
      return page.locator('#trees .node').evaluateAll((nodes) => nodes.map((node) => node.className));
    };
    const [first, middle, last] = [await at(0), await at(0.3), await at(1)];
    must(first.every((name) => name.includes('idle')), `before the first tick: ${first}`);
    must(middle.filter((name) => name.includes('running')).length > 2, `on the way: ${middle}`);
    must(String(first) !== String(middle) && String(middle) !== String(last), 'the trees do not follow the time');
    must((await page.locator('#happened li[aria-current]').innerText()).includes('ended'), 'the list does not follow the time');
    must(String(await at(0)) === String(first), 'going back does not lead back');
    await button(page, 'Play').click();
    await until(async () => parseFloat(await page.locator('.player output').innerText()) > 0.2, 'that time passes', patience);
    await picture('again');
  },
};

export { fetched as retrieval };

export const retrievalOnPhone = {
  ...fetched,
  browser: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark' },
};

export const retrievalPlain = {
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture, patience }) {
    const waiting = { patience, reload: true };
    await locate(page, url, waiting);
    await retrieve(page).click();
    await answer(page, url, waiting);
    await secured(page, url, waiting);
    await page.goto(`${url}/missions/1`);
    await page.getByRole('link', { name: 'Behaviour trees of the retrieval' }).click();
    await fits(page);
    const stands = () => page.locator('#trees').innerText();
    const last = await stands();
    await page.getByRole('link', { name: 'First' }).click();
    must((await stands()) !== last, 'the first moment is shown as the last');
    await page.getByRole('link', { name: 'Next' }).click();
    await page.getByText('moment 2 of').waitFor();
    await picture('moment');
  },
};
