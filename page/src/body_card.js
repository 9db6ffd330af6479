import { byId, el, setText } from './dom.js';
import { formatNumber } from './slider_scale.js';

const INTERVAL = 120; // ms
const DEGREES = 180 / Math.PI;

const vector = (value, digits) => value.map((item) => item.toFixed(digits)).join('  ');
const size = (value) => Math.hypot(...value);

/** What is told about a body: name, and the value as text. */
const ROWS = [
  ['mass', ({ mass }) => (mass === undefined || mass === null ? null : `${formatNumber(mass, 4)} kg`)],
  ['state', ({ type, awake }) => (type === undefined ? null : awake === false ? `${type}, asleep` : type)],
  ['position', ({ position }) => position && `${vector(position, 2)} m`],
  ['velocity', ({ velocity }) => velocity && `${vector(velocity, 2)}  =  ${size(velocity).toFixed(2)} m/s`],
  ['spin', ({ spin }) => spin && `${vector(spin, 2)}  =  ${size(spin).toFixed(2)} rad/s`],
  [
    'contacts',
    ({ contacts, contactForce }) =>
      contacts === undefined
        ? null
        : contacts === 0
          ? 'none'
          : `${contacts}, ${contactForce ? `${formatNumber(size(contactForce), 3)} N` : ''}`,
  ],
  ['joint', ({ joint }) => joint && joint.name],
  ['torque', ({ joint }) => joint && `${joint.torque.toFixed(1)} N m`],
];

/** The numbers of the picked body, and where its joint stands between its limits. */
export class BodyCard {
  #session;
  #card = byId('picked');
  #list = byId('picked-values');
  #limits = byId('picked-limits');
  #cells = new Map();
  #due = 0;

  constructor(session) {
    this.#session = session;
    byId('unpick').addEventListener('click', () => session.tell('pick', { node: null }));
    for (const [name] of ROWS) {
      const cell = el('dd', { dataset: { value: name } });
      const row = el('div', {}, el('dt', {}, name), cell);
      this.#cells.set(name, { cell, row });
      this.#list.append(row);
    }
  }

  /** @param {number} now ms */
  update(now) {
    if (now < this.#due) return;
    this.#due = now + INTERVAL;
    const picked = this.#session.telemetry?.picked;
    const shown = Boolean(picked) && this.#session.status?.picked !== null;
    this.#card.hidden = !shown;
    if (!shown) return;
    setText(byId('picked-name'), picked.name || `node ${picked.node}`);
    for (const [name, read] of ROWS) {
      const text = read(picked);
      const { cell, row } = this.#cells.get(name);
      row.hidden = !text;
      if (text) setText(cell, text);
    }
    this.#showLimits(picked.joint?.margins ?? []);
  }

  #showLimits(margins) {
    const limited = margins.filter(
      ({ lower, upper }) => Number.isFinite(lower) && Number.isFinite(upper) && upper > lower,
    );
    while (this.#limits.children.length > limited.length) this.#limits.lastChild.remove();
    while (this.#limits.children.length < limited.length) {
      this.#limits.append(
        el('div', { class: 'limit' }, el('span'), el('div', { class: 'limit-bar' }, el('i')), el('b')),
      );
    }
    limited.forEach(({ axis, value, lower, upper }, i) => {
      const [name, bar, number] = this.#limits.children[i].children;
      setText(name, axis);
      setText(number, `${(value * DEGREES).toFixed(0)}°`);
      bar.title = `${(lower * DEGREES).toFixed(0)}° … ${(upper * DEGREES).toFixed(0)}°`;
      const place = Math.min(Math.max((value - lower) / (upper - lower), 0), 1);
      bar.firstChild.style.left = `${place * 100}%`;
      bar.classList.toggle('beyond', value < lower || value > upper);
    });
  }
}
