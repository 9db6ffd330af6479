import { GUI } from 'lil-gui';
import { byId, setText } from './dom.js';
import { differs } from './slider_scale.js';
import { findTunables, groupTree } from './tunable_groups.js';
import { TunableRow } from './tunable_row.js';

const INTERVAL = 50; // ms between two values of one slider
const MOST_FOUND = 60; // rows that a filter shows

/** Sliders for all that can be tuned, in the folders that the program groups them in. */
export class Tuning {
  #session;
  #toasts;
  #gui = null;
  #rows = new Map(); // path → the row that shows it, where it has been made
  #pending = new Map(); // path → value to send
  #underWay = new Map(); // path → values sent without answer yet
  #filter = byId('tuning-filter');
  #name = byId('tuning-name');

  constructor(session, toasts) {
    this.#session = session;
    this.#toasts = toasts;
    session.on('scene', () => this.#build());
    session.on('tunables', (message) => (message.tunables ? this.#build() : this.#refresh(message.values)));
    this.#filter.addEventListener('input', () => this.#build());
    byId('tuning-save').addEventListener('click', () => this.#save());
    byId('tuning-load').addEventListener('click', () => this.#load());
    byId('tuning-reset').addEventListener('click', () => this.#resetAll());
    setInterval(() => this.#flush(), INTERVAL);
    if (session.scene) this.#build();
  }

  #build() {
    this.#gui?.destroy();
    this.#rows.clear();
    this.#gui = new GUI({ container: byId('tuning'), autoPlace: false, title: '', injectStyles: false });
    this.#gui.$title.remove();
    const words = this.#filter.value.trim();
    if (words !== '') this.#buildFound(words);
    else this.#fill(this.#gui, groupTree(this.#session.tunables));
    this.#countChanged();
  }

  /** Rows are made when their folder opens: a scene may have thousands. */
  #fill(folder, tree) {
    for (const tunable of tree.tunables) this.#addRow(folder, tunable);
    for (const [title, branch] of tree.branches) {
      const inner = folder.addFolder(title).close();
      inner.onOpenClose((changed) => {
        if (changed === inner && !inner._closed && inner.children.length === 0) this.#fill(inner, branch);
      });
    }
  }

  #buildFound(words) {
    const found = findTunables(this.#session.tunables, words);
    const byGroup = new Map();
    for (const tunable of found.slice(0, MOST_FOUND)) {
      if (!byGroup.has(tunable.group)) byGroup.set(tunable.group, this.#gui.addFolder(tunable.group));
      this.#addRow(byGroup.get(tunable.group), tunable);
    }
    if (found.length > MOST_FOUND) this.#gui.addFolder(`… and ${found.length - MOST_FOUND} more`).close();
    if (found.length === 0) this.#gui.addFolder('nothing found').close();
  }

  #addRow(folder, tunable) {
    const row = new TunableRow(folder, tunable, {
      change: (path, value) => this.#pending.set(path, value),
      reset: (path) => {
        this.#pending.delete(path);
        this.#session.tell('untune', { path });
      },
    });
    this.#rows.set(tunable.path, row);
  }

  #flush() {
    for (const [path, value] of this.#pending) this.#tune(path, value);
    this.#pending.clear();
  }

  /** Sends a value; in the end the row shows what the program has made of it, or has kept. */
  async #tune(path, value) {
    this.#underWay.set(path, (this.#underWay.get(path) ?? 0) + 1);
    try {
      const answer = await this.#session.ask('tune', { path, value });
      this.#session.setTunable(path, answer.value ?? value);
    } catch (error) {
      this.#toasts.show('error', error.message, { key: `tune ${path}` });
    }
    this.#underWay.set(path, this.#underWay.get(path) - 1);
    this.#refresh([{ path }]);
  }

  /** Shows the program's values, but not in a row whose slider is moving on already. */
  #refresh(values) {
    for (const { path } of values) {
      if (!this.#pending.has(path) && !this.#underWay.get(path)) this.#rows.get(path)?.accept();
    }
    this.#countChanged();
  }

  #countChanged() {
    const count = this.#session.tunables.filter(({ value, default: standard }) => differs(value, standard)).length;
    setText(byId('tuning-count'), count === 0 ? 'nothing changed' : `${count} changed`);
    byId('tuning-reset').disabled = byId('tuning-save').disabled = count === 0;
  }

  #resetAll() {
    for (const { path, value, default: standard } of this.#session.tunables) {
      if (differs(value, standard)) this.#session.tell('untune', { path });
    }
  }

  async #save() {
    try {
      const name = this.#name.value.trim();
      const { file } = await this.#session.ask('saveTuning', name ? { name } : {});
      this.#toasts.show('good', `Saved as ${file}`, { key: 'tuning' });
    } catch (error) {
      this.#toasts.show('error', error.message, { key: 'tuning' });
    }
  }

  async #load() {
    try {
      await this.#session.ask('loadTuning', { name: this.#name.value.trim() });
      this.#toasts.show('good', 'Loaded', { key: 'tuning' });
    } catch (error) {
      this.#toasts.show('error', error.message, { key: 'tuning' });
    }
  }
}
