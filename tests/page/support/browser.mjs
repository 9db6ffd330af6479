// Chromium, and the page in it.
import { createRequire } from 'node:module';
import path from 'node:path';
import { chromiumFile, root, until } from './acceptance.mjs';

const OPTIONS = ['--disable-gpu', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage', '--mute-audio'];
const WAIT = 120000;  // ms, to end a test that hangs

export class Browser {
  #browser;
  #problems = [];

  static async start({ defer }) {
    const { chromium } = createRequire(path.join(root, 'page/package.json'))('playwright-core');
    const browser = new Browser();
    // As root, as in containers, Chromium has no sandbox.
    const args = process.getuid?.() === 0 ? [...OPTIONS, '--no-sandbox'] : OPTIONS;
    browser.#browser = await chromium.launch({ executablePath: chromiumFile, args, timeout: WAIT });
    defer(() => browser.#end());
    return browser;
  }

  /**
   * A page of its own, opened and ready; `clock`: its time can be stopped. Errors in it make the test fail in the end.
   */
  async open(url, { width = 640, height = 360, clock = false } = {}) {
    const context = await this.#browser.newContext({ viewport: { width, height }, reducedMotion: 'reduce' });
    const page = await context.newPage();
    page.setDefaultTimeout(WAIT);
    if (clock) await page.clock.install();
    page.on('pageerror', (error) => this.#problems.push(`${url}: ${error.stack}`));
    page.on('console', (message) => {
      if (message.type() === 'error') this.#problems.push(`${url}: ${message.text()}`);
    });
    await page.goto(url);
    await page.evaluate(() => window.ragtop.ready);
    return page;
  }

  /** An empty page, for work that needs a browser. */
  async empty() {
    return (await this.#browser.newContext()).newPage();
  }

  async #end() {
    await this.#browser.close();
    if (this.#problems.length > 0) throw new Error(`the page complains:\n${this.#problems.join('\n')}`);
  }
}

/** What the page tells a program that asks, see page/src/api.js. */
export const ask = (page, name, args) => page.evaluate(([n, a]) => window.ragtop.do(n, a), [name, args ?? {}]);
export const status = (page) => page.evaluate(() => window.ragtop.status);
export const scene = (page) => page.evaluate(() => window.ragtop.scene);
export const hash = async (page) => (await ask(page, 'hash')).hash;

/** node → pose, as drawn. */
export async function poses(page) {
  return new Map(await page.evaluate(() => [...window.ragtop.poses()].map(([node, pose]) => [node, [...pose]])));
}

/** Waits until what the page draws is the state after this step, and it stands still. */
export async function shown(page, step) {
  await until(`the page shows step ${step}`, () => page.evaluate((s) => window.ragtop.step === s, step));
  const drawn = await page.evaluate(() => window.ragtop.draws);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return drawn;
}

/** Pauses; the step at which the simulation stands. */
export async function pause(page) {
  await ask(page, 'pause');
  await until('paused', async () => !(await status(page)).playing);
  const { step } = await status(page);
  await shown(page, step);
  return step;
}

/** Makes so many steps, back or on, and does not wait for them to be drawn; the step at which the simulation stands then. */
export async function advance(page, count) {
  const { step: now } = await ask(page, 'step', { count });
  await until(`step ${now}`, () =>
    page.evaluate((s) => window.ragtop.status.step === s && window.ragtop.step === s, now));
  return now;
}

/** Makes so many steps, back or on, and waits for the picture; the step at which the simulation stands then. */
export async function step(page, count) {
  const now = await advance(page, count);
  await shown(page, now);
  return now;
}

/** Where a point of the scene is seen, px. */
export const project = (page, point) => page.evaluate((p) => window.ragtop.camera.project(p), point);

export const look = (page, eye, target) => page.evaluate(([e, t]) => window.ragtop.camera.look(e, t), [eye, target]);
