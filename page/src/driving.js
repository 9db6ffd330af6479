import { Driver, NO_WISH, strongest, wishOfGamepad, wishOfKeys } from './driver.js';

const INTERVAL = 33; // ms between two looks at keys and gamepad
const LONGEST = 0.5; // s; a page that was away does not jump
const GRAIN = 0.01; // an input that changes less is not sent
const PAD = { shiftDown: 4, shiftUp: 5, reset: 3 }; // buttons of the standard mapping

/** Drives a vehicle of the scene with keyboard and gamepad. */
export class Driving {
  #session;
  #held = new Set();
  #driver = new Driver();
  #sent = { ...NO_WISH, gear: null };
  #before = performance.now();
  #padBefore = [];
  active = false; // has this page taken the wheel?
  vehicle = 0;
  onTakeover = () => {}; // called when this page takes the wheel

  constructor(session) {
    this.#session = session;
    session.on('scene', () => this.#forget());
    window.addEventListener('blur', () => this.#held.clear());
    setInterval(() => this.#update(), INTERVAL);
  }

  get vehicles() {
    return this.#session.scene?.vehicles ?? [];
  }

  get telemetry() {
    return this.#session.telemetry?.vehicles?.[this.vehicle] ?? null;
  }

  /** Node of the driven car's chassis, if the scene has a car. */
  get chassis() {
    return this.vehicles[this.vehicle]?.chassis ?? null;
  }

  get automatic() {
    return this.#driver.gear === null;
  }

  hold(code) {
    this.#held.add(code);
  }

  letGo(code) {
    this.#held.delete(code);
  }

  nextVehicle() {
    if (this.vehicles.length > 0) this.vehicle = (this.vehicle + 1) % this.vehicles.length;
  }

  shift(by) {
    this.#driver.shift(this.telemetry?.gear ?? 0, by);
    this.#takeOver();
  }

  shiftAutomatically() {
    this.#driver.gear = null;
  }

  resetVehicle() {
    if (this.vehicles.length > 0) this.#session.tell('resetVehicle', { vehicle: this.vehicle });
  }

  /** Reads the gamepad and sends what has changed. By a timer: the wheel must not wait for slow pictures. */
  #update() {
    const now = performance.now();
    const elapsed = Math.min((now - this.#before) / 1000, LONGEST);
    this.#before = now;
    if (this.vehicles.length === 0) return;
    const wish = strongest(wishOfKeys(this.#held), this.#readGamepad());
    const wanted = Object.values(wish).some((value) => value !== 0);
    if (!this.active && !wanted) return;
    this.#takeOver();
    const input = this.#driver.update(wish, this.telemetry?.speed ?? 0, elapsed);
    if (!this.#isNew(input)) return;
    this.#sent = input;
    this.#session.tell('drive', { vehicle: this.vehicle, ...input });
  }

  #takeOver() {
    if (!this.active) this.onTakeover();
    this.active = true;
  }

  #isNew(input) {
    if (input.gear !== this.#sent.gear) return true;
    const ends = (value) => value === 0 || Math.abs(value) === 1;
    return Object.keys(NO_WISH).some((name) => {
      const change = Math.abs(input[name] - this.#sent[name]);
      return change > GRAIN || (change > 0 && ends(input[name]));
    });
  }

  #readGamepad() {
    const pad = [...(navigator.getGamepads?.() ?? [])].find((each) => each?.connected && each.mapping === 'standard');
    if (!pad) return NO_WISH;
    const pressed = pad.buttons.map((button) => button.pressed);
    const newly = (index) => pressed[index] && !this.#padBefore[index];
    if (newly(PAD.shiftUp)) this.shift(1);
    if (newly(PAD.shiftDown)) this.shift(-1);
    if (newly(PAD.reset)) this.resetVehicle();
    this.#padBefore = pressed;
    return wishOfGamepad(pad);
  }

  #forget() {
    this.#driver = new Driver();
    this.#sent = { ...NO_WISH, gear: null };
    this.active = false;
    this.vehicle = Math.min(this.vehicle, Math.max(this.vehicles.length - 1, 0));
  }
}
