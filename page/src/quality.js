/**
 * Steps from the finest picture to the one that any machine draws: pixels per CSS pixel, relative to the screen's, the
 * size of the shadow map (0: no shadow), and in how many pictures shadows move once.
 */
export const LEVELS = [
  { ratio: 1, shadow: 2048, every: 1 },
  { ratio: 1, shadow: 1024, every: 1 },
  { ratio: 0.8, shadow: 1024, every: 2 },
  { ratio: 0.66, shadow: 512, every: 3 },
  { ratio: 0.5, shadow: 512, every: 4 },
  { ratio: 0.5, shadow: 0, every: 1 },
];

const SLOW = 45; // ms per frame: below 22 a second motion breaks up
const FAST = 20; // ms per frame
const WARM_UP = 5; // frames in which shaders are still made
const SLOW_TIME = 600; // ms of slow pictures, and so many of them, before a step down
const SLOW_FRAMES = 3;
const FAST_FRAMES = 240; // before a step up; twice as many after each step down
const MOST_FRAMES = 8000;

/** Chooses the level from the times between frames that follow each other. */
export class Quality {
  #sum = 0;
  #count = -WARM_UP;
  #patience = FAST_FRAMES;

  constructor(level = 0) {
    this.level = level;
  }

  /** Takes the time since the frame before, ms; true when the level has changed. */
  frame(elapsed) {
    if (++this.#count <= 0) return false;
    this.#sum += elapsed;
    const mean = this.#sum / this.#count;
    if (this.#count >= SLOW_FRAMES && this.#sum >= SLOW_TIME && mean > SLOW) {
      this.#patience = Math.min(2 * this.#patience, MOST_FRAMES);
      return this.#moveTo(this.level + (mean > 3 * SLOW ? 2 : 1));
    }
    if (this.#count < this.#patience) return false;
    return this.#moveTo(mean < FAST ? this.level - 1 : this.level);
  }

  #moveTo(level) {
    const before = this.level;
    this.#sum = this.#count = 0;
    this.level = Math.min(Math.max(level, 0), LEVELS.length - 1);
    return this.level !== before;
  }
}
