// A recording opened from disk, without a program, shows the poses of the run that wrote it.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { acceptance, EVERYTHING, pageFile, ragtop, say, until } from './support/acceptance.mjs';
import { Browser, poses } from './support/browser.mjs';

const STEPS = 240;
// Places are floats, exact to 4e-6 m within 64 m; times of keys too, and a brick at 30 m/s is 1e-5 m farther in 4e-7 s.
const PLACE = 5e-5;  // m
// Components of rotations are kept in 16 bits.
const TURN = 2e-4;   // rad

/** step, time → rows [x, y, z, qx, qy, qz, qw] in the order of the bodies. */
async function readPoses(file) {
  const [header, ...lines] = (await readFile(file, 'utf8')).trim().split('\n');
  assert.equal(header, 'step,time_s,body,x_m,y_m,z_m,qx,qy,qz,qw');
  const moments = new Map();
  for (const line of lines) {
    const [, time, , ...pose] = line.split(',').map(Number);
    if (!moments.has(time)) moments.set(time, []);
    moments.get(time).push(pose);
  }
  return moments;
}

/** Largest distance and angle between poses one by one. */
function largestDifference(shown, written) {
  let place = 0;
  let turn = 0;
  written.forEach(([x, y, z, ...q], i) => {
    const [sx, sy, sz, ...s] = shown[i];
    place = Math.max(place, Math.hypot(x - sx, y - sy, z - sz));
    // The short side of the angle: acos is blind near one.
    const side = Math.sign(q.reduce((sum, c, k) => sum + c * s[k], 0)) || 1;
    turn = Math.max(turn, 2 * Math.hypot(...q.map((c, k) => c - side * s[k])));
  });
  return { place, turn };
}

await acceptance(EVERYTHING, async (test) => {
  const file = path.join(test.folder, 'poses.csv');
  ragtop('run', 'crash', '--steps', String(STEPS), '--out', test.folder, '--poses', file);
  const moments = await readPoses(file);
  say(`a run of ${STEPS} steps of crash wrote ${moments.size} moments of ${[...moments.values()][0].length} bodies`);
  assert.equal(moments.size, STEPS / 60);

  const browser = await Browser.start(test);
  const page = await browser.open(pathToFileURL(pageFile).href);
  assert.equal(await page.evaluate(() => window.ragtop.connected), false);
  await page.locator('#recording-file').setInputFiles(path.join(test.folder, 'recording.glb'));
  await until('the recording is open', () => page.evaluate(() => window.ragtop.recording !== null));
  const { last } = await page.evaluate(() => window.ragtop.recording);
  assert.ok(Math.abs(last - STEPS / 60) < 1e-4, `it lasts ${last} s`);

  for (const [time, written] of moments) {
    await page.evaluate((t) => window.ragtop.seekRecording(t), time);
    const shown = [...(await poses(page)).values()];
    assert.equal(shown.length, written.length);
    const { place, turn } = largestDifference(shown, written);
    say(`at ${time} s the poses differ by at most ${place.toExponential(1)} m and ${turn.toExponential(1)} rad`);
    assert.ok(place < PLACE && turn < TURN);
  }
});
