// Pictures of the page, as numbers.
import { until } from './acceptance.mjs';

/** Waits until the page has drawn what it shows as finely as it will, and nothing more comes in the next frame. */
export async function finished(page) {
  await until('the picture stands still', () => page.evaluate(async () => {
    const { draws } = window.ragtop;
    // The frame that is under way, and a whole one.
    for (let i = 0; i < 2; ++i) await new Promise((resolve) => requestAnimationFrame(resolve));
    return window.ragtop.settled && window.ragtop.draws === draws;
  }));
}

/** The canvas without what lies over it, as a PNG. */
export async function canvasPicture(page) {
  await finished(page);
  await page.evaluate(() => {
    for (const id of ['instruments', 'toasts']) document.getElementById(id).style.visibility = 'hidden';
  });
  return page.locator('#canvas').screenshot();
}

/**
 * Compares two PNGs of equal size.
 * @param {import('playwright-core').Page} helper an empty page, whose decoder is used
 * @returns {Promise<{changed: number, colors: number}>} share of the pixels that differ visibly; colours in the first
 */
export function compare(helper, first, second) {
  return helper.evaluate(async (files) => {
    const images = await Promise.all(files.map(async (file) => {
      const bytes = Uint8Array.from(atob(file), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes]));
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    }));
    const [a, b] = images;
    const colors = new Set();
    let changed = 0;
    for (let i = 0; i < a.length; i += 4) {
      colors.add((a[i] << 16) | (a[i + 1] << 8) | a[i + 2]);
      const difference = Math.max(...[0, 1, 2].map((k) => Math.abs(a[i + k] - b[i + k])));
      if (difference > 8) ++changed;
    }
    return { changed: changed / (a.length / 4), colors: colors.size };
  }, [first.toString('base64'), second.toString('base64')]);
}
