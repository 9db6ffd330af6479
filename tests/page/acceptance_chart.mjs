// The page of a chart opens from disk without a network, filters, tells what is under the pointer, and turns dark.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFile, stat, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { acceptance, root, say, until } from './support/acceptance.mjs';
import { Browser } from './support/browser.mjs';

const LARGEST = 3e6;  // bytes of the page
const POINTS = 3000;
const bench = process.env.RAGTOP_BENCH ?? path.join(root, 'build/release/ragtop_bench');

/** The same scenes again and again, under other names, until there are so many points. */
function multiplied(data) {
  const { scenes, points, fronts } = data;
  const [kinds, count] = [scenes.length, points.length];
  for (let copy = 1; points.length < POINTS; ++copy) {
    for (const scene of scenes.slice(0, kinds)) scenes.push({ ...scene, name: `${scene.name}-${copy}` });
    for (const point of points.slice(0, count)) points.push({ ...point, scene: `${point.scene}-${copy}` });
    for (const front of fronts.filter(({ scene }) => scenes.slice(0, kinds).some(({ name }) => name === scene)))
      fronts.push({ ...front, scene: `${front.scene}-${copy}`, points: front.points.map((i) => i + copy * count) });
  }
  return data;
}

async function pageWithManyPoints(folder) {
  execFileSync(bench, ['chart', '--draw', path.join(root, 'bench/results/chart.csv'), '--out', folder]);
  const file = path.join(folder, 'chart.html');
  assert.ok((await stat(file)).size <= LARGEST, 'the page is too large');
  const html = await readFile(file, 'utf8');
  const many = html.replace(/(<script id="data" type="application\/json">)(.*?)(<\/script>)/s,
    (_, before, data, after) => before + JSON.stringify(multiplied(JSON.parse(data))).replaceAll('</', '<\\/') + after);
  await writeFile(file, many);
  return pathToFileURL(file).href;
}

const background = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
const marks = (page) => page.evaluate(() => window.ragtop.marks());

await acceptance(['browser', 'playwright'], async (test) => {
  const url = await pageWithManyPoints(test.folder);
  const browser = await Browser.start(test);
  const page = await browser.open(url, { width: 1400, height: 900 });

  const requests = await page.evaluate(() => performance.getEntriesByType('resource').map(({ name }) => name));
  assert.deepEqual(requests.filter((name) => !name.startsWith('data:')), [], 'the page asks for other files');
  const all = await marks(page);
  say(`${all} marks of ${await page.evaluate(() => window.ragtop.points.length)} points are drawn`);
  assert.ok(all >= 0.8 * POINTS);

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

  say('while the pointer moves nothing is drawn anew');
  const before = await page.evaluate(() => window.ragtop.draws);
  const frames = await page.evaluate(() => new Promise((resolve) => {
    const start = performance.now();
    let count = 0;
    const next = () => {
      ++count;
      const at = [400 + 3 * count, 300 + (count % 7) * 20];
      document.elementFromPoint(...at)?.dispatchEvent(new MouseEvent('mousemove', { clientX: at[0], clientY: at[1], bubbles: true }));
      if (count < 120) requestAnimationFrame(next);
      else resolve(1000 * count / (performance.now() - start));
    };
    requestAnimationFrame(next);
  }));
  say(`${frames.toFixed(0)} frames a second`);
  assert.equal(await page.evaluate(() => window.ragtop.draws), before);

  say('a click rings the same variant in all scenes, and another one lets it go');
  await page.mouse.click(x, y);
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
