// The page of a chart: panels of scenes that are filtered together, and what is under the pointer.
import { init } from './echarts.js';
import { documentOf, looksOf, panelOption, placesOf, profileOption } from './options.js';

const document_ = documentOf(document.getElementById('data').textContent);
const filters = document.getElementById('filters');
const card = document.getElementById('card');
const looks = looksOf(document_);
const dark = matchMedia('(prefers-color-scheme: dark)');
let theme = dark.matches ? 'dark' : 'light';
let linked = null;
let panels = [];
let draws = 0;

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function swatch({ color, symbol }) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 8 8');
  svg.setAttribute('class', 'swatch');
  const path = document.createElementNS(svg.namespaceURI, 'path');
  const shapes = { circle: 'M4 0A4 4 0 1 1 3.99 0Z', rect: 'M0 0H8V8H0Z', triangle: 'M4 0L8 8H0Z', diamond: 'M4 0L8 4L4 8L0 4Z' };
  path.setAttribute('d', shapes[symbol] ?? symbol.replace('path://', ''));
  path.setAttribute('fill', color);
  svg.append(path);
  return svg;
}

function view() {
  const form = new FormData(filters);
  return {
    engines: new Set(form.getAll('engine')),
    axis: form.get('axis'),
    failures: form.has('failures'),
    intervals: form.has('intervals'),
    fronts: form.has('fronts'),
    scene: form.get('scene'),
    theme,
    linked,
  };
}

function number(value, unit = '') {
  return value === null ? '–' : `${+value.toPrecision(4)} ${unit}`.trim();
}

function interval(low, high, unit) {
  return low === null ? '–' : low === high ? number(low, unit) : `${number(low)} to ${number(high, unit)}`;
}

function facts(point) {
  const rows = {
    step: `1/${Math.round(1 / point.step)} s`,
    substeps: point.substeps,
    iterations: point.iterations || '–',
    error: `${number(point.error)} (${interval(point.errorLow, point.errorHigh)})`,
    'against own limit': number(point.consistency),
    [point.quantity]: `${number(point.value, point.unit)}, should be ${number(point.reference, point.unit)}`,
    time: `${number(point.ms)} ms/s (${interval(point.msLow, point.msHigh)})${point.alone ? '' : ', does not count'}`,
    contacts: `${number(point.contacts)} a step, ${number(point.passes)} passes`,
  };
  if (point.outcome === 'failed')
    rows.failed = `${point.reason}${point.failedAt === null ? '' : `, after ${number(point.failedAt, 's')}`}`;
  return Object.entries(rows).flatMap(([name, value]) => [element('dt', { textContent: name }), element('dd', { textContent: value })]);
}

function show(point) {
  card.querySelector('h2').textContent = `${point.variant} ${point.version}${point.standard ? ', its default' : ''}`;
  card.querySelector('dl').replaceChildren(...facts(point));
  card.querySelector('code').textContent = point.command;
  card.hidden = false;
}

function draw() {
  ++draws;
  const now = view();
  document.getElementById('panels').classList.toggle('single', now.scene !== '');
  for (const { scene, chart, box } of panels) {
    box.hidden = now.scene !== '' && now.scene !== scene.name;
    if (box.hidden) continue;
    chart.resize();
    chart.setOption(panelOption(document_, scene, now), { notMerge: true });
  }
  profile.setOption(profileOption(document_, now), { notMerge: true });
}

function link(variant) {
  if (variant === linked) return;
  linked = variant;
  requestAnimationFrame(draw);
}

function makePanels() {
  panels = document_.scenes.map((scene) => {
    const box = element('div', { className: 'panel' });
    box.dataset.scene = scene.name;
    document.getElementById('panels').append(box);
    const chart = init(box, null, { renderer: 'canvas' });
    const pointOf = ({ data }) => document_.points[data?.index];
    chart.on('mouseover', (event) => { if (pointOf(event)) show(pointOf(event)); });
    chart.on('click', (event) => { if (pointOf(event)) link(pointOf(event).variant); });
    chart.getZr().on('click', ({ target }) => { if (!target) link(null); });
    return { scene, chart, box };
  });
}

function makeFilters() {
  const engines = document.getElementById('engines');
  for (const [engine, look] of looks) {
    const box = element('input', { type: 'checkbox', name: 'engine', value: engine, checked: true });
    engines.append(element('label', {}, box, ' ', swatch(look), ` ${engine}`));
  }
  const scenes = filters.elements.scene;
  for (const { name, title } of document_.scenes) scenes.append(element('option', { value: name, textContent: title }));
  filters.addEventListener('input', draw);
}

function setTheme(name) {
  theme = name;
  document.documentElement.style.colorScheme = name;
  draw();
}

function cheapestTable() {
  const { engines, rows } = document_.cheapest;
  const head = ['Scene', 'Error', ...engines].map((text) => element('th', { textContent: text }));
  const titles = new Map(document_.scenes.map(({ name, title }) => [name, title]));
  const body = rows.map(({ scene, error, points }) => {
    const times = points.map((index) => index === null ? Infinity : document_.points[index].ms);
    const cells = points.map((index, i) => {
      if (index === null) return element('td', { textContent: '–' });
      const point = document_.points[index];
      const setting = `${point.variant}, ${Math.round(1 / point.step)} Hz × ${point.substeps}${point.iterations ? `, ${point.iterations} it.` : ''}`;
      return element('td', { className: times[i] === Math.min(...times) ? 'best' : '' }, number(point.ms), element('small', { textContent: setting }));
    });
    return element('tr', {}, element('td', { textContent: titles.get(scene) }), element('td', { textContent: number(error) }), ...cells);
  });
  document.getElementById('cheapest').append(element('thead', {}, element('tr', {}, ...head)), element('tbody', {}, ...body));
}

makeFilters();
makePanels();
const profile = init(document.getElementById('profile'), null, { renderer: 'canvas' });
cheapestTable();
card.querySelector('button').addEventListener('click', () => navigator.clipboard?.writeText(card.querySelector('code').textContent));
document.getElementById('theme').addEventListener('click', () => setTheme(theme === 'dark' ? 'light' : 'dark'));
dark.addEventListener('change', () => setTheme(dark.matches ? 'dark' : 'light'));
addEventListener('resize', draw);
setTheme(theme);

/** For tests: where a point is in the window, how many marks are drawn, and how often all was drawn. */
window.ragtop = {
  ready: Promise.resolve(),
  place(index) {
    const { scene, chart, box } = panels.find((panel) => panel.scene.name === document_.points[index].scene);
    box.scrollIntoView({ block: 'center' });
    const { places } = placesOf(document_, scene, view());
    const { x, y } = places.find((place) => place.index === index);
    const [left, top] = chart.convertToPixel({ gridIndex: 0 }, [x, y]);
    const corner = box.getBoundingClientRect();
    return [corner.left + left, corner.top + top];
  },
  marks: () => panels.reduce((sum, { chart }) => sum + chart.getOption().series
    .filter(({ type, silent }) => type === 'scatter' && !silent).reduce((marks, { data }) => marks + data.length, 0), 0),
  get draws() { return draws; },
  points: document_.points,
};
