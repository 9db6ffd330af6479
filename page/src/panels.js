import { byId, el, setText } from './dom.js';

const NARROW = 900; // px; below it one panel at a time, and none at first

/** The panels left and right of the view, and the tabs of the right one. */
export class Panels {
  #sides = ['left', 'right'].map((name) => ({ panel: byId(name), button: byId(`toggle-${name}`) }));

  constructor() {
    for (const side of this.#sides) {
      this.#open(side, window.innerWidth >= NARROW);
      side.button.addEventListener('click', () => this.#toggle(side));
    }
    for (const tab of document.querySelectorAll('[role=tab]'))
      tab.addEventListener('click', () => this.show(tab.dataset.tab));
  }

  /** Hides both, or shows them again. */
  toggleAll() {
    const open = this.#sides.every(({ panel }) => panel.hidden);
    for (const side of this.#sides) this.#open(side, open && (window.innerWidth >= NARROW || side === this.#sides[1]));
  }

  /** Brings a tab of the right panel to the front. */
  show(name) {
    for (const tab of document.querySelectorAll('[role=tab]')) {
      tab.setAttribute('aria-selected', String(tab.dataset.tab === name));
      byId(`tab-${tab.dataset.tab}`).hidden = tab.dataset.tab !== name;
    }
  }

  #toggle(side) {
    const open = side.panel.hidden;
    if (open && window.innerWidth < NARROW) this.#sides.forEach((each) => this.#open(each, false));
    this.#open(side, open);
  }

  #open({ panel, button }, open) {
    panel.hidden = !open;
    button.setAttribute('aria-pressed', String(open));
  }
}

/** The list of scenes; a click loads one. */
export function listScenes(session) {
  const list = byId('scenes');
  session.on('hello', ({ scenes }) => {
    list.replaceChildren(
      ...scenes.map(({ name, description }) =>
        el(
          'button',
          {
            dataset: { scene: name },
            title: description,
            onclick: () => session.tell('load', { scene: name }),
          },
          el('b', {}, name),
          el('span', {}, description),
        ),
      ),
    );
  });
  session.on('scene', ({ name }) => {
    for (const button of list.children) button.setAttribute('aria-current', String(button.dataset.scene === name));
  });
}

/** What debug drawing can show, and what the reader sees of it. */
const SHOWN = [
  ['contacts', 'contacts and their forces'],
  ['joints', 'joints and their limits'],
  ['bounds', 'bounding boxes'],
  ['centers', 'centres of mass'],
  ['islands', 'islands and sleep as colours'],
  ['wheels', 'forces and slip of wheels'],
  ['skeleton', 'bones'],
  ['shapes', 'collision shapes instead of skins'],
];

/** Switches for debug drawing. */
export function listSwitches(session) {
  const boxes = new Map(
    SHOWN.map(([name, meaning]) => {
      const box = el('input', {
        type: 'checkbox',
        dataset: { show: name },
        onchange: () => session.tell('show', { [name]: box.checked }),
      });
      byId('show').append(el('label', { title: meaning }, box, el('span', {}, name)));
      return [name, box];
    }),
  );
  session.on('status', ({ show = {} }) => {
    for (const [name, box] of boxes) box.checked = Boolean(show[name]);
  });
}

/** How many bodies there are, and whether the program is there. */
export function showCounts(session) {
  session.on('status', ({ bodies, awake, contacts }) => {
    setText(
      byId('counts'),
      `${bodies.toLocaleString('en')} bodies · ${awake.toLocaleString('en')} awake · ${contacts.toLocaleString('en')} contacts`,
    );
  });
  session.on('connected', (connected) => byId('connection').classList.toggle('connected', connected));
}
