// Engines of a chart can be told apart by those who see less colour, and in print by their shapes.
import assert from 'node:assert/strict';
import test from 'node:test';
import { looksOf } from '../chart/options.js';

/** What is seen of linear light without one of the cones [Machado, Oliveira, Fernandes, A physiologically-based model for
 * simulation of color vision deficiency, 2009]. */
const SIGHTS = {
  all: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
};
const TOLD_APART = 10;  // in CIE L*a*b*; 2.3 is what just can be seen of areas side by side

const times = (matrix, v) => matrix.map((row) => row.reduce((sum, m, i) => sum + m * v[i], 0));
const linear = (color) => [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16) / 255)
  .map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

function lab(light) {
  const xyz = times([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]], light);
  const [x, y, z] = xyz.map((c, i) => Math.cbrt(Math.max(c / [0.9505, 1, 1.089][i], 0)));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

const looks = [...looksOf({ variants: 'abcdefgh'.split('').map((engine) => ({ engine })) }).values()];

test('every engine has a shape of its own', () => {
  assert.equal(new Set(looks.map(({ symbol }) => symbol)).size, looks.length);
});

for (const [sight, matrix] of Object.entries(SIGHTS))
  test(`colours are told apart with ${sight === 'all' ? 'all cones' : sight}`, () => {
    const seen = looks.map(({ color }) => lab(times(matrix, linear(color))));
    seen.forEach((a, i) => seen.slice(0, i).forEach((b, j) => assert.ok(
      Math.hypot(...a.map((c, k) => c - b[k])) >= TOLD_APART, `${looks[i].color} and ${looks[j].color}`)));
  });
