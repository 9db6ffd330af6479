// The page of a chart opens from disk without a network, filters, tells what is under the pointer, and turns dark.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { stat } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { acceptance, root, say, until } from './support/acceptance.mjs';
import { Browser } from './support/browser.mjs';

const LARGEST = 3e6;  // bytes of the page
const POINTS = 3000;  // at least
const FRAMES = 30;    // a second, at least
const bench = process.env.RAGTOP_BENCH ?? path.join(root, 'build/release/ragtop_bench');

async function keptPage(folder) {
  execFileSync(bench, ['chart', '--draw', path.join(root, 'bench/results/chart.csv'), '--out', folder]);
  const file = path.join(folder, 'chart.html');
  assert.ok((await stat(file)).size <= LARGEST, 'the page is too large');
  return pathToFileURL(file).href;
}

const background = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
const marks = (page) => page.evaluate(() => window.ragtop.marks());

await acceptance(['browser', 'playwright'], async (test) => {
  const url = await keptPage(test.folder);
  const browser = await Browser.start(test);
  const page = await browser.open(url, { width: 1400, height: 900 });

  const requests = await page.evaluate(() => performance.getEntriesByType('resource').map(({ name }) => name));
  assert.deepEqual(requests.filter((name) => !name.startsWith('data:')), [], 'the page asks for other files');
  const all = await marks(page);
  say(`${all} marks of ${await page.evaluate(() => window.ragtop.points.length)} points are drawn`);
  assert.ok(all >= POINTS);

  say('what is filtered out is gone, and comes back');
  await page.uncheck('input[value=ragtop]');
  const others = await marks(page);
  assert.ok(others < all && others > 0);
  await page.check('input[value=ragtop]');
  assert.equal(await marks(page), all);
  await page.uncheck('input[name=failures]');
  assert.ok(await marks(page) < all);
  await page.check('input[name=failures]');
  await page.check('input[value=consistency]');
  assert.ok(await marks(page) > 0);
  await page.check('input[value=error]');

  say('the card tells the setting under the pointer, and the command that repeats it');
  const index = await page.evaluate(() => window.ragtop.points.findIndex(({ engine, standard, outcome, alone }) =>
    engine === 'ragtop' && standard && outcome === 'measured' && alone));
  const [x, y] = await page.evaluate((i) => window.ragtop.place(i), index);
  await page.mouse.move(x - 40, y);
  await page.mouse.move(x, y, { steps: 5 });
  await until('the card', () => page.isVisible('#card'));
  const command = await page.textContent('#card code');
  assert.match(command, /^ragtop_bench chart --point '[a-z0-9-]+\/ragtop[a-z-]*@\d+x\d+i\d+'$/);

  say('the pointer moves and the page scrolls at 30 frames a second, and nothing is drawn anew');
  const before = await page.evaluate(() => window.ragtop.draws);
  // The best of some seconds: others may have a share of the processor for a while.
  const frames = await page.evaluate(() => new Promise((resolve) => {
    const SPANS = 6, COUNT = 40;
    let best = 0, count = 0, start = performance.now();
    const next = () => {
      ++count;
      const at = [400 + 6 * (count % COUNT), 300 + (count % 7) * 20];
      document.elementFromPoint(...at)?.dispatchEvent(new MouseEvent('mousemove', { clientX: at[0], clientY: at[1], bubbles: true }));
      scrollBy(0, count % 80 < 40 ? 24 : -24);
      if (count % COUNT === 0) {
        const now = performance.now();
        best = Math.max(best, 1000 * COUNT / (now - start));
        start = now;
      }
      if (count < SPANS * COUNT) requestAnimationFrame(next);
      else resolve(best);
    };
    requestAnimationFrame(next);
  }));
  say(`${frames.toFixed(0)} frames a second`);
  assert.ok(frames >= FRAMES, `${frames.toFixed(0)} frames a second are too few`);
  assert.equal(await page.evaluate(() => window.ragtop.draws), before);

  say('a click rings the same variant in all scenes, and another one lets it go');
  const [ringX, ringY] = await page.evaluate((i) => window.ragtop.place(i), index);
  await page.mouse.click(ringX, ringY);
  await until('the rings', async () => await page.evaluate(() => window.ragtop.draws) > before);

  say('it turns from light to dark');
  const light = await background(page);
  await page.click('#theme');
  assert.notEqual(await background(page), light);

  say('one scene alone takes the whole width');
  const name = await page.evaluate(() => window.ragtop.points[0].scene);
  await page.selectOption('select[name=scene]', name);
  assert.equal(await page.locator('.panel:visible').count(), 1);
});
