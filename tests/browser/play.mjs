// Plays one scenario: `node play.mjs SCENARIO URL CHROMIUM SHOTS`. Exit code 0 means that a person would have been
// content. This file opens the browser, watches it for faults that no page may have, and closes it. The scenarios are
// in the files beside it: scenarios.mjs, always.mjs (STOP and the keyboard), areas.mjs, verdicts.mjs (the moment of the
// verdict), time.mjs (the timeline), italian.mjs, judges.mjs (two judges), laboratory.mjs, large.mjs (large halls),
// pictures.mjs (for people to look at), report.mjs, retrieval.mjs and simulator.mjs.

import { mkdirSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';
import * as access from './access.mjs';
import * as always from './always.mjs';
import * as areas from './areas.mjs';
import * as italian from './italian.mjs';
import * as judges from './judges.mjs';
import * as laboratory from './laboratory.mjs';
import * as large from './large.mjs';
import * as pictures from './pictures.mjs';
import { relay } from './relay.mjs';
import * as report from './report.mjs';
import * as retrieval from './retrieval.mjs';
import * as missions from './scenarios.mjs';
import * as time from './time.mjs';
import * as simulator from './simulator.mjs';
import * as verdicts from './verdicts.mjs';

const [name, url, executablePath, shots] = process.argv.slice(2);
const modules = [missions, access, always, areas, italian, judges, laboratory, large, pictures, report, retrieval, time, verdicts, simulator];
const names = modules.flatMap(Object.keys);
const twice = names.filter((one, place) => names.indexOf(one) < place);
if (twice.length > 0) throw new Error(`two scenarios are called ${twice}`);
const scenario = Object.assign({}, ...modules)[name];
const patience = 60_000;

const lines = createInterface({ input: process.stdin })[Symbol.asyncIterator]();

/** Asks the test that started this script for an action, and waits until it is done. */
async function please(what) {
  console.log(`please ${what} the program`);
  await lines.next();
}

/** Answer of the program over CoAP as `2.05 TEXT`; the test that started this script sends the request. */
async function coap(request) {
  console.log(`over CoAP: ${request}`);
  return (await lines.next()).value;
}

/** Records everything that a page must never do. */
function watch(page, faults, tolerated, places) {
  page.on('pageerror', (error) => faults.push(`an error in the page: ${error}`));
  page.on('console', (message) => {
    const text = message.text();
    if (message.type() === 'error' && !tolerated.some((words) => text.includes(words))) faults.push(`console: ${text}`);
  });
  page.on('request', (request) => {
    const asked = request.url();
    const isOurs = (place) => asked === place || asked.startsWith(`${place}/`);
    if (!asked.startsWith('data:') && !places.some(isOurs)) faults.push(`a request to another place: ${asked}`);
  });
}

mkdirSync(shots, { recursive: true });
const browser = await chromium.launch({
  executablePath,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage'],
});
const faults = [];
const places = [url]; // addresses that a page may request
const relays = [];
let page;
let shot = 0;
try {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...scenario.browser });
  context.setDefaultTimeout(patience);
  page = await context.newPage();
  await page.exposeFunction('hallsweepViolation', (what) => faults.push(`against the content policy: ${what}`));
  await page.addInitScript(() => document.addEventListener('securitypolicyviolation',
    (event) => globalThis.hallsweepViolation(`${event.violatedDirective} ${event.blockedURI}`)));
  watch(page, faults, scenario.tolerated ?? [], places);
  // Prints a line per loaded page, because the test that started this script treats a long silence as a hang.
  page.on('load', () => console.log(`${name}: on ${new URL(page.url()).pathname}`));
  const picture = async (what, shown = page) => {
    const path = `${shots}/${name}-${++shot}-${what}.png`;
    // On a busy machine Chromium sometimes fails to take a picture, once for two minutes. A missing picture is no
    // failure: pictures are for people to look at later, and the scenarios check the page itself.
    const taken = () => shown.screenshot({ path, timeout: 20_000 }).then(() => true);
    const late = (error) => {
      if (error.name !== 'TimeoutError') throw error;
      return false;
    };
    const isThere = await taken().catch(taken).catch(late);
    console.log(`${name}: ${what}${isThere ? '' : ', of which there is no picture'}`);
  };
  /** Opens a relay to the program that can be cut. */
  const network = async () => {
    const one = await relay(url);
    relays.push(one);
    places.push(one.url);
    return one;
  };
  await scenario.play({ page, url, please, coap, picture, patience, network });
} catch (error) {
  faults.push(String(error));
  await page?.screenshot({ path: `${shots}/${name}-failed.png`, fullPage: true }).catch(() => {});
} finally {
  await browser.close();
  relays.forEach((one) => one.close());
  process.stdin.destroy();
}
faults.forEach((fault) => console.log(`${name}: ${fault}`));
console.log(faults.length === 0 ? `${name}: a person would be content` : `${name}: ${faults.length} faults`);
process.exitCode = faults.length === 0 ? 0 : 1;
