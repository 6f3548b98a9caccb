// How a person finds things, waits for them, and looks at them. What is done with them stands in the scenarios.

export const button = (page, name) => page.getByRole('button', { name });
export const stop = (page) => button(page, /^STOP/);
export const start = (page) => button(page, /\bSTART\b/).first();
export const home = (page) => button(page, /BACK HOME/);
export const safe = (page) => button(page, /SAFE #\d+/).first();
export const danger = (page) => button(page, /DANGER #\d+/).first();

/** A person looks before pressing; the page counts on it, and ignores what comes sooner after another piece has come up. */
export const look = (page) => page.waitForTimeout(700);

/** Fails with these words unless it is so. */
export function must(isSo, words) {
  if (!isSo) throw new Error(words);
}

/** Waits until the phase reads like this; pages without scripts are loaded again and again, as a person would. */
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

/** Waits for a button in the same way. */
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

/** Waits until it is so. */
export async function until(isSo, words, patience) {
  for (const end = Date.now() + patience; !(await isSo()); ) must(Date.now() < end, `never seen: ${words}`);
}

/** The number in a button's name. */
export async function numberOf(locator) {
  return Number(/#(\d+)/.exec(await locator.innerText())[1]);
}

/** The photo of the piece that waits is shown, large and whole. */
export async function photoIsShown(page, id) {
  const photo = page.locator(`img[src*="/luggage/${id}/photo"]`).first();
  await photo.waitFor();
  await photo.evaluate((image) => image.decode());
  const width = await photo.evaluate((image) => image.naturalWidth);
  must(width >= 640, `the photo is ${width} pixels wide`);
}

/** Wherever the page is scrolled to, STOP is on the screen, whole and large, and nothing lies over any part of it. */
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

/** The page fits the screen, and STOP is on it, large enough to be hit. */
export async function fits(page) {
  const { wide, high, need } = await page.evaluate(() => (
    { wide: innerWidth, high: innerHeight, need: document.documentElement.scrollWidth }));
  must(need <= wide, `the page is ${need} pixels wide, the screen ${wide}`);
  const box = await stop(page).boundingBox();
  must(box && box.x >= 0 && box.y >= 0 && box.x + box.width <= wide + 1 && box.y + box.height <= high + 1,
    `STOP is not on the screen: ${JSON.stringify(box)}`);
  must(box.height >= 44 && box.width >= 44, `STOP is too small: ${JSON.stringify(box)}`);
}
