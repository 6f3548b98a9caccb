// A person with the simulator: stops its time, causes failures, draws a hall by pointer or by keys and has it
// searched, also on a phone and without scripts.

import { appears, button, fits, must, phase, safe, look, start, stop, until } from './person.mjs';

const cursor = (page) => page.locator('#cursor');
const text = (page) => page.locator('#toml').inputValue();
const drawing = async (page) => (await text(page)).match(/"""\n([\s\S]*?)\n"""/)[1].split('\n');
const choose = (page, name) => page.getByRole('radio', { name }).check({ force: true });

/** Screen position of the centre of a cell of the plan. */
async function middle(page, column, row, columns) {
  const plan = page.locator('#plan');
  await plan.scrollIntoViewIfNeeded();
  const { x, y, width } = await plan.boundingBox();
  const side = width / columns;
  return [x + (column + .5) * side, y + (row + .5) * side];
}

async function drag(page, from, to, columns) {
  await page.mouse.move(...await middle(page, ...from, columns));
  await page.mouse.down();
  await page.mouse.move(...await middle(page, ...to, columns), { steps: 5 });
  await page.mouse.up();
}

/** Searches the hall and gives the verdict safe to its only piece. */
async function searched(page, patience, reload = false) {
  await button(page, 'START the search').click();
  await page.waitForURL(/\/$/);
  await safe(page).waitFor({ timeout: patience });
  await look(page);
  await safe(page).click();
  await phase(page, /explored/i, { patience, reload });
}

export const hallByPointer = {
  tolerated: ['422'],
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/simulator/editor?hall=empty-8x8`);
    await page.locator('#plan').waitFor();
    await fits(page);
    await choose(page, /^Wall/);
    await choose(page, /^Line/);
    await drag(page, [0, 4], [6, 4], 8);
    must((await drawing(page))[4] === '#######.', `the line is ${(await drawing(page))[4]}`);
    await choose(page, /^Dangerous/);
    await choose(page, /^Brush/);
    await drag(page, [3, 6], [4, 6], 8);
    must((await drawing(page))[6] === '...aa...', `the piece is ${(await drawing(page))[6]}`);
    await choose(page, /^Luggage/);
    await drag(page, [3, 6], [3, 6], 8);
    must(!/dangerous = true/.test(await text(page)), 'the danger is not taken back');
    await button(page, 'Undo').click();
    must(/dangerous = true/.test(await text(page)), 'the danger is not back');
    await page.getByText('The hall is valid').waitFor();

    await choose(page, /^Wall/);
    await drag(page, [7, 4], [7, 4], 8);
    await page.locator('#findings').getByText(/red backpack.*cannot be reached/).waitFor();
    await picture('walled');
    await button(page, 'Undo').click();
    await page.getByText('The hall is valid').waitFor();
    await button(page, 'Redo').click();
    await button(page, 'Undo').click();
    await page.getByText('The hall is valid').waitFor();

    await page.getByLabel('Name').fill('drawn by hand');
    await button(page, 'Set name and size').click();
    await button(page, 'Use this hall').click();
    await page.locator('main').getByText('drawn by hand').waitFor();
    await searched(page, patience);
    must(await page.locator('#bar h1').getByText('drawn by hand').isVisible(), 'the console calls the hall otherwise');
    await picture('searched');
  },
};

export const hallByKeys = {
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/simulator/editor?hall=seed-9x8`);
    const plan = page.locator('#plan');
    await plan.waitFor();
    for (let tabs = 0; !(await plan.evaluate((canvas) => canvas === document.activeElement)); tabs += 1) {
      must(tabs < 30, 'the plan is not to be reached by keys');
      await page.keyboard.press('Tab');
    }
    const press = async (...keys) => { for (const key of keys) await page.keyboard.press(key); };
    await press('e', 'r', 'ArrowDown', 'Space', ...Array(8).fill('ArrowRight'), ...Array(6).fill('ArrowDown'), 'Space');
    must((await drawing(page)).slice(1).join('') === '.'.repeat(63), `it is not empty: ${await drawing(page)}`);
    await press('w', 'f', 'ArrowUp', 'Space', 'Shift+ArrowLeft', 'Shift+ArrowLeft');
    must((await drawing(page))[6] === '......###', `the wall is ${(await drawing(page))[6]}`);
    must(/column 6, row 6: wall/.test(await cursor(page).innerText()), await cursor(page).innerText());
    await press('d', 'ArrowUp', 'Space');
    must(/column 6, row 5: dangerous luggage a/.test(await cursor(page).innerText()), await cursor(page).innerText());
    await press('Control+z', 'b', 'Space', 'l', 'Space', 'c');
    must(/: luggage$/.test(await cursor(page).innerText()), await cursor(page).innerText());
    await picture('typed');
    await page.getByText('The hall is valid').waitFor();
    await button(page, 'Use this hall').focus();
    await page.keyboard.press('Enter');
    await page.waitForURL(/\/simulator$/);
    await searched(page, patience);
  },
};

/** Areas are drawn by pointer and by keys, named, saved and opened again. What is wrong is said with its line. */
export const hallAreas = {
  tolerated: ['422'],
  async play({ page, url, picture }) {
    await page.goto(`${url}/simulator/editor?hall=seed-9x8`);
    const plan = page.locator('#plan');
    await plan.waitFor();
    const areas = async () => [...(await text(page)).matchAll(/name = "(.*)"\nprobability = (.*)\ncorners = (.*)/g)].map((found) => found.slice(1).join(' '));
    const are = async (...expect) => must((await areas()).join('; ') === expect.join('; '), `the areas are ${await areas()}`);
    await choose(page, /^Area/);
    must(await page.getByRole('radio', { name: /^Brush/ }).isDisabled(), 'a brush draws no area');
    await drag(page, [0, 0], [3, 2], 9);
    await are('Area 1 0.1 [[0, 0], [3, 2]]');
    await choose(page, /^Line/);
    for (const [column, row] of [[5, 4], [8, 4], [8, 7], [5, 4]]) await page.mouse.click(...await middle(page, column, row, 9));
    await are('Area 1 0.1 [[0, 0], [3, 2]]', 'Area 2 0.1 [[5, 4], [8, 4], [8, 7]]');
    await page.getByText('a search has nothing to inspect').waitFor();
    must((await cursor(page).innerText()).endsWith('in the area Area 2'), await cursor(page).innerText());

    const first = page.getByRole('listitem', { name: 'Area 1' });
    await first.getByLabel('Area name').fill('gate "1"');
    await page.keyboard.press('Tab');
    await page.keyboard.press('Control+a');
    await page.keyboard.type('0,95');
    await page.keyboard.press('Tab');
    must(/probability = 0.95/.test(await text(page)), 'the probability has lost the keyboard');
    await page.locator('#findings .why').getByText(/hall\.toml:\d+: area "Area 2": the probabilities of the areas up to this one add up to more than 1/).waitFor();
    await picture('too-probable');
    const share = page.getByRole('listitem', { name: 'gate "1"' }).getByLabel('Probability');
    await share.fill('much');
    await page.keyboard.press('Tab');
    await page.locator('#draw-why').getByText('Give the area a probability from 0 to 1.').waitFor();
    await share.fill('0.4');
    await page.keyboard.press('Tab');
    await page.getByText('Probability outside the areas: 0.5').waitFor();
    await page.getByText('a search has nothing to inspect').waitFor();
    await fits(page);
    await picture('areas');

    // With keys: a second outline, cancelled, and an area of one cell over the first one, undone.
    await plan.focus();
    for (const key of ['a', 'l', 'Space', 'ArrowLeft', 'Space', 'c', 'r']) await page.keyboard.press(key);
    for (let steps = 0; steps < 8; steps += 1) for (const key of ['ArrowLeft', 'ArrowUp']) await page.keyboard.press(key);
    await page.keyboard.press('Space');
    await page.keyboard.press('Space');
    await page.locator('#findings .why').getByText(/hall\.toml:\d+: area "Area \d": the cell \(0, 0\) is in the area "gate "1"" too/).waitFor();
    await page.keyboard.press('Control+z');
    await page.getByText('a search has nothing to inspect').waitFor();

    await page.getByLabel('Save as').fill('with-areas');
    await button(page, /^Save$/).click();
    await page.getByText('This hall is saved as with-areas').waitFor();
    must(/name = 'gate "1"'\nprobability = 0.4/.test(await text(page)), `the file has another area: ${await text(page)}`);
    await button(page, 'Delete area Area 2').click();
    must(/name = "gate \\"1\\""\nprobability = 0.4\ncorners = \[\[0, 0\], \[3, 2\]\]\n$/.test(await text(page)), `it is ${await text(page)}`);
    await picture('saved');
  },
};

const files = {
  'm.map': 'type octile\nheight 2\nwidth 4\nmap\n..T@\n....\n',
  'room.js': 'const config = { floor: { size: { x: 35, y: 35 } }, player: { position: { x: .08, y: .08 }, speed: .2 } };\nexport default config;\n',
  'mine.toml': 'drawing = """\nS.T.\n"""\n',
  'depot.pgm': 'P2 3 2 255\n254 254 0\n254 254 254\n',
};

export const hallsOpened = {
  tolerated: ['422'],
  async play({ page, url, picture }) {
    await page.goto(`${url}/simulator/editor`);
    await page.locator('#plan').waitFor();
    const open = (...names) => page.locator('#file').setInputFiles(names.map((name) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(files[name] ?? 'nonsense') })));
    for (const [name, rows] of [['m.map', ['S.T#', '....']], ['mine.toml', ['S.T.']], ['room.js', null]]) {
      await open(name);
      await cursor(page).getByText(`${name} is open`).waitFor();
      if (rows) must(JSON.stringify(await drawing(page)) === JSON.stringify(rows), `${name}: ${await drawing(page)}`);
    }
    await page.getByLabel(/Metres per pixel/).fill('0.5');
    await open('depot.pgm');
    await cursor(page).getByText('depot.pgm is open').waitFor();
    // World (0, 0) is the south-western corner of an image.
    must(JSON.stringify(await drawing(page)) === '["..#","S.."]', `depot.pgm: ${await drawing(page)}`);
    await open('broken.js');
    await page.locator('#draw-why').getByText(/broken\.js:1/).waitFor();
    const down = page.waitForEvent('download');
    await page.getByText('Download').click();
    must((await down).suggestedFilename() === 'depot.toml', 'it is called otherwise');
    await picture('opened');
  },
};

/**
 * A hall that has changed is not called valid before its next check: while a text is typed, and while a line is
 * drawn.
 */
export const hallsJudged = {
  tolerated: ['422'],
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/simulator/editor?hall=seed`);
    const findings = page.locator('#findings');
    await findings.getByText('The hall is valid').waitFor();
    const toml = page.locator('#toml');
    const judged = () => findings.innerText();
    await toml.focus();
    const sound = await toml.inputValue();
    /** Text of the findings immediately after a change, however fast the check is. */
    const after = (value) => toml.evaluate((field, value) => {
      field.value = value;
      field.dispatchEvent(new Event('input', { bubbles: true }));
      return document.getElementById('findings').innerText;
    }, value);
    must(/not checked yet/.test(await after(sound.replace(/"""\nS/, '"""\n.'))), `a text without S is called ${await judged()}`);
    await until(async () => await findings.locator('.why').count() === 1, 'what is wrong, while the text has the keyboard', patience);
    await picture('unsound');
    must(!/is valid/.test(await judged()), await judged());
    must(/not checked yet/.test(await after(sound)), `a mended text is called ${await judged()}`);
    await findings.getByText('The hall is valid').waitFor();
    must((await page.locator('#why').innerText()) === '', 'it is still refused elsewhere');
    const drawn = await page.evaluate(() => {
      change(() => put(3, 3, WALL));
      return document.getElementById('findings').innerText;
    });
    must(/not checked yet/.test(drawn), `a drawing that was just changed is called ${drawn}`);
    await until(async () => !/not checked/.test(await judged()), 'a judgement of the drawing as it is now', patience);
  },
};

/** A hall is saved, opened again, replaced only on request, and restored after it was discarded. */
const keeping = (tools) => ({
  tolerated: ['409'],
  async play({ page, url, picture }) {
    const open = async (hall) => {
      await page.goto(`${url}/simulator/editor?hall=${hall}`);
      await page.locator(tools).waitFor();
    };
    const keep = async (name) => {
      await page.getByLabel('Save as').fill(name);
      await button(page, /^Save$/).click();
    };
    const says = async (words) => {
      await page.getByText(words).waitFor();
      await page.locator(tools).waitFor();
    };
    const kept = async (rows) => {
      await says('This hall is saved as mine.');
      must((await drawing(page)).join() === rows, `it is not what was kept: ${await drawing(page)}`);
    };
    await open('seed-9x8');
    await page.locator('#toml').fill('drawing = """\nS.T\n"""\n');
    await keep('mine');
    await kept('S.T');
    await page.locator('#toml').fill('drawing = """\nS..T\n"""\n');
    await keep('mine');
    await kept('S..T');
    await open('airport');
    await keep('mine');
    await page.getByText('Another hall is saved as mine').waitFor();
    await picture('another');
    await open('mine');
    await kept('S..T');
    await page.locator('#toml').fill('drawing = """\nS.TT\n"""\n');
    await button(page, 'Discard mine').click();
    await says('Discard mine? The saved hall is then lost.');
    must((await drawing(page)).join() === 'S.TT' && await button(page, 'Discard mine…').count(), 'one press has discarded something');
    await button(page, 'Discard mine for good').click();
    await says('The saved hall mine was discarded');
    must((await drawing(page)).join() === 'S.TT' && !(await button(page, 'Discard mine').count()), 'the drawing is gone, or the hall kept still');
    await keep('mine');
    await kept('S.TT');
    await open('empty-8x8');
    await keep('other');
    await says('This hall is saved as other.');
    await keep('mine');
    await says('Another hall is saved as mine');
    await page.getByLabel('Save as').fill('other');
    await button(page, 'Replace mine').click();
    await page.getByText('This hall is saved as other.').waitFor();
    await open('mine');
    await kept('S.TT');
    await open('empty-8x8');
    await keep('mine');
    await says('Another hall is saved as mine');
    await button(page, 'Replace mine').click();
    await kept(Array(8).fill('........').join().replace('.', 'S'));
    await page.goto(`${url}/simulator`);
    must(await page.locator('option', { hasText: /^mine$/ }).count() === 1, 'the simulator does not offer it');
  },
});

export const hallsKept = keeping('#plan');
export const hallsKeptPlain = { ...keeping('#toml'), browser: { javaScriptEnabled: false } };

export const simulatorControls = {
  tolerated: ['409', '422'],
  async play({ page, url, picture, patience }) {
    await page.goto(url);
    await page.getByRole('link', { name: 'Simulator' }).click();
    await page.waitForURL(/simulator$/);
    await fits(page);
    await button(page, /^Pause/).click();
    await page.getByText('simulated time is stopped').waitFor();
    await button(page, /^Resume/).click();
    await page.getByText(/Running/).waitFor();
    await button(page, /^Pause/).click();
    await page.getByText('simulated time is stopped').waitFor();
    await button(page, /^One step/).click();
    await page.locator('#time').getByText('press START first').waitFor();
    await button(page, 'Make the camera fail').click();
    await page.getByText('Camera: failing').waitFor();
    await page.getByLabel('x', { exact: true }).fill('1');
    await page.getByLabel('y', { exact: true }).fill('2');
    await button(page, 'Block this cell').click();
    await button(page, 'Clear (1, 2)').waitFor();
    await picture('paused');
    const console = await page.context().newPage();
    await console.goto(url);
    await console.getByText('Paused: the simulated time is stopped').waitFor();
    await button(page, /^Resume/).click();
    await console.getByText('Paused: the simulated time is stopped').waitFor({ state: 'detached' });
    await button(page, /^Pause/).click();
    await console.getByText('Paused: the simulated time is stopped').waitFor();
    await console.close();
    await button(page, 'START the search').click();
    await page.waitForURL(/\/$/);
    await page.goto(`${url}/simulator`);
    await page.getByText(/let the mission end, or press RESET/).waitFor();
    must(await button(page, 'Use this hall').isDisabled(), 'the hall can be left');
    await button(page, /^One step/).click();
    await stop(page).click();
    await page.getByText('STOP is confirmed').waitFor();
    await button(page, 'Repair the camera').click();
    await page.getByText('Camera: working').waitFor();
    await button(page, /^Resume/).click();
    await page.getByText(/Running/).waitFor();
    await page.goto(url);
    await start(page).click();
    await phase(page, /explored/i, { patience });
  },
};

const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
export const simulatorOnPhone = { ...simulatorControls, browser: phone };

export const simulatorPlain = {
  tolerated: ['422'],
  browser: { javaScriptEnabled: false },
  async play({ page, url, picture, patience }) {
    await page.goto(`${url}/simulator`);
    await button(page, /^Pause/).click();
    await page.getByText('simulated time is stopped').waitFor();
    await button(page, /^Resume/).click();
    await page.getByText(/Running/).waitFor();
    await page.getByRole('link', { name: 'Edit the hall' }).click();
    must(!(await page.locator('#draw').isVisible()), 'tools are shown that do nothing');
    await page.locator('#toml').fill('drawing = """\nS..\n##.\nT..\n...\n');
    await button(page, 'Check').click();
    await page.locator('#why').getByText(/hall\.toml:\d+/).waitFor();
    await page.locator('#toml').fill('name = "written"\ndrawing = """\nS..\n##.\nT..\n"""\n');
    await button(page, 'Check').click();
    await page.getByText('The hall is valid').waitFor();
    await fits(page);
    await picture('checked');
    await button(page, 'Use this hall').click();
    await page.getByText('written').waitFor();
    await button(page, 'START the search').click();
    await page.waitForURL(`${url}/`);
    await appears(page, safe(page), { patience, reload: true });
    await safe(page).click();
    await phase(page, /explored/i, { patience, reload: true });
  },
};
