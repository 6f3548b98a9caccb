// How a person finds elements, waits for them, and looks at them. The scenarios contain the actions.

export const button = (page, name) => page.getByRole('button', { name });
export const stop = (page) => button(page, /^STOP/);
export const start = (page) => button(page, /\bSTART\b/).first();
export const home = (page) => button(page, /BACK HOME/);
export const safe = (page) => button(page, /SAFE #\d+/).first();
export const danger = (page) => button(page, /DANGER #\d+/).first();

/**
 * Waits as long as a person who looks before pressing. The page ignores a press that comes sooner after a new piece.
 */
export const look = (page) => page.waitForTimeout(700);

/** Gives the window a size. Scripts place things anew just before the next frame, so it waits until that is drawn. */
export async function resize(page, width, height) {
  await page.setViewportSize({ width, height });
  await page.evaluate(() => matchMedia('(scripting: none)').matches
    || new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
}

/** Opens the menu of the rail. */
export const menu = (page) => page.locator('#menu summary').click();

/** Chooses what is shown under the luggage. */
export const tab = (page, name) => page.locator('.tabs label').filter({ hasText: name }).click();

/** Fails with these words unless the condition is true. */
export function must(isSo, words) {
  if (!isSo) throw new Error(words);
}

/** Waits until the phase matches the pattern. Pages without scripts are reloaded repeatedly, as a person would do. */
export async function phase(page, pattern, { patience, reload = false }) {
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

/** Waits for an element in the same way as `phase`. */
export async function appears(page, locator, { patience, reload = false }) {
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

/** Waits until the condition is true. */
export async function until(isSo, words, patience) {
  for (const end = Date.now() + patience; !(await isSo()); await new Promise(setImmediate)) {
    must(Date.now() < end, `never seen: ${words}`);
  }
}

/** Number of the piece in a button's name. */
export async function numberOf(locator) {
  return Number(/#(\d+)/.exec(await locator.innerText())[1]);
}

/** Checks that the photo of this piece is loaded in full size. */
export async function photoIsShown(page, id) {
  const photo = page.locator(`img[src*="/luggage/${id}/photo"]`).first();
  await photo.waitFor();
  await photo.evaluate((image) => image.decode());
  const width = await photo.evaluate((image) => image.naturalWidth);
  must(width >= 640, `the photo is ${width} pixels wide`);
}

/** Checks that STOP is fully visible and large at any scroll position, and that nothing covers it. */
export async function hits(page, where) {
  const wrong = await page.evaluate(() => {
    const button = document.querySelector('#stop button');
    if (!button) return 'there is no STOP';
    const root = document.scrollingElement;
    const farthest = root.scrollHeight - root.clientHeight;
    for (const down of [0, farthest / 2, farthest]) {
      root.scrollTo(0, down);
      const { left, top, right, bottom, width, height } = button.getBoundingClientRect();
      const box = `${Math.round(left)},${Math.round(top)} to ${Math.round(right)},${Math.round(bottom)} scrolled to ${Math.round(down)} of ${farthest}`;
      if (left < 0 || top < 0 || right > innerWidth + 0.5 || bottom > innerHeight + 0.5) return `STOP is off the screen: ${box}`;
      if (width < 44 || height < 44) return `STOP is small: ${box}`;
      for (const [x, y] of [[0.5, 0.5], [0.08, 0.2], [0.92, 0.2], [0.08, 0.8], [0.92, 0.8]]) {
        const hit = document.elementFromPoint(left + width * x, top + height * y);
        if (hit?.closest('button') !== button) return `${hit?.outerHTML.slice(0, 80)} lies over STOP: ${box}`;
      }
    }
    root.scrollTo(0, 0);
    return root.scrollWidth > innerWidth ? `the page is ${root.scrollWidth} pixels wide` : '';
  });
  const { width, height } = page.viewportSize();
  must(wrong === '', `${where} at ${width}×${height}: ${wrong}`);
}

/** Checks that the page fits the screen and contains STOP, large enough to be hit. */
export async function fits(page) {
  const { wide, high, need } = await page.evaluate(() => (
    { wide: innerWidth, high: innerHeight, need: document.documentElement.scrollWidth }));
  must(need <= wide, `the page is ${need} pixels wide, the screen ${wide}`);
  const box = await stop(page).boundingBox();
  must(box && box.x >= 0 && box.y >= 0 && box.x + box.width <= wide + 1 && box.y + box.height <= high + 1,
    `STOP is not on the screen: ${JSON.stringify(box)}`);
  must(box.height >= 44 && box.width >= 44, `STOP is too small: ${JSON.stringify(box)}`);
}
