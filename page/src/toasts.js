import { byId, el } from './dom.js';

const SHORT = 5000; // ms
const LONG = 15000;
const MOST = 4;

/** Short messages at the edge of the view. */
export class Toasts {
  #box = byId('toasts');
  #shown = new Map();

  /**
   * Shows a message; one of the same key is replaced. A click takes it away.
   * @param {'info'|'good'|'error'} kind  @param {string} text  @param {{key?: string, stay?: boolean}} options
   */
  show(kind, text, { key = text, stay = false } = {}) {
    this.dismiss(key);
    const toast = el(
      'div',
      { class: `toast ${kind}`, role: kind === 'error' ? 'alert' : 'status', onclick: () => this.dismiss(key) },
      text,
    );
    const timer = stay ? null : setTimeout(() => this.dismiss(key), kind === 'error' ? LONG : SHORT);
    this.#shown.set(key, { toast, timer });
    this.#box.append(toast);
    while (this.#shown.size > MOST) this.dismiss(this.#shown.keys().next().value);
  }

  dismiss(key) {
    const entry = this.#shown.get(key);
    if (!entry) return;
    clearTimeout(entry.timer);
    entry.toast.remove();
    this.#shown.delete(key);
  }
}
