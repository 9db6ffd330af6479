import { Emitter } from './emitter.js';

/** The running program, as the timeline sees it: places are steps, `unit` is the time of one, s. */
export class LivePlayer extends Emitter {
  #session;
  #step = 0;
  #time = 0;
  #seeking = false; // one seek is under way; the latest wish waits
  #wanted = null;

  constructor(session) {
    super();
    this.#session = session;
    session.on('poses', ({ step, time }) => this.#moveTo(step, time));
    session.on('status', ({ step, time }) => this.#moveTo(step, time));
  }

  get state() {
    const status = this.#session.status;
    return {
      counts: 'step',
      playing: status?.playing ?? false,
      first: status?.first ?? 0,
      last: Math.max(status?.last ?? 0, this.#step),
      at: this.#step,
      time: this.#time,
      unit: this.#session.scene?.dt ?? 1 / 60,
      speed: status?.speed ?? 1,
      realTimeFactor: status?.realTimeFactor ?? null,
    };
  }

  play() {
    this.#session.tell('play');
  }

  pause() {
    this.#session.tell('pause');
  }

  step(count) {
    this.#session.tell('step', { count });
  }

  reset() {
    this.#session.tell('reset');
  }

  setSpeed(factor) {
    this.#session.tell('speed', { factor });
  }

  async seek(step) {
    this.#wanted = Math.round(step);
    if (this.#seeking) return;
    this.#seeking = true;
    while (this.#wanted !== null) {
      const next = this.#wanted;
      this.#wanted = null;
      await this.#session.tell('seek', { step: next });
    }
    this.#seeking = false;
  }

  #moveTo(step, time) {
    this.#step = step;
    this.#time = time;
    this.emit('change');
  }
}
