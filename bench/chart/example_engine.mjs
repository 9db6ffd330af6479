// An engine of a single body on planes, to show how a program takes part in the chart (docs/chart.md):
//   ragtop_bench chart --scenes stopping,friction-slides --engine-command 'node bench/chart/example_engine.mjs'
// Boxes touch by their corners, balls by their lowest points; contacts are solved by sequential impulses.
import { createInterface } from 'node:readline';

const add = (a, b) => a.map((x, i) => x + b[i]);
const scale = (s, a) => a.map((x) => s * x);
const sub = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const conjugate = ([x, y, z, w]) => [-x, -y, -z, w];

function multiply([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];
}

function rotate(q, v) {
  const t = scale(2, cross(q, v));
  return add(add(v, scale(q[3], t)), cross(q.slice(0, 3), t));
}

class Refusal extends Error {}

/** Points of a shape that may touch, about the body's origin. */
function pointsOf(shape) {
  const signs = [-1, 1];
  if (shape.type === 'sphere') return [{ at: shape.position, radius: shape.radius }];
  if (shape.type !== 'box') throw new Refusal(`a ${shape.type}`);
  return signs.flatMap((x) => signs.flatMap((y) => signs.map((z) => ({
    at: add(shape.position, rotate(shape.rotation, [x * shape.half[0], y * shape.half[1], z * shape.half[2]])),
    radius: 0,
  }))));
}

class World {
  constructor(scene) {
    if (scene.joints.length > 0) throw new Refusal('joints');
    const moving = scene.bodies.filter(({ type }) => type !== 'fixed');
    if (moving.length !== 1 || moving[0].type !== 'dynamic') throw new Refusal('more than one body that moves');
    Object.assign(this, { scene, body: moving[0], gravity: scene.gravity, iterations: scene.iterations, contacts: [] });
    if (this.body.principal.position.some((x) => x !== 0)) throw new Refusal('a centre of mass off the origin');
    this.points = this.body.shapes.flatMap((shape) => pointsOf(shape).map((point) => ({ ...point, ...shape, at: point.at, radius: point.radius })));
    this.planes = scene.bodies.filter(({ type }) => type === 'fixed').flatMap((body) => body.shapes.map((shape) => {
      if (shape.type !== 'box') throw new Refusal('ground that is no box');
      const normal = rotate(body.rotation, [0, 1, 0]);
      return { normal, friction: shape.friction, height: dot(normal, body.position) + shape.half[1] };
    }));
  }

  /** What an impulse does to the spin. */
  turned(torque) {
    const { rotation, principal, moments } = this.body;
    const q = multiply(rotation, principal.rotation);
    const own = rotate(conjugate(q), torque);
    return rotate(q, own.map((x, i) => x / moments[i]));
  }

  mass(arm, direction) {
    return 1 / (1 / this.body.mass + dot(cross(this.turned(cross(arm, direction)), arm), direction));
  }

  push(arm, impulse) {
    const { body } = this;
    body.v = add(body.v, scale(1 / body.mass, impulse));
    body.w = add(body.w, this.turned(cross(arm, impulse)));
  }

  speed(arm) {
    return add(this.body.v, cross(this.body.w, arm));
  }

  find() {
    this.contacts = [];
    for (const point of this.points) {
      const center = rotate(this.body.rotation, point.at);
      for (const { normal, friction, height } of this.planes) {
        const arm = sub(center, scale(point.radius, normal));
        const gap = dot(normal, add(this.body.position, arm)) - height;
        if (gap > 0.01) continue;
        const side = Math.abs(normal[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
        const t = sub(side, scale(dot(side, normal), normal));
        const tangent = scale(1 / Math.hypot(...t), t);
        this.contacts.push({ arm, gap, normal, tangents: [tangent, cross(normal, tangent)],
          friction: Math.sqrt(friction * point.friction), load: 0, grip: [0, 0] });
      }
    }
  }

  solve(contact, h) {
    const { arm, gap, normal, tangents } = contact;
    const wanted = Math.max(0, contact.load - this.mass(arm, normal) * (dot(this.speed(arm), normal) + gap / h));
    this.push(arm, scale(wanted - contact.load, normal));
    contact.load = wanted;
    const before = contact.grip;
    const grip = tangents.map((t, i) => before[i] - this.mass(arm, t) * dot(this.speed(arm), t));
    const share = Math.min(1, contact.friction * contact.load / (Math.hypot(...grip) || 1));
    contact.grip = scale(share, grip);
    tangents.forEach((t, i) => this.push(arm, scale(contact.grip[i] - before[i], t)));
  }

  step(dt, pushes = []) {
    const h = dt / this.scene.substeps;
    const { body } = this;
    for (let i = 0; i < this.scene.substeps; ++i) {
      body.v = add(body.v, scale(h, this.gravity));
      for (const { force, point } of pushes) this.push(sub(point, body.position), scale(h, force));
      this.find();
      for (let k = 0; k < this.iterations; ++k) for (const contact of this.contacts) this.solve(contact, h);
      body.position = add(body.position, scale(h, body.v));
      const turn = multiply([...scale(h / 2, body.w), 0], body.rotation);
      const q = add(body.rotation, turn);
      body.rotation = scale(1 / Math.hypot(...q), q);
    }
  }

  answer(cpuMs) {
    return {
      bodies: this.scene.bodies.map(({ position, rotation, v, w }) => [...position, ...rotation, ...v, ...w]),
      cpu_ms: cpuMs,
      contacts: this.contacts.length,
      passes: this.scene.substeps * this.iterations,
    };
  }
}

let world = null;

function answerTo(message) {
  switch (message.do) {
    case 'hello':
      return { name: 'example', version: '1', substeps: [1], iterations: [10, 50], standard: { rate: 60, substeps: 1, iterations: 10 } };
    case 'scene':
      world = new World(message);
      return world.answer(0);
    case 'step': {
      const before = process.cpuUsage();
      world.step(message.dt, message.pushes);
      const { user, system } = process.cpuUsage(before);
      return world.answer((user + system) / 1000);
    }
    case 'velocity':
      Object.assign(world.scene.bodies[message.body], { v: message.v, w: message.w });
      return world.answer(0);
    default:
      return { error: `cannot ${message.do}` };
  }
}

for await (const line of createInterface({ input: process.stdin })) {
  let answer;
  try {
    answer = answerTo(JSON.parse(line));
  } catch (error) {
    answer = error instanceof Refusal ? { unsupported: error.message } : { error: error.message };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
