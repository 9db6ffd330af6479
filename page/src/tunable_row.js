import { Controller } from 'lil-gui';
import { el } from './dom.js';
import { differs, formatNumber, scaleWith, sliderScale, toPlace, toValue } from './slider_scale.js';

const PLACES = 1000; // of a slider

/**
 * The row of one tunable: name, what changes it, unit, a mark when it is changed and a button back to the default.
 * Unlike lil-gui's own sliders it runs logarithmically where that makes sense, and takes three numbers for a vector.
 */
export class TunableRow extends Controller {
  #tunable;
  #dragging = false;
  #value; // shown: the user's until the program answers
  #scale;
  #send;
  #inputs = [];
  #slider = null;

  /**
   * @param {GUI} folder  @param {Object} tunable as the program declares it
   * @param {{change: function(path, value), reset: function(path)}} send
   */
  constructor(folder, tunable, send) {
    super(folder, tunable, 'value', `tunable-${tunable.kind}`);
    this.#tunable = tunable;
    this.#value = tunable.value;
    this.#send = send;
    this.domElement.dataset.path = tunable.path;
    this.domElement.title = describe(tunable);
    this.name(tunable.label);
    if (tunable.kind === 'number' || tunable.kind === 'integer') this.#makeSlider();
    this.#inputs = this.#makeInputs();
    this.$widget.append(...this.#inputs);
    this.$widget.append(el('span', { class: 'unit' }, tunable.unit === '1' ? '' : (tunable.unit ?? '')));
    this.domElement.append(
      el(
        'button',
        {
          class: 'untune',
          title: 'back to the default',
          'aria-label': 'back to the default',
          onclick: () => send.reset(tunable.path),
        },
        '↺',
      ),
    );
    this.updateDisplay();
  }

  /** Shows the value that the program has. */
  accept() {
    this.#value = this.#tunable.value;
    this.updateDisplay();
  }

  updateDisplay() {
    const value = this.#value;
    this.domElement.classList.toggle('changed', differs(value, this.#tunable.default));
    const values = Array.isArray(value) ? value : [value];
    this.#inputs.forEach((input, i) => {
      if (input === document.activeElement && input.dataset.editing) return;
      if (input.type === 'checkbox') input.checked = Boolean(value);
      else if (input.tagName === 'SELECT') input.value = value ?? '';
      else input.value = formatNumber(values[i]);
    });
    if (this.#slider) this.#showPlace();
    return this;
  }

  #showPlace() {
    if (this.#dragging) return;
    const shown = this.#value ?? this.#tunable.default;
    this.#scale = scaleWith(sliderScale(this.#tunable), shown);
    this.#slider.value = shown === null ? 0 : toPlace(this.#scale, shown) * PLACES;
    this.#showShare();
  }

  #showShare() {
    this.#slider.style.setProperty('--share', this.#slider.value / PLACES);
  }

  #makeSlider() {
    this.#slider = el('input', { type: 'range', min: 0, max: PLACES, step: 'any', 'aria-label': this.#tunable.label });
    this.#slider.addEventListener('input', () => {
      this.#dragging = true;
      this.#showShare();
      this.#change(toValue(this.#scale, this.#slider.value / PLACES));
    });
    this.#slider.addEventListener('change', () => {
      this.#dragging = false;
      this.#showPlace();
    });
    this.$widget.append(this.#slider);
  }

  #makeInputs() {
    const { kind, choices, label, optional } = this.#tunable;
    if (kind === 'bool') {
      const box = el('input', { type: 'checkbox', 'aria-label': label });
      box.addEventListener('change', () => this.#change(box.checked));
      return [box];
    }
    if (kind === 'choice') {
      const select = el('select', { 'aria-label': label });
      if (optional) select.append(new Option('–', ''));
      select.append(...choices.map((choice) => new Option(choice, choice)));
      select.addEventListener('change', () => this.#change(select.value === '' ? null : select.value));
      return [select];
    }
    return Array.from({ length: kind === 'vector' ? 3 : 1 }, () => this.#makeNumber());
  }

  #makeNumber() {
    const { label, optional } = this.#tunable;
    const input = el('input', {
      type: 'text',
      inputmode: 'decimal',
      'aria-label': label,
      placeholder: optional ? 'none' : null,
    });
    const finish = () => {
      if (!input.dataset.editing) return;
      delete input.dataset.editing;
      this.#changeByText();
    };
    input.addEventListener('input', () => {
      input.dataset.editing = 'yes';
    });
    input.addEventListener('change', finish);
    input.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') finish();
      if (event.key === 'Escape') {
        delete input.dataset.editing;
        this.updateDisplay();
      }
    });
    return input;
  }

  #changeByText() {
    const texts = this.#inputs.map((input) => input.value.trim().replace(',', '.'));
    if (this.#tunable.optional && texts.every((text) => text === '')) return this.#change(null);
    const numbers = texts.map(Number);
    if (texts.some((text) => text === '') || numbers.some(Number.isNaN)) return this.updateDisplay();
    return this.#change(this.#tunable.kind === 'vector' ? numbers : numbers[0]);
  }

  #change(value) {
    this.#value = value;
    this.updateDisplay();
    this.#send.change(this.#tunable.path, value);
    return this;
  }
}

function describe({ path, meaning, unit, min, max, default: standard, optional }) {
  const bound = (value) => (value === null || value === undefined ? '∞' : formatNumber(value));
  const numeric = min !== null || max !== null;
  const range = numeric ? `${min === null ? '−∞' : bound(min)} … ${bound(max)} ${unit ?? ''}`.trim() : '';
  const normal = Array.isArray(standard) ? standard.map((item) => formatNumber(item)).join(', ') : standard;
  return [meaning, range && `allowed: ${range}`, `default: ${normal ?? (optional ? 'none' : '–')}`, path]
    .filter(Boolean)
    .join('\n');
}
