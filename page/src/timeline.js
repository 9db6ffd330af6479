import { byId, setText } from './dom.js';

const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4];

/** The bar at the bottom: play, pause, step, scrub, speed, for the program or for a recording. */
export class Timeline {
  #player = null;
  #leave = null;
  #scrub = byId('scrub');
  #speed = byId('speed');
  #scrubbing = false;

  constructor() {
    byId('play').addEventListener('click', () => this.playOrPause());
    byId('back').addEventListener('click', () => this.#player?.step(-1));
    byId('step').addEventListener('click', () => this.#player?.step(1));
    byId('reset').addEventListener('click', () => this.#player?.reset());
    this.#speed.append(...SPEEDS.map((factor) => new Option(`${factor} ×`, factor)));
    this.#speed.addEventListener('change', () => {
      this.#player?.setSpeed(Number(this.#speed.value));
      this.#speed.blur(); // keys are for the scene again
    });
    this.#scrub.addEventListener('input', () => {
      this.#scrubbing = true;
      this.#player?.seek(Number(this.#scrub.value));
    });
    for (const event of ['change', 'pointerup'])
      this.#scrub.addEventListener(event, () => {
        this.#scrubbing = false;
      });
  }

  get player() {
    return this.#player;
  }

  /** From now on shows and moves this player. */
  set player(player) {
    this.#leave?.();
    this.#player = player;
    this.#leave = player.on('change', () => this.update());
    this.update();
  }

  playOrPause() {
    if (this.#player?.state.playing) this.#player.pause();
    else this.#player?.play();
  }

  /** To the next of the speeds on offer, −1 slower or 1 faster. */
  changeSpeed(by) {
    const now = this.#player?.state.speed ?? 1;
    const next = by > 0 ? SPEEDS.find((factor) => factor > now) : SPEEDS.findLast((factor) => factor < now);
    if (next !== undefined) this.#player?.setSpeed(next);
  }

  update() {
    const { counts, playing, first, last, at, time, unit, speed, realTimeFactor } = this.#player.state;
    const play = byId('play');
    play.classList.toggle('playing', playing);
    play.setAttribute('aria-label', playing ? 'pause' : 'play');
    play.title = playing ? 'pause (P)' : 'play (P)';
    this.#scrub.min = first;
    this.#scrub.max = Math.max(last, first);
    this.#scrub.step = counts === 'step' ? 1 : 'any';
    if (!this.#scrubbing) this.#scrub.value = at;
    this.#scrub.style.setProperty('--share', last > first ? (at - first) / (last - first) : 0);
    setText(byId('time'), `${time.toFixed(2)} s`);
    setText(byId('step-count'), `${counts} ${counts === 'step' ? at : Math.round(at / unit)}`);
    this.#showSpeed(speed);
    setText(byId('real-time'), realTimeFactor === null || !playing ? '' : `${realTimeFactor.toFixed(2)} × real time`);
  }

  #showSpeed(speed) {
    if (document.activeElement === this.#speed) return;
    const known = SPEEDS.includes(speed);
    const own = this.#speed.querySelector('[data-own]');
    if (known) own?.remove();
    else if (own) Object.assign(own, { value: speed, textContent: `${speed} ×` });
    else {
      const option = new Option(`${speed} ×`, speed);
      option.dataset.own = '';
      this.#speed.append(option);
    }
    this.#speed.value = speed;
  }
}
