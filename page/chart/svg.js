// chart_svg.cjs <chart.html> <picture.svg>: draws the panels of a chart's page as one picture.
import { readFileSync, writeFileSync } from 'node:fs';
import { init } from './echarts.js';
import { documentOf, looksOf, panelOption } from './options.js';

const WIDTH = 430, HEIGHT = 320, LEGEND = 34, MOST_COLUMNS = 3;

function documentIn(page) {
  const data = /<script id="data" type="application\/json">(.*?)<\/script>/s.exec(page);
  if (!data) throw new Error(`${process.argv[2]}: has no data`);
  return documentOf(data[1]);
}

function panel(document, scene, view, x, y) {
  const chart = init(null, null, { renderer: 'svg', ssr: true, width: WIDTH, height: HEIGHT });
  chart.setOption(panelOption(document, scene, view));
  const svg = chart.renderToSVGString();
  chart.dispose();
  return svg.replace('<svg ', `<svg x="${x}" y="${y}" `);
}

function legend(looks) {
  const shapes = { circle: 'M4 0A4 4 0 1 1 3.99 0Z', rect: 'M0 0H8V8H0Z', triangle: 'M4 0L8 8H0Z', diamond: 'M4 0L8 4L4 8L0 4Z' };
  const entries = [...looks].map(([engine, { color, symbol }], i) =>
    `<g transform="translate(${16 + 110 * i} 13)"><path d="${shapes[symbol] ?? symbol.replace('path://', '')}" fill="${color}"/>` +
    `<text x="14" y="9">${engine}</text></g>`);
  return `<g font-family="sans-serif" font-size="13" fill="#1b1f24">${entries.join('')}` +
    `<text x="${16 + 110 * looks.size}" y="22" fill="#5b6570">ring: default; cross: failed; line: no setting is both cheaper and more accurate</text></g>`;
}

const [, , from, to] = process.argv;
const document = documentIn(readFileSync(from, 'utf8'));
const looks = looksOf(document);
const view = { engines: new Set(looks.keys()), axis: 'error', failures: true, intervals: false, fronts: false, theme: 'light', linked: null };
const columns = Math.min(MOST_COLUMNS, document.scenes.length);
const rows = Math.ceil(document.scenes.length / columns);
const [width, height] = [columns * WIDTH, LEGEND + rows * HEIGHT];
const panels = document.scenes.map((scene, i) => panel(document, scene, view, (i % columns) * WIDTH, LEGEND + Math.floor(i / columns) * HEIGHT));
writeFileSync(to, `<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">` +
  `<rect width="100%" height="100%" fill="#ffffff"/>${legend(looks)}${panels.join('\n')}</svg>\n`);
