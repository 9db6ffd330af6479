// Two pages watch two thousand moving bodies, and both see every one of them where it is. What that costs is measured
// by `ragtop_bench page`.
import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import path from 'node:path';
import { acceptance, EVERYTHING, say, until } from './support/acceptance.mjs';
import { ask, Browser, hash, pause, poses, shown, status, step } from './support/browser.mjs';
import { Program } from './support/program.mjs';

const COUNT = [20, 10, 10];
const BODIES = COUNT.reduce((product, n) => product * n);
const SPEED = [1, 2, 3];  // m/s
const FRAMES = 20;

/** Spinning boxes that fly past each other for ever. */
const FLIGHT = {
  settings: { gravity: [0, 0, 0] },
  duration: 3600,
  repeat: [{
    body: {
      name: 'box', shape: { box: { halfExtents: [0.1, 0.1, 0.1] } }, linearVelocity: SPEED,
      angularVelocity: [1, 2, 3], allowSleep: false,
    },
    count: COUNT, spacing: [1, 1, 1],
  }],
};

const framesOf = (page) => page.evaluate(() => window.ragtop.framesReceived);

await acceptance(EVERYTHING, async (test) => {
  const file = path.join(test.folder, 'flight.json');
  await writeFile(file, JSON.stringify(FLIGHT));
  const program = await Program.start(test, file);
  const browser = await Browser.start(test);
  const first = await browser.open(program.url, { width: 320, height: 240 });
  const second = await browser.open(program.url, { width: 320, height: 240 });
  await pause(first);

  say('both get frames while it plays');
  const before = await Promise.all([first, second].map(framesOf));
  await ask(second, 'play');
  await until(`${FRAMES} frames each`, async () =>
    (await Promise.all([first, second].map(framesOf))).every((now, i) => now >= before[i] + FRAMES));
  const at = await pause(first);
  await shown(second, at);
  assert.equal((await status(second)).awake, BODIES);

  say('both show the same poses of all bodies, and after a step those that follow from them');
  const [here, there] = [await poses(first), await poses(second)];
  assert.equal(here.size, BODIES);
  assert.deepEqual(there, here);
  const next = await step(first, 60);
  await shown(second, next);
  assert.equal(await hash(second), await hash(first));
  const moved = await poses(second);
  for (const [node, [x, y, z]] of moved) {
    // 1 s later; poses are floats within 30 m of the origin, sums of 60 steps within 1e-4 m.
    const [x0, y0, z0] = here.get(node);
    const off = Math.hypot(x - x0 - SPEED[0], y - y0 - SPEED[1], z - z0 - SPEED[2]);
    assert.ok(off < 1e-3, `node ${node} is off by ${off} m`);
  }
});
