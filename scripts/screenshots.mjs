// Takes the pictures that scripts/screenshots.sh says. Each is of one step of a scene, so that it comes out the same.
import { existsSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import path from 'node:path';
import { acceptance, EVERYTHING, root, say, until } from '../tests/page/support/acceptance.mjs';
import { advance, ask, Browser, look, pause, scene } from '../tests/page/support/browser.mjs';
import { finished } from '../tests/page/support/picture.mjs';
import { Program } from '../tests/page/support/program.mjs';

const SIZE = { width: 1024, height: 576 };
const LIT = ['contacts', 'joints', 'bounds', 'centers', 'islands', 'wheels', 'skeleton', 'shapes'];

/**
 * What is seen of each scene: after `steps` steps, from `eye` at `target` (m), with what is `shown`; the panels, or the
 * scene alone; and what is done before, if anything.
 */
const PICTURES = {
  crash: { steps: 46, eye: [-7, 2.8, -12.5], target: [-0.6, 1.3, -4.5], panels: true },
  rain: { steps: 110, eye: [4.5, 3.5, -12.5], target: [0, 2.2, -2] },
  tower: { steps: 42, eye: [5, 3.5, 15], target: [1.2, 5.6, 0], before: topple },
  track: { steps: 480, chase: true, shown: ['wheels'], panels: true },
  wrecker: { steps: 128, eye: [-9.5, 4.2, -4.5], target: [0, 2.9, 3] },
  mechanisms: { steps: 60, eye: [0.5, 4.6, 8.6], target: [0, 1.1, 0.5], shown: ['joints'] },
  door: { steps: 150, eye: [-3, 3.2, 5.5], target: [1, 0.8, 0] },
  chain: { steps: 60, eye: [3, 5, 14], target: [1, 3.5, 1] },
  stairs: { steps: 150, eye: [5.5, 2.6, -3], target: [0, 1.2, 1.5] },
  ledge: { steps: 300, eye: [3.4, 2.6, -4.2], target: [0.6, 2.4, 0] },
  crowd: { steps: 200, eye: [6, 4, -7], target: [0, 0.8, 0] },
  puppet: { steps: 420, eye: [3, 1.8, -3.5], target: [0, 0.9, 0] },
  cape: { steps: 150, eye: [-1.5, 2, -3], target: [0, 0.95, -0.1] },
  dummy: { steps: 37, eye: [2.7, 1.9, 6.2], target: [0, 0.85, 7.5] },
  parade: { steps: 90, eye: [0.4, 3.2, 5], target: [-0.2, 0.7, -2] },
  robots: { steps: 24, eye: [0.6, 2, 5.2], target: [0, 0.6, 0] },
};

/** The middle of the picture. */
const CLOSE = { x: 352, y: 135, width: 320, height: 300 };
/** Where each kind of joint stands in `mechanisms`, and from how far away it is seen; m. */
const JOINTS = {
  'ball-cone': { at: [-5, 1.7, 4] },
  'ball-ellipse': { at: [-3, 1.7, 4] },
  'ball-pyramid': { at: [-1, 1.7, 4] },
  'ball-reach': { at: [1, 1.7, 4] },
  'ball-drives': { at: [3, 1.6, 4] },
  distance: { at: [5, 1.9, 4], away: 3 },
  hinge: { at: [-6.2, 1.4, 1], away: 2.2 },
  slider: { at: [-4.5, 1.5, 1], away: 2.4 },
  cylindrical: { at: [-3, 1.3, 1], away: 2.8 },
  universal: { at: [-1.2, 1.5, 1], away: 2 },
  plane: { at: [0.5, 1.4, 1], away: 2.8 },
  screw: { at: [2, 1.9, 1], away: 3.4 },
  path: { at: [3.9, 1.5, 1], away: 4.6 },
  'six-dof': { at: [6, 1.6, 1], away: 2.4 },
  fixed: { at: [7.4, 0.3, 1], away: 1.6 },
  gear: { at: [-5.3, 1.5, -2], away: 4.4 },
  rack: { at: [-2.3, 1.6, -2], away: 4 },
  pulley: { at: [0.6, 2.1, -2], away: 5 },
  tendon: { at: [3.3, 2, -2], away: 2.8 },
};

const samples = process.env.RAGTOP_SAMPLES ?? path.join(root, '../shared/data');
/**
 * What physics sees of those in `parade`: the middle of each, and from how far away it is seen, m. Those of a file of
 * others are there where that is.
 */
const BODIES = {
  mannequin: { at: [-2.2, 0.85, 0], away: 3.6 },
  dummy: { at: [0.3, 0.85, 0], away: 3.6 },
  biped: { at: [1.3, 0.85, 0], away: 3.6 },
  dog: { at: [2.2, 0.3, 0.1], away: 2 },
  arm: { at: [3.3, 0.5, 0] },
  arnaud: { at: [-4.4, 0.9, -4.5], away: 3.8, file: `${samples}/characters/arnaud.fbx` },
  'cesium-man': { at: [-2, 0.75, -4.5], away: 3.2, file: `${samples}/characters/cesium_man.gltf` },
  knight: { at: [-0.3, 1.1, -4.5], away: 5, file: `${samples}/characters/knight.glb` },
  epileptic: { at: [1.4, 0.9, -4.5], away: 3.8, file: '/usr/share/assimp/models/X/BCN_Epileptic.X' },
};

/** A heavy ball hits the tower in the middle. */
async function topple(page) {
  await advance(page, 30);
  await ask(page, 'shoot', { origin: [-9, 6.3, 2.5], direction: [9, 0.35, -2.5], speed: 25, radius: 0.6 });
}

/** Whether the page draws: not on the way to a picture, which takes longer than the picture without a graphics card. */
const setDrawing = (page, on) => page.evaluate((is) => { window.ragtop.drawing = is; }, on);

/** The page with another scene, paused at its beginning. */
async function load(page, name) {
  await setDrawing(page, false);
  await ask(page, 'load', { scene: name });
  await until(`the scene ${name}`, async () => (await scene(page))?.name === name);
  await pause(page);
  await ask(page, 'reset');
}

async function showPanels(page, wanted) {
  const hidden = await page.locator('#left').evaluate((panel) => panel.hidden);
  if (hidden === wanted) await page.keyboard.press('h');
}

async function takePicture(page, { steps, eye, target, chase = false, shown = [], panels = false, before }) {
  await ask(page, 'show', Object.fromEntries(LIT.map((name) => [name, shown.includes(name)])));
  await showPanels(page, panels);
  await before?.(page);
  // A few at a time where there are plots, so that they have something to show.
  const some = panels ? 6 : steps;
  for (let left = steps; left > 0; left -= some) await advance(page, Math.min(left, some));
  await setDrawing(page, true);
  await page.click(`#cameras [data-camera=${chase ? 'chase' : 'orbit'}]`);
  await page.mouse.move(0, SIZE.height / 2);
  if (!chase) await look(page, eye, target);
  await finished(page);
}

/** Pictures of what stands in a scene, each by its name in a folder. */
async function takeCloseUps(page, folder, name, view, places) {
  await load(page, name);
  await takePicture(page, view);
  await mkdir(folder, { recursive: true });
  for (const [one, { at, away = 2.4, file }] of Object.entries(places)) {
    if (file && !existsSync(file)) continue;
    await look(page, [at[0] + 0.35 * away, at[1] + 0.3 * away, at[2] + 0.88 * away], at);
    const picture = path.join(folder, `${one}.png`);
    await finished(page);
    await page.screenshot({ path: picture, clip: CLOSE });
    say(picture);
  }
}

await acceptance(EVERYTHING, async (test) => {
  const folder = path.resolve(process.argv[2] ?? path.join(root, 'docs/pictures'));
  // What begins last ends first: a page whose program has ended complains.
  const program = await Program.start(test, 'crash');
  const browser = await Browser.start(test);
  // Opening a page takes longer than its picture.
  const page = await browser.open(`${program.url}?quality=high`, SIZE);
  for (const [name, view] of Object.entries(PICTURES)) {
    await load(page, name);
    await takePicture(page, view);
    const file = path.join(folder, `${name}.png`);
    await page.screenshot({ path: file });
    say(file);
  }
  await takeCloseUps(page, path.join(folder, 'joints'), 'mechanisms', { ...PICTURES.mechanisms, steps: 30 }, JOINTS);
  await takeCloseUps(page, path.join(folder, 'bodies'), 'parade', { ...PICTURES.parade, steps: 30, shown: ['shapes'] }, BODIES);
});
