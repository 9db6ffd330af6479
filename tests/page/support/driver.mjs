// A driver who has eyes for a road and fingers for four keys.

const SIGHT = 24;        // m along the road, over which the driver sees bends
const COMFORT = 4;       // m/s² to the side, which the driver likes in bends
const EAGER = 1.6;       // share of full lock per radian of the direction of the aim
const CARELESS = 0.1;    // of full lock, which is let be
const REACTION = 100;    // ms that keys are held before the next steps: pedals and wheel follow keys in time
const SOON = 1000;       // ms
const STEPS = 8;         // of the simulation between two looks

const wrap = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

/** A closed road. */
export class Road {
  #line = [];  // points [x, z] about every 2 m

  /** Through the points [x, y, z] of a scene's road, which are joined as the program does it: by Catmull and Rom. */
  constructor(points) {
    const at = (i) => points[(i + points.length) % points.length];
    points.forEach((from, i) => {
      const [a, b, c, d] = [at(i - 1), from, at(i + 1), at(i + 2)];
      const count = Math.ceil(Math.hypot(c[0] - b[0], c[2] - b[2]) / 2);
      for (let k = 0; k < count; ++k) {
        const t = k / count;
        this.#line.push([0, 2].map((n) => b[n] + 0.5 * t * ((c[n] - a[n]) + t * ((2 * a[n] - 5 * b[n] + 4 * c[n] - d[n])
          + t * (3 * (b[n] - c[n]) + d[n] - a[n])))));
      }
    });
  }

  get points() {
    return this.#line.length;
  }

  point(index) {
    return this.#line[index % this.points];
  }

  /** Index of the nearest of the points just beyond `from`, so that nobody cuts across; and how far it is. */
  nearest([x, z], from) {
    let best = { index: from, distance: Infinity };
    for (let i = from; i < from + 15; ++i) {
      const [px, pz] = this.point(i);
      const distance = Math.hypot(px - x, pz - z);
      if (distance < best.distance) best = { index: i, distance };
    }
    return best;
  }

  /** Index of the point that lies so far along the road. */
  beyond(index, distance) {
    let i = index;
    for (let left = distance; left > 0; ++i) {
      const [[x, z], [nx, nz]] = [this.point(i), this.point(i + 1)];
      left -= Math.hypot(nx - x, nz - z);
    }
    return i;
  }

  heading(index) {
    const [[x, z], [nx, nz]] = [this.point(index), this.point(index + 1)];
    return Math.atan2(nx - x, nz - z);
  }

  /** m/s at which the bends that are in sight are comfortable. */
  speed(index, most) {
    const bend = Math.abs(wrap(this.heading(this.beyond(index, SIGHT)) - this.heading(index)));
    return Math.min(most, Math.sqrt((COMFORT * SIGHT) / Math.max(bend, 1e-3)));
  }
}

/** Holds exactly the keys wanted. */
class Fingers {
  #page;
  #down = new Set();

  constructor(page) {
    this.#page = page;
  }

  async hold(...keys) {
    for (const key of [...this.#down]) {
      if (!keys.includes(key)) await this.#page.keyboard.up(key);
    }
    for (const key of keys) {
      if (!this.#down.has(key)) await this.#page.keyboard.down(key);
    }
    this.#down = new Set(keys);
  }
}

/**
 * Gives the keys time, makes the steps, and looks where the first car of the scene is then. The time is the page's own,
 * which stands still otherwise: however busy the machine is, the keys do the same.
 */
async function advance(page, count) {
  await page.clock.fastForward(REACTION);
  return page.evaluate(async (steps) => {
    const { step } = await window.ragtop.do('step', { count: steps });
    const { port1, port2 } = new MessageChannel();
    while (window.ragtop.step !== step || window.ragtop.telemetry?.step !== step) {
      await new Promise((resolve) => {
        port1.onmessage = resolve;
        port2.postMessage(null);
      });
    }
    const { chassis } = window.ragtop.scene.vehicles[0];
    const { speed, steer } = window.ragtop.telemetry.vehicles[0];
    return { pose: [...window.ragtop.poses().get(chassis)], speed, steer };
  }, count);
}

/** Forward is z; a turn to the left, where x is, counts as positive. */
function headingOf([, , , x, y, z, w]) {
  return Math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y));
}

/** What a driver presses who is there and wants to get along the road. */
function keysFor(road, index, { pose: [x, , z], speed, steer }, heading, most) {
  const [tx, tz] = road.point(road.beyond(index, 5 + 0.6 * Math.max(speed, 0)));
  const aim = wrap(Math.atan2(tx - x, tz - z) - heading);
  const turn = Math.min(Math.max(-EAGER * aim, -1), 1);
  const wanted = road.speed(index, most);
  const keys = [];
  if (turn < steer - CARELESS) keys.push('a');
  if (turn > steer + CARELESS) keys.push('d');
  if (speed < wanted) keys.push('w');
  if (speed > wanted + 1.5) keys.push('s');
  return keys;
}

/**
 * Drives the first car of the scene along the road by the keys of the page, while the simulation is stepped, until it
 * has gone all round. The page has to be opened with a clock of its own.
 * @param {{speed: number, mostSteps: number}} limits speed in m/s
 * @returns {Promise<{steps: number, round: boolean, strayed: number, fastest: number}>} m from the middle at most
 */
export async function driveAround(page, road, { speed, mostSteps }) {
  const fingers = new Fingers(page);
  const course = { steps: 0, round: false, strayed: 0, fastest: 0 };
  await page.clock.pauseAt((await page.evaluate(() => Date.now())) + SOON);
  let car = await advance(page, 1);
  const [x, , z] = car.pose;
  const lengths = Array.from({ length: road.points }, (_, i) => Math.hypot(road.point(i)[0] - x, road.point(i)[1] - z));
  const start = lengths.indexOf(Math.min(...lengths));
  for (let index = start; !course.round && course.steps < mostSteps; course.steps += STEPS) {
    await fingers.hold(...keysFor(road, index, car, headingOf(car.pose), speed));
    car = await advance(page, STEPS);
    const nearest = road.nearest([car.pose[0], car.pose[2]], index);
    index = nearest.index;
    course.strayed = Math.max(course.strayed, nearest.distance);
    course.fastest = Math.max(course.fastest, car.speed);
    course.round = index >= start + road.points;
  }
  await fingers.hold();
  await page.clock.resume();
  return course;
}
