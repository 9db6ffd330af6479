import uPlot from 'uplot';
import { byId, el, setText } from './dom.js';
import { History } from './history.js';
import { jointPlots, solverPlots, vehiclePlots } from './plot_list.js';

const SPAN = 10; // s shown
const INTERVAL = 100; // ms between drawings
const HEIGHT = 58; // px
const AXIS = { stroke: '#8a94a3', font: '10px system-ui, sans-serif', size: 38, gap: 3, ticks: { show: false } };
const GRID = { stroke: '#2a303a', width: 1 };

/** One plot: a line of names and values over the curves. */
class Plot {
  #definition;
  #history;
  #chart;
  #values;
  element;

  constructor(definition, width) {
    this.#definition = definition;
    this.#history = new History(
      SPAN,
      definition.series.map(({ read }) => read),
    );
    this.#values = definition.series.map(() => el('b'));
    const single = definition.series.length === 1;
    const legend = definition.series.map(({ label, color }, i) => {
      this.#values[i].style.color = color;
      return el('span', {}, single ? null : `${label} `, this.#values[i]);
    });
    this.element = el(
      'figure',
      { class: definition.half ? 'plot half' : 'plot', dataset: { plot: definition.id } },
      el('figcaption', {}, el('strong', {}, definition.title), ...legend, el('i', {}, definition.unit)),
    );
    this.#chart = new uPlot(this.#options(width), this.#history.columns, this.element);
  }

  add(message) {
    this.#history.add(message);
  }

  clear() {
    this.#history.clear();
  }

  resize(width) {
    this.#chart.setSize({ width: this.#widthIn(width), height: this.#height });
  }

  get half() {
    return Boolean(this.#definition.half);
  }

  draw(now) {
    this.#chart.setData(this.#history.columns, false);
    this.#chart.setScale('x', { min: now - SPAN, max: now });
    this.#showValues();
  }

  destroy() {
    this.#chart.destroy();
    this.element.remove();
  }

  get #height() {
    return this.#definition.tall ? 1.6 * HEIGHT : HEIGHT;
  }

  #widthIn(width) {
    return this.#definition.half ? Math.floor(width / 2) : width;
  }

  #options(width) {
    const { series, steps } = this.#definition;
    return {
      width: this.#widthIn(width),
      height: this.#height,
      legend: { show: false },
      padding: [7, 4, 7, 0],
      cursor: { sync: { key: 'plots' }, y: false, points: { show: false }, drag: { x: false, y: false } },
      hooks: { setCursor: [() => this.#showValues()] },
      scales: { x: { time: false }, y: { range: (_, low, high) => this.#range(low, high) } },
      axes: [
        { show: false },
        {
          ...AXIS,
          grid: GRID,
          splits: (_, i, low, high) => [low, low < 0 ? 0 : high / 2, high],
          values: (_, splits) => formatTicks(splits),
        },
      ],
      series: [
        {},
        ...series.map(({ color }) => ({
          stroke: color,
          width: 1.25,
          points: { show: false },
          paths: steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
        })),
      ],
    };
  }

  /** From below to above zero, or from zero up, to round numbers. */
  #range(low, high) {
    const { digits, ceiling = 10 ** (1 - digits), span, clip = Infinity } = this.#definition;
    const lower = low ?? 0;
    const upper = Math.max(high ?? 0, ceiling);
    if (span) {
      const reach = niceAbove(Math.min(Math.max(-lower, upper, span), clip));
      return [-reach, reach];
    }
    return [lower < -0.02 * upper ? -niceAbove(Math.max(-lower, upper / 10)) : 0, niceAbove(upper)];
  }

  #showValues() {
    const { columns } = this.#history;
    const index = this.#chart?.cursor.idx ?? columns[0].length - 1;
    this.#values.forEach((element, i) => {
      const value = columns[i + 1][index] ?? null;
      setText(element, value === null ? '–' : value.toFixed(this.#definition.digits));
    });
  }
}

/** The stack of plots that fit the scene and the picked body. */
export class Plots {
  #box = byId('plots');
  #session;
  #driving;
  #groups = new Map(); // name → {key, plots}
  #due = 0;
  #fresh = false;

  constructor(session, driving) {
    this.#session = session;
    this.#driving = driving;
    session.on('scene', () => this.#forget());
    session.on('telemetry', (message) => this.#take(message));
    if (session.telemetry) this.#take(session.telemetry);
    new ResizeObserver(() => this.#each((plot) => plot.resize(this.#width))).observe(this.#box);
  }

  /** Draws what is new, a few times a second. @param {number} now ms */
  update(now) {
    if (!this.#fresh || now < this.#due || this.#box.offsetParent === null) return;
    this.#due = now + INTERVAL;
    this.#fresh = false;
    const { time } = this.#session.telemetry;
    this.#each((plot) => plot.draw(time));
  }

  get #width() {
    return Math.max(this.#box.clientWidth, 120);
  }

  #each(act) {
    for (const { plots } of this.#groups.values()) plots.forEach(act);
  }

  #take(message) {
    const { vehicle, vehicles } = this.#driving;
    const { picked, stages = [] } = message;
    const wheels = vehicles[vehicle]?.wheels.map((node) => this.#wheelName(node, vehicles[vehicle].name)) ?? [];
    const joint = picked?.joint;
    this.#setGroup('joint', joint ? `${picked.node} ${joint.name}` : '', () => jointPlots(picked));
    this.#setGroup('car', message.vehicles?.[vehicle] ? `${vehicle} ${wheels}` : '', () =>
      vehiclePlots(vehicle, wheels),
    );
    const names = stages.map(({ name }) => name);
    if (names.length > 0) this.#setGroup('solver', names.join(), () => solverPlots(names));
    this.#each((plot) => plot.add(message));
    this.#fresh = true;
  }

  /** The group has the plots that belong to the key; the empty key is none. */
  #setGroup(name, key, list) {
    const group = this.#groups.get(name);
    if ((group?.key ?? '') === key) return;
    group?.plots.forEach((plot) => plot.destroy());
    this.#groups.set(name, {
      key,
      plots: key === '' ? [] : list().map((definition) => new Plot(definition, this.#width)),
    });
    const all = ['joint', 'car', 'solver'].flatMap((each) => this.#groups.get(each)?.plots ?? []);
    // Halves stand side by side, so they come first.
    this.#box.append(
      ...[...all.filter(({ half }) => half), ...all.filter(({ half }) => !half)].map(({ element }) => element),
    );
  }

  /** The name of a wheel's node without that of its car. */
  #wheelName(node, car) {
    const name = this.#session.scene.nodes.find((each) => each.node === node)?.name ?? '';
    return name.startsWith(`${car} `) ? name.slice(car.length + 1) : name;
  }

  #forget() {
    this.#each((plot) => plot.clear());
    this.#fresh = this.#session.telemetry !== null;
  }
}

/** The next of 1, 2, 3, 5 times a power of ten. */
function niceAbove(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 3, 5, 10].find((factor) => factor * decade >= value * 0.9999) * decade;
}

/** Labels of the lowest, middle and highest tick; the lowest has none where it would touch the middle one. */
function formatTicks([low, middle, high]) {
  const extent = high - low;
  const digits = extent >= 10 ? 0 : extent >= 1 ? 1 : 3;
  const label = (value) => (extent >= 4000 ? `${value / 1000}k` : String(Number(value.toFixed(digits))));
  return [middle - low < 0.25 * extent ? '' : label(low), label(middle), label(high)];
}
