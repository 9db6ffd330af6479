// The chart's protocol (docs/chart.md) on one side, an engine on the other.
import { createInterface } from 'node:readline';

export class Unsupported extends Error {}

/**
 * Answers lines until there are no more. `makeWorld(scene)` returns an object with step(dt, pushes), setVelocity(body, v,
 * w), state(body) → [position, rotation, v, w] for bodies that are not fixed, and work() → contacts and passes.
 */
export async function serve(hello, makeWorld) {
  let scene = null;
  let world = null;

  function answer(cpuMs) {
    const bodies = scene.bodies.map((body, i) => {
      const [position, rotation, v, w] = body.type === 'fixed' ? [body.position, body.rotation, [0, 0, 0], [0, 0, 0]] : world.state(i);
      return [...position, ...rotation, ...v, ...w];
    });
    return { bodies, cpu_ms: cpuMs, ...world.work() };
  }

  function answerTo(message) {
    switch (message.do) {
      case 'hello':
        return hello;
      case 'scene':
        scene = message;
        world = makeWorld(scene);
        return answer(0);
      case 'step': {
        const before = process.cpuUsage();
        world.step(message.dt, message.pushes ?? []);
        const { user, system } = process.cpuUsage(before);
        return answer((user + system) / 1000);
      }
      case 'velocity':
        world.setVelocity(message.body, message.v, message.w);
        return answer(0);
      default:
        return { error: `cannot ${message.do}` };
    }
  }

  for await (const line of createInterface({ input: process.stdin })) {
    let told;
    try {
      told = answerTo(JSON.parse(line));
    } catch (error) {
      told = error instanceof Unsupported ? { unsupported: error.message } : { error: String(error.message ?? error) };
    }
    process.stdout.write(`${JSON.stringify(told)}\n`);
  }
}
