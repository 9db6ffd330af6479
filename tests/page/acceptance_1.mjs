// Opening the crash scene shows a moving picture, and the page is small.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { gzipSync } from 'node:zlib';
import { acceptance, EVERYTHING, pageFile, say, until } from './support/acceptance.mjs';
import { ask, Browser, pause, poses, scene, shown, status, step } from './support/browser.mjs';
import { canvasPicture, compare } from './support/picture.mjs';
import { Program } from './support/program.mjs';

const LARGEST = 1.5e6;  // bytes of the page, gzipped

/** How far the body that moves the most has moved, m. */
function farthest(before, after) {
  let most = 0;
  for (const [node, [x, y, z]] of after) {
    const [x0, y0, z0] = before.get(node) ?? [x, y, z];
    most = Math.max(most, Math.hypot(x - x0, y - y0, z - z0));
  }
  return most;
}

/** Stands at the beginning, and shows it. */
async function restart(page) {
  await pause(page);
  await ask(page, 'reset');
  await until('the beginning', async () => (await status(page)).step === 0);
  await shown(page, 0);
}

await acceptance(EVERYTHING, async (test) => {
  const size = gzipSync(await readFile(pageFile)).length;
  say(`the page has ${Math.round(size / 1000)} kB, gzipped`);
  assert.ok(size <= LARGEST, `${size} bytes`);

  const program = await Program.start(test, 'crash');
  const browser = await Browser.start(test);
  const page = await browser.open(program.url);
  const helper = await browser.empty();

  say('the scene that was asked for plays by itself');
  assert.equal((await scene(page)).name, 'crash');
  // On a busy machine it may be over before the first picture of it.
  const opened = await status(page);
  assert.ok(opened.playing || opened.step > 0);
  await restart(page);
  const before = await poses(page);
  const draws = await page.evaluate(() => window.ragtop.draws);
  await ask(page, 'play');
  await until('new pictures of moved bodies', async () =>
    (await page.evaluate(() => window.ragtop.draws)) >= draws + 5 && farthest(before, await poses(page)) > 0.5);

  const marks = await page.evaluate(() => ['first', 'moving']
    .map((which) => performance.getEntriesByName(`ragtop:${which}-picture`)[0]?.startTime ?? NaN));
  say(`after opening, the first picture came in ${marks.map((ms) => `${(ms / 1000).toFixed(1)} s`).join(', a moving one in ')}`);

  say('between two steps of it bodies and pixels change');
  await restart(page);
  await step(page, 30);
  const [there, picture] = [await poses(page), await canvasPicture(page)];
  await step(page, 30);
  const [after, next] = [await poses(page), await canvasPicture(page)];
  assert.ok(farthest(there, after) > 0.5);
  const { changed, colors } = await compare(helper, picture, next);
  say(`${(100 * changed).toFixed(1)} % of the pixels changed, ${colors} colours`);
  assert.ok(changed > 0.001, 'hardly a pixel has changed');
  assert.ok(colors > 100, 'the picture is empty');

  say('a picture of the same step is the same');
  const { changed: still } = await compare(helper, next, await canvasPicture(page));
  assert.ok(still < changed / 10);
});
