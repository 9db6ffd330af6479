// All that a person does, through the page alone: run, pause, step back, throw a brick, drive a lap, tune.
import assert from 'node:assert/strict';
import { readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { acceptance, EVERYTHING, root, say, until } from './support/acceptance.mjs';
import { ask, Browser, hash, look, pause, poses, project, scene, shown, status, step } from './support/browser.mjs';
import { driveAround, Road } from './support/driver.mjs';
import { Program } from './support/program.mjs';

const SIZE = { width: 1000, height: 450 };  // wide enough for both panels
const SMALL = { width: 480, height: 270 };  // drawn soon

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const atStep = (page, wanted) => until(`step ${wanted}`, async () => (await status(page)).step === wanted);

async function runPauseAndStepBack(page) {
  say('run and pause by the button, step by key');
  if (!(await status(page)).playing) await page.click('#play');
  await until('a hundred steps', async () => (await status(page)).step >= 100);
  await page.click('#play');
  await until('a pause', async () => !(await status(page)).playing);
  const { step: start } = await status(page);
  await page.keyboard.press('Period');
  await atStep(page, start + 1);

  say('60 steps back and on again: the same hash');
  await shown(page, start + 1);
  const [before, there] = [await hash(page), await poses(page)];
  await page.keyboard.press('Shift+Comma');
  await atStep(page, start - 59);
  await shown(page, start - 59);
  const back = await poses(page);
  assert.ok([...there].some(([node, pose]) => distance(pose, back.get(node)) > 0.1), 'nothing has moved back');
  assert.notEqual(await hash(page), before);
  await page.keyboard.press('Shift+Period');
  await atStep(page, start + 1);
  assert.equal(await hash(page), before);
  await shown(page, start + 1);
  assert.deepEqual(await poses(page), there);

  say('so does scrubbing to the beginning, and playing over what was recorded');
  await page.locator('#scrub').fill('0');
  await atStep(page, 0);
  await page.locator('#scrub').fill(String(start + 1));
  await atStep(page, start + 1);
  assert.equal(await hash(page), before);
}

async function throwBrick(page) {
  say('a click picks a brick on top of the wall');
  await page.click('#reset');
  await atStep(page, 0);
  await pause(page);
  const { nodes } = await scene(page);
  const bricks = nodes.filter(({ type, pose }) => type === 'dynamic' && pose[1] > 1);
  const eye = [4, 5, -9];
  const top = Math.max(...bricks.map(({ pose }) => pose[1]));
  const [{ pose: near }] = bricks.filter(({ pose }) => pose[1] > top - 0.05)
    .sort((a, b) => distance(a.pose, eye) - distance(b.pose, eye));
  await look(page, eye, near.slice(0, 3));
  await step(page, 1);
  const [x, y] = await project(page, near);
  await page.mouse.click(x, y);
  const picked = await until('something is picked', async () => (await status(page)).picked);
  assert.ok(bricks.some(({ node }) => node === picked), `${picked} is no brick`);
  await page.locator('#picked-values').waitFor();

  say('dragging moves it to the pointer, against its weight');
  const from = (await poses(page)).get(picked);
  await page.mouse.move(x, y);
  await page.mouse.down();
  const goal = [x + 60, y - 110];
  for (let i = 1; i <= 6; ++i) await page.mouse.move(x + (i / 6) * (goal[0] - x), y + (i / 6) * (goal[1] - y));
  await step(page, 120);
  const held = (await poses(page)).get(picked);
  const seen = await project(page, held);
  const off = Math.hypot(seen[0] - goal[0], seen[1] - goal[1]);
  say(`it has gone ${distance(held, from).toFixed(2)} m and hangs ${off.toFixed(0)} px from the pointer`);
  assert.ok(distance(held, from) > 0.5);
  assert.ok(held[1] > from[1] + 0.2);
  assert.ok(off < 0.3 * Math.hypot(goal[0] - x, goal[1] - y));

  say('let go, it falls');
  await page.mouse.up();
  // 0.4 s of free fall are 0.78 m; later it may lie on the wall again.
  await step(page, 24);
  assert.ok((await poses(page)).get(picked)[1] < held[1] - 0.5);
}

/** A scene file, which may have comments on lines of their own. */
async function readScene(name) {
  const text = await readFile(path.join(root, `assets/data/scenes/${name}.json`), 'utf8');
  return JSON.parse(text.replace(/^\s*\/\/.*$/gm, ''));
}

async function driveLap(page) {
  say('a lap of the track by the keys W A S D');
  await page.click('#scenes [data-scene=track]');
  await page.setViewportSize(SMALL);
  await until('the track', async () => (await scene(page))?.name === 'track');
  await pause(page);
  await ask(page, 'reset');
  const [{ points, width }] = (await readScene('track')).roads;
  const { steps, round, strayed, fastest } = await driveAround(page, new Road(points), { speed: 18, mostSteps: 6000 });
  say(`${steps} steps, at most ${strayed.toFixed(1)} m from the middle of the road and ${fastest.toFixed(1)} m/s fast`);
  assert.ok(round, 'the car has not come round');
  assert.ok(strayed < width / 2, 'the car has left the road');
}

/** A car alone on a plane. */
function standingCar() {
  return JSON.stringify({
    bodies: [{ name: 'ground', type: 'fixed', shape: { box: { halfExtents: [50, 1, 50] } }, position: [0, -1, 0] }],
    vehicles: [{
      name: 'car', file: path.join(root, 'assets/data/vehicles/hatchback.car.json'), position: [0, 0, 0],
      script: [{ time: 0, handbrake: 1 }],
    }],
  });
}

const STIFFNESS = 'vehicles.car.wheels.front left.suspension.stiffness';
const valueOf = (page, name) =>
  page.evaluate((wanted) => window.ragtop.tunables.find((each) => each.path === wanted).value, name);
const frontLeft = (page) => page.evaluate(() => window.ragtop.telemetry.vehicles[0].wheels[0]);

async function tuneSpring(test, browser) {
  say('the slider of a spring');
  const file = path.join(test.folder, 'standing.json');
  await writeFile(file, standingCar());
  const program = await Program.start(test, file);
  const page = await browser.open(program.url, SIZE);
  await pause(page);
  await step(page, 300);
  const { chassis } = (await scene(page)).vehicles[0];
  const [soft, low] = [await frontLeft(page), (await poses(page)).get(chassis)[1]];
  await page.click('[data-tab=tuning]');
  await page.fill('#tuning-filter', 'front left stiffness');
  const row = page.locator(`[data-path="${STIFFNESS}"]`);
  const before = await valueOf(page, STIFFNESS);
  const { x, y, width, height } = await row.locator('input[type=range]').boundingBox();
  // The slider is logarithmic, with the default in the middle of two decades.
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + 0.6 * width, y + height / 2, { steps: 4 });
  await page.mouse.up();
  const dragged = Number(await row.locator('input[type=text]').inputValue());
  assert.ok(dragged > 1.1 * before, `the slider says ${dragged} N/m`);
  const stiffness = await until('the program has the stiffness of the slider', async () => {
    const value = await valueOf(page, STIFFNESS);
    return Math.abs(value - dragged) < 1e-6 * dragged && value;
  });

  say('the ride height follows from it, without losing the state');
  await step(page, 300);
  const [stiff, high] = [await frontLeft(page), (await poses(page)).get(chassis)[1]];
  const risen = soft.compression - stiff.compression;
  say(`${before} to ${stiffness} N/m: the wheel is ${(1000 * risen).toFixed(0)} mm lower`);
  assert.ok(high > low + 0.003, `the chassis was at ${low} m and is at ${high} m`);
  // At rest the spring carries the load: k (s + c) = F. Dampers let it creep the last tenth of a millimetre.
  const rest = soft.load / before - soft.compression;
  assert.ok(Math.abs(stiff.load / stiffness - rest - stiff.compression) < 1e-3);

  say('saved as what has changed, and loaded again: equal');
  await page.fill('#tuning-name', 'sporty');
  await page.click('#tuning-save');
  const saved = path.join(test.folder, 'tuning', 'standing_sporty.json');
  const content = await until('the file', () => readFile(saved, 'utf8').catch(() => null));
  const { extends: original, tuning } = JSON.parse(content);
  assert.equal(path.resolve(path.dirname(saved), original), file);
  assert.deepEqual(tuning, { [STIFFNESS]: stiffness });
  await row.locator('button.untune').click();
  await until('the stiffness of the file', async () => (await valueOf(page, STIFFNESS)) === before);
  await page.click('#tuning-load');
  await until('the saved stiffness', async () => (await valueOf(page, STIFFNESS)) === stiffness);
  const tunables = await page.evaluate(() => window.ragtop.tunables.filter(({ value, default: d }) => value !== d
    && JSON.stringify(value) !== JSON.stringify(d)).map(({ path: p, value }) => [p, value]));
  assert.deepEqual(tunables, [[STIFFNESS, stiffness]]);

  say('a run that begins with the saved file is the run that went on with it');
  await page.click('#reset');
  await atStep(page, 0);
  await step(page, 120);
  const again = await Program.start(test, saved);
  const other = await browser.open(again.url, SMALL);
  await pause(other);
  await ask(other, 'reset');
  await step(other, 120);
  assert.equal(await hash(other), await hash(page));
}

await acceptance(EVERYTHING, async (test) => {
  const program = await Program.start(test, 'crash');
  const browser = await Browser.start(test);
  const page = await browser.open(program.url, { ...SIZE, clock: true });
  await runPauseAndStepBack(page);
  await throwBrick(page);
  await driveLap(page);
  await page.context().close();
  await tuneSpring(test, browser);
});
