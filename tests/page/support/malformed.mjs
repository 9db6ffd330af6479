// Messages that are wrong, each in its own way, the same ones each time.

/** Numbers in [0, 1) from a seed [Steele et al., SplitMix, 2014, in 32 bits]. */
export function random(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x9e3779b9) >>> 0;
    let z = state;
    z = Math.imul(z ^ (z >>> 16), 0x21f0aaad);
    z = Math.imul(z ^ (z >>> 15), 0x735a2d97);
    return ((z ^ (z >>> 15)) >>> 0) / 2 ** 32;
  };
}

// Of every command one message that would be accepted, in a scene that has a car, its chassis at node 1.
const VALID = [
  { do: 'step', count: 1 }, { do: 'seek', step: 0 }, { do: 'speed', factor: 1 }, { do: 'load', scene: 'track' },
  { do: 'show', contacts: true }, { do: 'grab', node: 1, point: [0, 0, 0], target: [0, 1, 0] },
  { do: 'drag', target: [0, 1, 0] }, { do: 'shoot', origin: [0, 5, 9], direction: [0, 0, -1] },
  { do: 'drive', vehicle: 0, throttle: 0.5 }, { do: 'resetVehicle', vehicle: 0 }, { do: 'pick', node: 1 },
  { do: 'tune', path: 'settings.substeps', value: 4 }, { do: 'untune', path: 'settings.substeps' },
  { do: 'saveTuning', name: 'a' }, { do: 'loadTuning', name: 'a' },
];
const WRONG_VALUES = [null, 'x', {}, [], [[]], -1e308, 1e308, 99999999, [1, 2], [1, 2, 'x'], { a: 1 }, '\u0000',
  '../../etc/passwd'];

/** Nothing may be picked, and a tuning may have almost any name. */
function isRight(command, value) {
  return (command === 'pick' && value === null) || (command === 'saveTuning' && value === 'x');
}

/**
 * @returns {{bytes: Buffer, what: string}[]} payloads of text messages: none is JSON that any command takes
 */
export function malformedMessages(count, seed = 7) {
  const next = random(seed);
  const below = (n) => Math.floor(next() * n);
  const any = (list) => list[below(list.length)];
  const text = (string) => Buffer.from(string);
  const json = (value) => text(JSON.stringify(value));
  const kinds = [
    ['no JSON', () => Buffer.from(Array.from({ length: 1 + below(200) }, () => 33 + below(90)))],
    ['cut off', () => {
      const whole = json(any(VALID));
      return whole.subarray(0, 1 + below(whole.length - 1));
    }],
    ['no object', () => json(any([1, 'play', null, true, ['play'], [{ do: 'play' }]]))],
    ['no command', () => json(any([{}, { id: 1 }, { do: null }, { do: 7 }, { do: ['play'] }, { do: {} }]))],
    ['unknown command', () => json({ do: any(['', 'Play', 'exit', 'eval', '__proto__', 'stepp', 'x'.repeat(5000)]) })],
    ['unknown member', () => json({ ...any(VALID), [any(['x', 'Id', '__proto__x', '', 'countt'])]: 1 })],
    ['missing member', () => {
      const { do: name } = any(VALID.filter((message) => !['show', 'saveTuning'].includes(message.do)));
      return json({ do: name });
    }],
    ['wrong value', () => {
      const message = { ...any(VALID) };
      const name = any(Object.keys(message).filter((key) => key !== 'do'));
      message[name] = any(WRONG_VALUES.filter((value) => !isRight(message.do, value)));
      return json(message);
    }],
    ['no number', () => text(any(['{"do":"speed","factor":NaN}', '{"do":"speed","factor":1e999}',
      '{"do":"step","count":1.5}', '{"do":"seek","step":-Infinity}', '{"do":"speed","factor":-0}',
      '{"do":"step","count":1e400}', '{"do":"speed","factor":0x1}']))],
    ['wrong id', () => json({ ...any(VALID), id: any([null, 'x', 1.5, [], {}, 1e300]) })],
    ['too deep', () => text('{"do":'.repeat(3000) + '1' + '}'.repeat(3000))],
    ['too deep', () => text('['.repeat(20000))],
    ['too many members', () => json(Object.fromEntries(Array.from({ length: 2000 }, (_, i) => [`k${i}`, i])))],
  ];
  return Array.from({ length: count }, (_, i) => {
    const [what, make] = kinds[i % kinds.length];
    return { what, bytes: make() };
  });
}
