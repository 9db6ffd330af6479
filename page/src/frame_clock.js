const FAST = 25; // ms; frames that follow each other faster are shown as they come
const SLOW = 400; // ms; a longer gap is a pause, not slow motion

/** When frames come slowly, as in slow motion, tells how far between the two last ones the picture should be. */
export class FrameClock {
  #arrived = -Infinity;
  #gap = 0;

  /** A frame has come. @param {number} now ms  @param {boolean} follows is it the next of a running scene? */
  receive(now, follows) {
    this.#gap = follows ? now - this.#arrived : 0;
    this.#arrived = now;
  }

  /** Place between the frame before the last, 0, and the last one, 1. */
  place(now) {
    if (this.#gap < FAST || this.#gap > SLOW) return 1;
    return Math.min((now - this.#arrived) / this.#gap, 1);
  }
}
