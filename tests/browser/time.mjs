// The timeline and the lens: any moment is shown exactly as it was shown then, STOP is the only command there, and
// the hall can be enlarged as far as one likes.

import { appears, look, must, numberOf, phase, safe, start, stop, until } from './person.mjs';

const MOMENTS = 10;

/** Everything recorded that the page shows, with the robot where the picture draws it. */
const shown = (page) => page.evaluate(() => {
  const layer = document.getElementById('hall-layer').cloneNode(true);
  // The planned way and the sonar are not recorded.
  for (const unrecorded of layer.querySelectorAll('.route, .ray')) unrecorded.remove();
  const words = (id) => document.getElementById(id).innerText.replace(/\s+/g, ' ').trim();
  const drawn = (id) => [...document.getElementById(id).children].map((child) => child.outerHTML).sort().join('');
  const robot = document.getElementById('hall-robot');
  return {
    phase: document.querySelector('#bar .phase').innerText.replace('was waiting for its', 'waits for your'),
    temperature: document.querySelector('#temperature .head').innerText,
    holds: words('holds'),
    alarms: words('alarms').replace(/Acknowledge/g, '').trim(),
    searched: document.querySelector('#progress b')?.innerText,
    gallery: words('gallery'),
    tiles: drawn('tiles'),
    frontier: document.getElementById('hall-frontier').innerHTML,
    pieces: drawn('pieces'),
    layer: layer.innerHTML,
    robot: robot.getAttribute('transform') + robot.innerHTML,
    view: document.getElementById('hall').getAttribute('viewBox'),
  };
});

const last = async (url) => (await (await fetch(`${url}/api/v1/missions/1/moment`)).json()).seq;

function mustBeSame(now, then, where) {
  for (const [what, looks] of Object.entries(now)) must(then[what] === looks, `${where}: ${what} was\n${looks}\nand is shown as\n${then[what]}`);
}

/** Ten moments of a mission are shown later exactly as they were shown then, whether or not the robot was moving. */
export const replayed = {
  async play({ page, url, picture, patience }) {
    const moments = [];
    /** Remembers what is shown, when all of it is recorded and nothing changes any more. */
    async function remember() {
      for (const end = Date.now() + patience; ; ) {
        const before = await last(url);
        const looks = await shown(page);
        await page.waitForTimeout(300);
        if ((await last(url)) === before && JSON.stringify(await shown(page)) === JSON.stringify(looks)) {
          moments.push([before, looks]);
          return;
        }
        must(Date.now() < end, 'the page never comes to rest');
      }
    }
    async function goOn() {
      await start(page).click();
      await page.getByText(/^Held: stopped by the operator/).waitFor({ state: 'hidden' });
    }
    await page.goto(url);
    await start(page).click();
    while (moments.length < MOMENTS) {
      await until(async () => (await page.locator('#inspect.waiting').count()) > 0 || (await page.locator('#bar.working').count()) > 0, 'it goes on', patience);
      if ((await page.locator('#inspect.waiting').count()) === 0) {
        await page.waitForTimeout(150);
        await stop(page).click();
        await page.getByText(/^Held: stopped by the operator/).waitFor();
        await remember();
        if ((await page.locator('#inspect.waiting').count()) === 0) await goOn();
        continue;
      }
      await look(page);
      await remember();
      const id = await numberOf(safe(page));
      await safe(page).click();
      await page.waitForFunction((id) => document.getElementById('inspect').dataset.luggage !== String(id), id);
      if (await page.getByText(/^Held: stopped by the operator/).isVisible()) await goOn();
    }
    must(new Set(moments.map(([seq]) => seq)).size > 7, `they are ${moments.map(([seq]) => seq)}`);
    for (const [seq, looks] of moments) {
      await page.goto(`${url}/missions/1/moment?at=${seq}`);
      mustBeSame(looks, await shown(page), `entry ${seq}, opened by its address`);
    }
    // The same moments without reloading the page, forwards and backwards.
    const order = [...moments.keys()].sort((a, b) => (a * 7) % MOMENTS - (b * 7) % MOMENTS);
    for (const place of order) {
      const [seq, looks] = moments[place];
      await page.evaluate((seq) => time.go({ at: seq }), seq);
      await page.waitForURL(new RegExp(`at=${seq}$`));
      mustBeSame(looks, await shown(page), `entry ${seq}, come to from another moment`);
    }
    await picture('replayed');
    await page.locator('#to-now').click();
    await page.waitForURL(`${url}/`);
    await page.locator('html:not([data-past])').waitFor();
    must(await page.getByRole('link', { name: /Back to now/ }).isHidden(), 'now there is no way back to now');
  },
};

/**
 * The timeline by pointer and by keys: dragged, stepped, and played forwards and backwards. Meanwhile the page
 * announces what happens now, and STOP acts.
 */
export const past = {
  async play({ page, url, picture, patience }) {
    const track = page.getByRole('slider', { name: 'Moment of the mission' });
    const entry = async () => Number(/entry (\d+)/.exec(await page.locator('#moment').innerText())?.[1] ?? NaN);
    await page.goto(url);
    must(await track.isHidden(), 'before the first mission there is no line of time');
    await start(page).click();
    await appears(page, safe(page), { patience });
    await look(page);
    await page.waitForTimeout(1500);
    const box = await page.locator('#time-line').boundingBox();
    const drawn = await page.evaluate(() => ({
      hours: [...document.querySelectorAll('#hours text')].map((hour) => hour.textContent),
      now: Number(document.getElementById('cursor').getAttribute('d').match(/^M([\d.]+)/)[1]),
      wide: document.getElementById('time-line').viewBox.baseVal.width,
      ends: !document.getElementById('time-ends').hidden,
    }));
    must(drawn.hours.every((hour) => /^\d\d:\d\d:\d\d$/.test(hour)) && drawn.hours.length <= 6, `the hours of the first minute are ${drawn.hours}`);
    must(drawn.now < drawn.wide / 2, `some seconds after its beginning now is at ${drawn.now} of ${drawn.wide}`);
    must(!drawn.ends, 'it is said to end, and goes on');
    const found = await page.locator('#shots img').evaluateAll((shots) => shots.map(({ className, naturalWidth }) => `${className} ${naturalWidth > 0}`));
    must(found.join() === 'pending true', `photos on the line of time: ${found}`);
    await page.mouse.move(box.x + box.width * 0.5, box.y + 20);
    await page.mouse.down();
    await page.mouse.move(box.x + 2, box.y + 20, { steps: 5 });
    await page.mouse.up();
    await page.getByText('Past: state at').waitFor();
    await page.waitForURL(/\/missions\/1\/moment\?at=\d+$/);
    await picture('dragged');
    const alive = await page.locator('button:enabled:visible:not(.lens *, .transport *, .zoom *, .keys-open, .languages *)').allInnerTexts();
    must(alive.length === 1 && /STOP/.test(alive[0]), `in the past these can be pressed: ${alive}`);

    await track.focus();
    await page.keyboard.press('Home');
    await page.waitForFunction(() => document.getElementById('step-back').disabled);
    const first = await entry();
    await page.keyboard.press('ArrowRight');
    await until(async () => (await entry()) > first, 'a step on', patience);
    const second = await entry();
    await page.keyboard.press('ArrowRight');
    await until(async () => (await entry()) > second, 'a second step', patience);
    await page.keyboard.press('ArrowLeft');
    await until(async () => (await entry()) === second, 'a step back', patience);
    must(/entry \d+ of mission 1: /.test(await track.getAttribute('aria-valuetext')), await track.getAttribute('aria-valuetext'));
    await page.locator('#speed').selectOption('64');
    await track.focus();
    await page.keyboard.press('Space');
    await page.getByRole('button', { name: 'Pause' }).waitFor();
    await page.waitForURL(`${url}/`);
    await page.locator('html:not([data-past])').waitFor();
    await page.getByRole('button', { name: 'Play backwards' }).click();
    await page.waitForFunction(() => document.getElementById('step-back').disabled);
    await page.getByRole('button', { name: 'Play backwards' }).and(page.locator('[aria-pressed=false]')).waitFor();

    // The page of a past moment announces what happens now and stays in the past; its STOP acts now.
    const id = (await (await fetch(`${url}/api/v1/state`)).json()).luggage[0].id;
    const headers = { 'content-type': 'application/json' };
    await fetch(`${url}/api/v1/luggage/${id}/verdict`, { method: 'POST', headers, body: '{"verdict":"safe"}' });
    await page.getByRole('link', { name: /Back to now: .*exploring/ }).waitFor();
    await page.getByText('Past: state at').waitFor();
    await stop(page).click();
    await until(async () => (await (await fetch(`${url}/api/v1/state`)).json()).mission.holds.includes('operator'), 'STOP from the past', patience);
    await page.getByRole('link', { name: /Back to now/ }).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await phase(page, /exploring/i, { patience });
    must(await start(page).isEnabled(), 'back in the present START is there');
    await picture('now');
  },
};

/** Without scripts a mission is replayed entry by entry. */
export const pastPlain = {
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture, patience }) {
    await page.goto(url);
    await start(page).click();
    await appears(page, safe(page), { patience, reload: true });
    await page.getByRole('link', { name: 'Replay this mission from the beginning' }).click();
    await page.getByText('Past: state at').waitFor();
    const at = async () => Number(/entry (\d+) of mission 1/.exec(await page.locator('#moment').innerText())[1]);
    const first = await at();
    await page.getByRole('link', { name: 'One entry forward' }).click();
    must((await at()) > first, `after a step on it is entry ${await at()}`);
    await picture('step');
    await page.getByRole('link', { name: 'One entry back' }).click();
    must((await at()) === first, `after a step back it is entry ${await at()}`);
    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
  },
};

/** Zoom by wheel, keys and buttons; a click on a free cell sends the robot there when driving by hand is allowed. */
export const lens = {
  async play({ page, url, picture, patience }) {
    const state = async () => (await fetch(`${url}/api/v1/state`)).json();
    const hall = page.locator('#hall');
    const view = () => hall.getAttribute('viewBox');
    await page.goto(url);
    await start(page).click();
    await appears(page, safe(page), { patience });
    await look(page);
    const whole = await view();
    const box = await hall.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.wheel(0, -300);
    const closer = await view();
    must(Number(closer.split(' ')[3]) < Number(whole.split(' ')[3]), `the wheel leads from ${whole} to ${closer}`);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 - 80, box.y + box.height / 2 - 30, { steps: 4 });
    await page.mouse.up();
    must((await view()) !== closer, 'dragged, the hall stays where it is');
    must(await page.locator('#offer').isHidden(), 'a drag offers nothing');
    await picture('closer');
    await page.getByRole('button', { name: 'The whole hall' }).click();
    must((await view()) === whole, 'fitted, the whole hall is seen');
    await page.locator('#stage').focus();
    for (const key of ['+', '+', 'ArrowLeft', '-']) {
      const before = await view();
      await page.keyboard.press(key);
      must((await view()) !== before, `${key} does nothing`);
    }
    await page.keyboard.press('0');
    must((await view()) === whole, '0 shows the whole hall');

    // Columns and rows have numbers, which end with the hall.
    const numbers = () => page.locator('#rulers text').evaluateAll((texts) => texts.map(({ textContent }) => Number(textContent)));
    const [, , right, bottom] = (await page.locator('#hall-labels').getAttribute('data-known')).split(' ').map(Number);
    must((await numbers()).length > 4, 'columns and rows have no numbers');
    must(Math.max(...await numbers()) <= Math.max(right, bottom), `numbers up to ${Math.max(...await numbers())}, the hall ends at ${right}, ${bottom}`);

    // A robot that is followed is in the middle of the plan; a hand that moves the plan ends that.
    const follow = page.getByRole('button', { name: 'Follow the robot' });
    await follow.click();
    const offCentre = () => page.evaluate(() => {
      const [robot, stage] = ['#hall-robot .body', '#stage'].map((id) => document.querySelector(id).getBoundingClientRect());
      return Math.hypot(robot.x + robot.width / 2 - stage.x - stage.width / 2, robot.y + robot.height / 2 - stage.y - stage.height / 2);
    });
    must((await offCentre()) < 30, `the robot that is followed is ${await offCentre()} pixels off`);
    await picture('followed');
    await page.locator('#stage').focus();
    await page.keyboard.press('ArrowLeft');
    must((await follow.getAttribute('aria-pressed')) === 'false', 'moved by hand, the plan still follows the robot');
    await page.keyboard.press('0');

    const home = () => page.evaluate(() => {
      const matrix = document.getElementById('hall').getScreenCTM();
      return { x: 5 * matrix.a + matrix.e, y: 15 * matrix.d + matrix.f };
    });
    const beside = await home();
    await page.mouse.click(beside.x, beside.y);
    must(await page.locator('#offer').isHidden(), 'while a piece is inspected nobody drives by hand');
    await safe(page).click();
    await phase(page, /exploring/i, { patience });
    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await page.locator('#manual fieldset:enabled').first().waitFor({ state: 'attached' });
    const cell = await home();
    await page.mouse.click(cell.x, cell.y);
    await picture('offer');
    must((await state()).robot.position.y > 1, 'it is there already');
    await follow.click();
    await page.getByRole('button', { name: 'Go to column 0, row 1' }).click();
    await until(async () => (({ x, y }) => x === 0 && y === 1)((await state()).robot.position), 'the robot at column 0, row 1', patience);
    await until(async () => (await offCentre()) < 30, 'the robot in the middle of the plan after its way', patience);
  },
};
