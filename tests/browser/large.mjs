// Large halls: hundreds of pieces do not overlap, a hall of a thousand cells a side is updated in tiles, and two
// fingers zoom in.

import { fits, must, phase, resize, start, stop, until } from './person.mjs';

const SCREENS = [[320, 800], [390, 844], [844, 390], [768, 1024], [1280, 800], [2560, 1440]];

/** Gives the verdict safe to every piece until the hall is explored. */
async function answer(url, patience) {
  const read = async (what) => (await fetch(`${url}/api/v1/${what}`)).json();
  for (let id = 1, end = Date.now() + 4 * patience; (await read('mission')).phase !== 'explored'; ) {
    must(Date.now() < end, `after ${id - 1} pieces the hall is not explored`);
    const response = await fetch(`${url}/api/v1/luggage/${id}/verdict`, {
      method: 'POST', headers: { 'content-type': 'application/json' }, body: '{"verdict":"safe"}',
    });
    if (response.ok) id += 1;
  }
  return (await read('state')).luggage.length;
}

/** Screen boxes of the luggage marks in the hall, each with its number of pieces. */
const marks = (page) => page.evaluate(() => [...document.querySelectorAll('#hall .piece')]
  .map((piece) => {
    const { left, top, right, bottom } = piece.querySelector('path, circle, rect, polygon').getBoundingClientRect();
    return { left, top, right, bottom, pieces: piece.dataset.piece ? 1 : Number(piece.querySelector('text').textContent) };
  })
  .filter(({ left, right }) => right > left)); // a mark that is not drawn has no width

/** Fails if two marks overlap. */
function mustBeApart(all, where) {
  must(all.length > 0, `${where}: no luggage is drawn`);
  const sorted = all.toSorted((a, b) => a.left - b.left);
  sorted.forEach((one, at) => {
    for (const other of sorted.slice(at + 1)) {
      if (other.left >= one.right - .1) break;
      const covers = other.top < one.bottom - .1 && one.top < other.bottom - .1;
      must(!covers, `${where}: ${JSON.stringify(one)} covers ${JSON.stringify(other)}`);
    }
  });
}

export const warehouse = {
  async play({ page, url, picture, patience }) {
    await page.goto(url);
    await start(page).click();
    const found = await answer(url, patience);
    must(found === 770, `${found} pieces were found`);
    await phase(page, /explored/i, { patience });
    const report = await (await fetch(`${url}/missions/1/report?language=en`)).text();
    must(report.length < 10e6 && report.includes('Photos are scaled down here'), `its report has ${report.length} bytes`);
    for (const [width, height] of SCREENS) {
      const where = `at ${width}×${height}`;
      await resize(page, width, height);
      await until(async () => (await marks(page)).length > 0, 'the luggage', patience);
      await fits(page);
      const pinned = await marks(page);
      mustBeApart(pinned, where);
      const told = pinned.reduce((sum, { pieces }) => sum + pieces, 0);
      must(told === found, `${where}: the pins stand for ${told} pieces`);
      await picture(`${width}-whole`);
      await page.locator('#stage').focus();
      for (let closer = 1; closer <= 12; closer += 1) {
        await page.keyboard.press('+');
        if (closer % 3 === 0) mustBeApart(await marks(page), `${where}, ${closer} times closer`);
      }
      await picture(`${width}-close`);
      await page.keyboard.press('0');
    }
    await resize(page, 1280, 800);
    must(await page.locator('#hours text').count() > 0, 'no hour stands under the line of time');
    await page.locator('#stage').focus();
    while (!(await page.locator('#hall.near').count())) await page.keyboard.press('+');
    const box = await page.locator('#hall').boundingBox();
    const inside = ({ left, top, right, bottom }) => left > box.x && right < box.x + box.width && top > box.y && bottom < box.y + box.height;
    const one = (await marks(page)).find(inside);
    const opened = page.waitForEvent('popup');
    await page.mouse.click((one.left + one.right) / 2, (one.top + one.bottom) / 2);
    must(/\/luggage\/\d+$/.test((await opened).url()), 'a piece opens another page than its own');
  },
};

/** The size of a message depends on the change and not on the size of the hall; STOP stays where it was. */
export const thousand = {
  async play({ page, url, picture, patience }) {
    await page.addInitScript(() => {
      globalThis.heard = [];
      const Whole = EventSource;
      globalThis.EventSource = class extends Whole {
        addEventListener(what, act, ...rest) {
          super.addEventListener(what, (event) => {
            if (event.data) globalThis.heard.push(event.data.length);
            act.call(this, event);
          }, ...rest);
        }
      };
    });
    await page.goto(url);
    await start(page).click();
    const searched = async () => (await (await fetch(`${url}/api/v1/mission`)).json()).progress.visited;
    await until(async () => (await searched()) > 10_000, 'a part of the hall', patience);
    await stop(page).click();
    await page.getByText(/^Held: stopped by the operator/).waitFor();
    await picture('held');
    await start(page).click();
    await phase(page, /explored/i, { patience });
    await fits(page);
    const view = (await page.locator('#hall').getAttribute('viewBox')).split(' ').map(Number);
    must(view[2] >= 10_000 && view[3] >= 10_000, `the picture is ${view}`);
    await picture('explored');
    const heard = await page.evaluate(() => globalThis.heard);
    must(heard.length > 10, `${heard.length} changes were heard`);
    await page.reload();
    await until(async () => (await page.evaluate(() => globalThis.heard.length)) > 0, 'the whole', patience);
    const whole = await page.content().then((page) => page.length);
    // The first message contains the whole state. At this speed a change covers hundreds of cells, and each changed
    // tile is sent whole.
    const most = heard.slice(1).toSorted((a, b) => a - b)[Math.floor((heard.length - 1) * .95)];
    must(most < whole / 4, `of ${heard.length} changes one in twenty has more than ${most} characters, and the whole page has ${whole}`);
    console.log(`of ${heard.length} changes 19 in 20 have at most ${most} characters; the page has ${whole}`);
    await page.locator('#stage').focus();
    while (!(await page.locator('#hall.near').count())) await page.keyboard.press('+');
    await picture('near');
    await page.keyboard.press('0');
  },
};

/** Two fingers zoom about the point between them, and one finger moves the map; neither sends the robot anywhere. */
export const pinched = {
  browser: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
  async play({ page, url, picture }) {
    await page.goto(url);
    const hall = page.locator('#hall');
    const box = await hall.boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const touch = await page.context().newCDPSession(page);
    const fingers = (type, ...places) => touch.send('Input.dispatchTouchEvent',
      { type, touchPoints: places.map(([dx, dy], id) => ({ x: x + dx, y: y + dy, id })) });
    const view = async () => (await hall.getAttribute('viewBox')).split(' ').map(Number);
    /** Map coordinates of the point between the fingers. */
    const between = () => page.evaluate(([x, y]) => {
      const { x: column, y: row } = new DOMPoint(x, y).matrixTransform(document.getElementById('hall').getScreenCTM().inverse());
      return [column, row];
    }, [x, y]);
    const whole = await view();
    const middle = await between();
    await fingers('touchStart', [-20, 0], [20, 0]);
    for (const apart of [30, 40, 50, 60]) await fingers('touchMove', [-apart, 0], [apart, 0]);
    await fingers('touchEnd');
    const closer = await view();
    must(Math.abs(whole[2] / closer[2] - 3) < .7 || Math.abs(whole[3] / closer[3] - 3) < .7, `three times as far apart leads from ${whole} to ${closer}`);
    const now = await between();
    must(Math.hypot(now[0] - middle[0], now[1] - middle[1]) < 10, `${middle} went to ${now}`);
    await picture('closer');
    await fingers('touchStart', [0, 0]);
    for (const moved of [15, 30, 45]) await fingers('touchMove', [moved, moved / 2]);
    await fingers('touchEnd');
    const moved = await view();
    must(moved[0] < closer[0] && moved[1] < closer[1] && moved[2] === closer[2], `one finger leads from ${closer} to ${moved}`);
    must(await page.locator('#offer').isHidden(), 'a drag offers nothing');
    await fingers('touchStart', [-60, 0], [60, 0]);
    for (const apart of [50, 40, 30, 20, 10, 5]) await fingers('touchMove', [-apart, 0], [apart, 0]);
    await fingers('touchEnd');
    must((await view()).join() === whole.join(), 'the whole hall is seen again');
    must((await page.evaluate(() => visualViewport.scale)) === 1, 'the page was made larger, and not the hall');
  },
};
