// What all acceptance tests of the page share: what they need, how they end, what they leave behind.
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const SKIPPED = 77;  // what CTest takes for "skipped"

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../..');
export const programFile = process.env.RAGTOP_PROGRAM ?? path.join(root, 'build/release/ragtop');
export const pageFile = process.env.RAGTOP_PAGE ?? path.join(root, 'build/page/ragtop.html');
export const chromiumFile = process.env.RAGTOP_CHROMIUM ?? '/usr/bin/chromium';

const needs = {
  program: () => existsSync(programFile) || `the program, ${programFile}`,
  page: () => existsSync(pageFile) || `the page, ${pageFile}: scripts/page.sh build`,
  browser: () => existsSync(chromiumFile) || `the browser, ${chromiumFile}: apt-get install chromium`,
  playwright: () => existsSync(path.join(root, 'page/node_modules/playwright-core'))
    || 'playwright-core: scripts/page.sh setup',
};
export const EVERYTHING = Object.keys(needs);
export const PROGRAM_ALONE = ['program'];

/** Says what the test is doing. */
export function say(text) {
  console.log(`- ${text}`);
}

/**
 * Runs a test and ends the process: 0 passed, 1 failed, 77 skipped because something is missing, which is a failure
 * where CI is "true".
 * @param {string[]} required names of `needs`
 * @param {function({defer: function, folder: string}): Promise} test `defer(f)` calls f at the end, last one first
 */
export async function acceptance(required, test) {
  const missing = required.map((name) => needs[name]()).filter((answer) => answer !== true);
  if (missing.length > 0) {
    missing.forEach((what) => console.log(`missing: ${what}`));
    process.exit(process.env.CI === 'true' ? 1 : SKIPPED);
  }
  const deferred = [];
  const folder = await mkdtemp(path.join(tmpdir(), 'ragtop-page-'));
  // The browser and playwright leave theirs there too.
  process.env.TMPDIR = folder;
  deferred.push(() => rm(folder, { recursive: true, force: true, maxRetries: 10 }));
  let failed = false;
  try {
    await test({ folder, defer: (action) => deferred.push(action) });
  } catch (error) {
    failed = true;
    console.error(error);
  }
  for (const action of deferred.reverse()) {
    try {
      await action();
    } catch (error) {
      failed = true;
      console.error(error);
    }
  }
  process.exit(failed ? 1 : 0);
}

/** Tries until `what()` is true, or a promise of it; a limit of time is only there to end a test that hangs. */
export async function until(description, what, seconds = 60) {
  const end = Date.now() + 1000 * seconds;
  while (Date.now() < end) {
    const answer = await what();
    if (answer) return answer;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  throw new Error(`${description}: not after ${seconds} s`);
}

/** Runs the program to its end; what it has printed. */
export function ragtop(...args) {
  return execFileSync(programFile, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 26 });
}
