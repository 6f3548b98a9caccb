// What people do at the console, and what they must see. Written against roles and visible names, as a person finds things.

const button = (page, name) => page.getByRole('button', { name });
const stop = (page) => button(page, /^STOP/);
// START is called CONTINUE while there is something to go on with.
const start = (page) => button(page, /\b(START|CONTINUE)\b/).first();
const home = (page) => button(page, /BACK HOME/);
const safe = (page) => button(page, /SAFE #\d+/).first();
const danger = (page) => button(page, /DANGER #\d+/).first();

/** A person looks before pressing; the page counts on it, and ignores what comes sooner after another piece has come up. */
const look = (page) => page.waitForTimeout(700);

/** Fails with these words unless it is so. */
function must(isSo, words) {
  if (!isSo) throw new Error(words);
}

/** Waits until the phase reads like this; pages without scripts are loaded again and again, as a person would. */
async function phase(page, pattern, { patience, reload = false }) {
  const shown = page.locator('#phase, .phase').filter({ hasText: pattern });
  for (const end = Date.now() + patience; ; ) {
    try {
      await shown.first().waitFor({ timeout: reload ? 250 : patience });
      return;
    } catch (error) {
      if (!reload || Date.now() > end) throw error;
      await page.reload();
    }
  }
}

/** Waits for a button in the same way. */
async function appears(page, locator, { patience, reload = false }) {
  for (const end = Date.now() + patience; ; ) {
    try {
      await locator.waitFor({ timeout: reload ? 250 : patience });
      return;
    } catch (error) {
      if (!reload || Date.now() > end) throw error;
      await page.reload();
    }
  }
}

/** The number in a button's name. */
async function numberOf(locator) {
  return Number(/#(\d+)/.exec(await locator.innerText())[1]);
}

/** The photo of the piece that waits is shown, large and whole. */
async function photoIsShown(page, id) {
  const photo = page.locator(`img[src*="/luggage/${id}/photo"]`).first();
  await photo.waitFor();
  await photo.evaluate((image) => image.decode());
  const width = await photo.evaluate((image) => image.naturalWidth);
  must(width >= 640, `the photo is ${width} pixels wide`);
}

/** The page fits the screen, and STOP is on it, large enough to be hit. */
async function fits(page) {
  const { wide, high, need } = await page.evaluate(() => (
    { wide: innerWidth, high: innerHeight, need: document.documentElement.scrollWidth }));
  must(need <= wide, `the page is ${need} pixels wide, the screen ${wide}`);
  const box = await stop(page).boundingBox();
  must(box && box.x >= 0 && box.y >= 0 && box.x + box.width <= wide + 1 && box.y + box.height <= high + 1,
    `STOP is not on the screen: ${JSON.stringify(box)}`);
  must(box.height >= 44 && box.width >= 44, `STOP is too small: ${JSON.stringify(box)}`);
}

/** A whole mission: one piece safe, the next dangerous, the robot home with the bomb located. */
async function mission({ page, url, picture, patience }, { reload = false, touch = false } = {}) {
  const waiting = { patience, reload };
  await page.goto(url);
  await phase(page, /idle/i, waiting);
  await fits(page);
  await picture('idle');
  await start(page).click();

  await appears(page, safe(page), waiting);
  const first = await numberOf(safe(page));
  await photoIsShown(page, first);
  await fits(page);
  await picture('asked');
  if (touch) {
    for (const one of [safe(page), danger(page), start(page), home(page)]) {
      const box = await one.boundingBox();
      must(box.height >= 44, `${await one.innerText()} is ${box.height} pixels high`);
    }
  }
  await look(page);
  await safe(page).click();

  const next = button(page, new RegExp(`DANGER #(?!${first}\\b)\\d+`)).first();
  await appears(page, next, waiting);
  const second = await numberOf(next);
  must(second > first, `luggage #${second} came after #${first}`);
  await look(page);
  await next.click();
  await picture('sure');
  await confirmDanger(page, url, second);

  await phase(page, /bomb located/i, waiting);
  await picture('home');
  const state = await (await fetch(`${url}/api/v1/state`)).json();
  must(state.robot.position.x === 0 && state.robot.position.y === 0, 'the robot is not home');
  must(state.robot.led === 'off', 'the LED still blinks');
  must(state.luggage.find(({ id }) => id === second).verdict === 'danger', 'the verdict is not on record');
}

/** DANGER asks once more: the first press has decided nothing, the second does. */
async function confirmDanger(page, url, id) {
  const record = await (await fetch(`${url}/api/v1/luggage/${id}`)).json();
  must(record.verdict === 'pending', `one press was enough to decide: ${record.verdict}`);
  const dialog = page.getByRole('dialog').or(page.getByRole('alertdialog'));
  const inside = (await dialog.count()) > 0 ? dialog.first() : page.locator('main, body').last();
  await inside.getByRole('button', { name: /DANGER/ }).last().click();
}

export const missionOnScreen = { play: (person) => mission(person) };
export { missionOnScreen as mission };

export const phone = {
  browser: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark' },
  play: (person) => mission(person, { touch: true }),
};

export const plain = {
  browser: { javaScriptEnabled: false },
  play: (person) => mission(person, { reload: true }),
};

const stopping = {
  async play({ page, url, picture, patience }) {
    const state = async () => (await fetch(`${url}/api/v1/state`)).json();
    await page.goto(url);
    await start(page).click();
    await phase(page, /exploring/i, { patience });
    await stop(page).click();
    const banner = page.getByText(/^Held: stopped by the operator/);
    await banner.waitFor();
    const held = await state();
    must(held.robot.state === 'stopped', `after STOP the robot is ${held.robot.state}`);
    must(held.mission.holds.includes('operator'), `after STOP the holds are ${held.mission.holds}`);
    must((await page.getByRole('dialog').count()) === 0, 'STOP asks no questions');
    await picture('stopped');
    await start(page).click();
    await banner.waitFor({ state: 'hidden' });
    must((await state()).mission.holds.length === 0, 'START did not release the robot');

    // What another client does is seen without a reload, and START then says why it would be refused.
    const headers = { 'content-type': 'application/json' };
    await fetch(`${url}/api/v1/temperature`, { method: 'PUT', headers, body: '{"status":"tooHigh"}' });
    await page.waitForFunction(() => [...document.querySelectorAll('button')]
      .some((one) => /START|CONTINUE/.test(one.innerText) && one.disabled && /temperature/i.test(one.title)));
    await picture('too-hot');
    must(await stop(page).isEnabled(), 'STOP is always there');
  },
};

export { stopping as stop };

export const lost = {
  tolerated: ['ERR_CONNECTION_REFUSED', 'ERR_INCOMPLETE_CHUNKED_ENCODING', 'ERR_CONNECTION_RESET', 'ERR_EMPTY_RESPONSE'],
  async play({ page, url, please, picture, patience }) {
    await page.goto(url);
    await phase(page, /idle/i, { patience });
    const banner = page.getByText(/connection (is )?lost|lost (the )?connection/i).first();
    must(!(await banner.isVisible()), 'the connection is said to be lost while it stands');
    await please('kill');
    await banner.waitFor({ state: 'visible', timeout: 15_000 });
    await picture('lost');
    must(await stop(page).isEnabled(), 'STOP stays when the connection is lost');
    must(await start(page).isDisabled(), 'START would act blindly');
    await please('start');
    await banner.waitFor({ state: 'hidden', timeout: 30_000 });
    await fetch(`${url}/api/v1/commands/start`, { method: 'POST' });
    await phase(page, /exploring/i, { patience });
    await picture('back');
  },
};
