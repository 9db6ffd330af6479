/** From keys and sticks to what a driver does: throttle, brake, handbrake 0 … 1, steer −1 … 1 to the right, and a gear. */

const PRESS_RATE = 3; // 1/s, of a pedal or the wheel under a key
const RELEASE_RATE = 6;
const STANDING = 0.7; // m/s; below it the brake key changes to reverse
const DEAD_ZONE = 0.12;

/** @typedef {{throttle: number, brake: number, steer: number, handbrake: number}} Wish */

export const NO_WISH = Object.freeze({ throttle: 0, brake: 0, steer: 0, handbrake: 0 });

/** What the keys held down ask for. @param {Set<string>} held codes of keys  @returns {Wish} */
export function wishOfKeys(held) {
  const any = (...codes) => (codes.some((code) => held.has(code)) ? 1 : 0);
  return {
    throttle: any('KeyW', 'ArrowUp'),
    brake: any('KeyS', 'ArrowDown'),
    steer: any('KeyD', 'ArrowRight') - any('KeyA', 'ArrowLeft'),
    handbrake: any('Space'),
  };
}

/** What a gamepad of the standard mapping asks for. @returns {Wish} */
export function wishOfGamepad(pad) {
  const stick = pad.axes[0] ?? 0;
  const beyond = Math.max(Math.abs(stick) - DEAD_ZONE, 0) / (1 - DEAD_ZONE);
  const button = (index) => pad.buttons[index]?.value ?? 0;
  return { throttle: button(7), brake: button(6), steer: Math.sign(stick) * beyond, handbrake: button(0) };
}

/** The stronger of two wishes in each part. */
export function strongest(a, b) {
  const larger = (name) => (Math.abs(b[name]) > Math.abs(a[name]) ? b[name] : a[name]);
  return {
    throttle: larger('throttle'),
    brake: larger('brake'),
    steer: larger('steer'),
    handbrake: larger('handbrake'),
  };
}

/**
 * Turns wishes into inputs: keys press pedals in time rather than at once, and with the automatic gear the brake drives
 * backwards once the car stands, as in every game.
 */
export class Driver {
  #input = { ...NO_WISH };
  #reversing = false;
  gear = null; // null: automatic

  /** @param {Wish} wish  @param {number} speed m/s forward  @param {number} elapsed s since the last call */
  update(wish, speed, elapsed) {
    if (this.gear === null) this.#chooseDirection(wish, speed);
    const reversing = this.gear === null && this.#reversing;
    const pedals = reversing ? { ...wish, throttle: wish.brake, brake: wish.throttle } : wish;
    for (const name of Object.keys(NO_WISH)) this.#input[name] = approach(this.#input[name], pedals[name], elapsed);
    return { ...this.#input, gear: reversing ? -1 : this.gear };
  }

  /** One gear up or down from what the car is in; leaves the automatic. */
  shift(current, by) {
    this.gear = Math.max(current + by, -1);
  }

  #chooseDirection(wish, speed) {
    if (wish.brake > 0 && wish.throttle === 0 && speed < STANDING) this.#reversing = true;
    if (wish.throttle > 0 && wish.brake === 0 && speed > -STANDING) this.#reversing = false;
  }
}

function approach(from, to, elapsed) {
  const away = Math.abs(to) > Math.abs(from) || to * from < 0;
  const most = (away ? PRESS_RATE : RELEASE_RATE) * elapsed;
  return from + Math.min(Math.max(to - from, -most), most);
}
