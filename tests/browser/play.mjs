// Plays one scenario: `node play.mjs SCENARIO URL CHROMIUM SHOTS`. Exit code 0 when a person would have been content.
// The scenarios are in scenarios.mjs, that in Italian in italian.mjs, those of large halls in large.mjs, that of the report in report.mjs, those about STOP and the keyboard in always.mjs, those of the laboratory, of the retrieval, of
// the line of time, of the moment of the verdict and of the simulator in laboratory.mjs, retrieval.mjs, time.mjs, verdicts.mjs and
// simulator.mjs; here a browser is opened, watched for what no page may do, and closed.

import { mkdirSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';
import * as access from './access.mjs';
import * as always from './always.mjs';
import * as italian from './italian.mjs';
import * as laboratory from './laboratory.mjs';
import * as large from './large.mjs';
import { relay } from './relay.mjs';
import * as report from './report.mjs';
import * as retrieval from './retrieval.mjs';
import * as missions from './scenarios.mjs';
import * as time from './time.mjs';
import * as simulator from './simulator.mjs';
import * as verdicts from './verdicts.mjs';

const [name, url, executablePath, shots] = process.argv.slice(2);
const scenario = { ...missions, ...access, ...always, ...italian, ...laboratory, ...large, ...report, ...retrieval, ...time, ...verdicts, ...simulator }[name];
const patience = 60_000;

const lines = createInterface({ input: process.stdin })[Symbol.asyncIterator]();

/** Asks the test that started us for something and waits until it is done. */
async function please(what) {
  console.log(`please ${what} the program`);
  await lines.next();
}

/** What the program answers over CoAP, as `2.05 TEXT`; the test that started us asks for us. */
async function coap(request) {
  console.log(`over CoAP: ${request}`);
  return (await lines.next()).value;
}

/** Notes everything a page of ours must never do. */
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
const places = [url]; // where the program is, a prefix included
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
  // The test that started us takes a long silence for hanging.
  page.on('load', () => console.log(`${name}: on ${new URL(page.url()).pathname}`));
  const picture = async (what) => {
    const path = `${shots}/${name}-${++shot}-${what}.png`;
    // On a busy machine Chromium now and then has no picture to give, once not within two minutes. Pictures are for whoever looks at
    // them later: what holds of a page, the scenarios ask the page.
    const taken = () => page.screenshot({ path, timeout: 20_000 }).then(() => true);
    const late = (error) => {
      if (error.name !== 'TimeoutError') throw error;
      return false;
    };
    const isThere = await taken().catch(taken).catch(late);
    console.log(`${name}: ${what}${isThere ? '' : ', of which there is no picture'}`);
  };
  /** Another way to the program, which can be cut. */
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
