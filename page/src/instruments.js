import { byId, setText } from './dom.js';

/** Speed, gear and engine speed of the driven car, over the view. */
export class Instruments {
  #driving;
  #box = byId('instruments');

  constructor(driving) {
    this.#driving = driving;
  }

  update() {
    const car = this.#driving.telemetry;
    this.#box.hidden = car === null;
    if (car === null) return;
    setText(
      byId('car-name'),
      this.#driving.vehicles.length > 1 ? this.#driving.vehicles[this.#driving.vehicle].name : '',
    );
    setText(byId('car-speed'), Math.abs(car.speed * 3.6).toFixed(0));
    setText(byId('car-gear'), car.gear < 0 ? 'R' : car.gear === 0 ? 'N' : String(car.gear));
    setText(byId('car-gear-mode'), this.#driving.automatic ? 'auto' : 'manual');
    setText(byId('car-rpm'), `${Math.round(car.rpm / 10) * 10} rpm`);
    this.#bar('throttle', car.throttle);
    this.#bar('brake', car.brake);
    byId('car-steer').style.left = `${50 + 50 * (car.steer ?? 0)}%`;
  }

  #bar(name, value = 0) {
    byId(`car-${name}`).style.transform = `scaleX(${value})`;
  }
}
