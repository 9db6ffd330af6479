// Whatever hostile clients send, the program computes what it would have computed, and goes on to answer.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { acceptance, PROGRAM_ALONE, say } from './support/acceptance.mjs';
import { malformedMessages } from './support/malformed.mjs';
import { Program } from './support/program.mjs';
import { BINARY, frame, get, request, Socket } from './support/socket.mjs';

const SCENE = 'track';
const STEPS = 40;
const MESSAGES = 200;
const MOST_CLIENTS = 16;
const LARGEST = 100 << 20;  // bytes

/** Steps one by one, does `between(i)` before each, and returns the hashes. */
async function hashes(client, between = async () => {}) {
  await client.tell('pause');
  await client.tell('reset');
  const found = [];
  for (let i = 0; i < STEPS; ++i) {
    await between(i);
    await client.tell('step', { count: 1 });
    const { step, hash } = await client.tell('hash');
    found.push(`${step} ${hash}`);
  }
  return found;
}

/** Every wrong message gets an error, on a connection that stays open, or is the end of that connection. */
async function sendMalformed(port, part) {
  let client = await Socket.open(port);
  for (const { bytes, what } of part) {
    const answer = await client.provoke(frame(bytes));
    if (answer === null) {
      client = await Socket.open(port);
      continue;
    }
    const refused = answer.type === 'error' || answer.ok === false;
    assert.ok(refused, `${what}: ${bytes.subarray(0, 100)}: ${JSON.stringify(answer)}`);
  }
  client.close();
}

/** Frames that are no WebSocket messages end the connection, or are passed over. */
async function sendBrokenFrames(port) {
  const text = Buffer.from('{"do":"reset"}');
  const wrong = [
    frame(text, { masked: false }), frame(text, { opcode: 3 }), frame(text, { opcode: 11 }),
    frame(text, { opcode: BINARY }), frame(Buffer.from([0xff, 0xfe, 0x80]), {}), frame(text, { opcode: 0 }),
    frame(Buffer.alloc(126), { opcode: 9 }), frame(text, { opcode: 9, final: false }),
    Buffer.from('GET / HTTP/1.1\r\n\r\n'), Buffer.alloc(300, 0xff),
  ];
  for (const bytes of wrong) {
    const client = await Socket.open(port);
    assert.equal(client.status, 101);
    await client.write(bytes);
    await client.write(frame(Buffer.alloc(0), { opcode: 8 }));
    client.close();
  }
}

async function sendForeign(port) {
  const origins = ['http://example.com', 'https://127.0.0.1', 'null', 'http://127.0.0.1:1',
    'http://localhost.example.com'];
  for (const origin of origins) {
    const client = await Socket.open(port, { origin });
    assert.equal(client.status, 403, origin);
  }
  const tool = await Socket.open(port, { origin: null });
  assert.equal(tool.status, 101, 'a client without origin');
  tool.close();
  for (const host of ['example.com', `example.com:${port}`, '127.0.0.1:1', '']) {
    assert.equal((await get(port, '/', { Host: host })).status, 403, `host ${host}`);
  }
}

async function climb(port) {
  const paths = ['/../../../../../../etc/passwd', '/visual/../../../../../etc/passwd',
    '/visual/..%2f..%2f..%2fetc%2fpasswd', '/visual/%2e%2e/%2e%2e/etc/passwd', '//etc/passwd', '/visual/', '/visual',
    '/etc/passwd', '/visual/\\..\\x', '/%00', '/index.html', '/visual/....//....//etc/passwd', 'file:///etc/passwd',
    `/${'x'.repeat(4000)}`];
  for (const path of paths) {
    const { status, text } = await get(port, path);
    assert.ok(status >= 400 && status < 500, `${path}: ${status}`);
    assert.ok(!text.includes('root:'), path);
  }
  const post = `POST / HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n`;
  assert.equal((await request(port, post)).status, 405);
  const garbage = ['\r\n\r\n', 'GET\r\n\r\n', `GET / HTTP/1.1\r\nHost: ${'a'.repeat(100000)}\r\n\r\n`,
    '\u0016\u0003\u0001\u0002\u0000'.repeat(50)];
  for (const bytes of garbage) {
    const { status } = await request(port, Buffer.from(bytes, 'latin1'), { seconds: 2 });
    assert.ok(status === 0 || status >= 400, `${bytes.slice(0, 20)}: ${status}`);
  }
}

/** One message far too large: said so at once, and sent in spite of it. */
async function sendHuge(port) {
  const client = await Socket.open(port);
  const chunk = Buffer.alloc(1 << 20, 0x78);
  await client.write(frame(Buffer.alloc(0), { claim: LARGEST }));
  for (let sent = 0; sent < LARGEST && !client.closed; sent += chunk.length) await client.write(chunk);
  assert.ok(client.closed || client.closeCode === 1009, 'a message of 100 MB is taken');
  client.close();
  // Just above the limit, and in pieces of which none is.
  for (const pieces of [[Buffer.alloc(65537, 0x20)], Array.from({ length: 9 }, () => Buffer.alloc(8192, 0x20))]) {
    const other = await Socket.open(port);
    for (const [i, piece] of pieces.entries()) {
      await other.write(frame(piece, { opcode: i === 0 ? 1 : 0, final: i === pieces.length - 1 }));
    }
    const answer = await other.provoke(frame(Buffer.from('{"do":"scenes","id":1}')));
    assert.equal(answer, null, 'a message above 64 KiB leaves the connection open');
    other.close();
  }
}

async function connectMany(port, others) {
  const clients = await Promise.all(Array.from({ length: 50 }, () => Socket.open(port)));
  const accepted = clients.filter(({ status }) => status === 101);
  say(`${accepted.length} of 50 connections beside ${others} are taken`);
  assert.equal(accepted.length, MOST_CLIENTS - others);
  assert.ok(clients.every(({ status }) => status === 101 || status === 503));
  clients.forEach((client) => client.close());
}

/** Far more messages than are waited for, without waiting for an answer. */
async function flood(port) {
  const client = await Socket.open(port);
  const messages = Array.from({ length: 5000 }, () => frame(Buffer.from('{"do":"pick","node":"x","id":1}')));
  await client.write(Buffer.concat(messages));
  await client.provoke(frame(Buffer.from('{"do":"scenes","id":1}')));
  client.close();
}

/** kB of memory that the program has ever used. */
async function peakMemory(pid) {
  return Number(/VmHWM:\s+(\d+)/.exec(await readFile(`/proc/${pid}/status`, 'utf8'))[1]);
}

await acceptance(PROGRAM_ALONE, async (test) => {
  say('an undisturbed run');
  const calm = await Program.start(test, SCENE);
  const expected = await hashes(await Socket.open(calm.port));
  await calm.stop();

  const program = await Program.start(test, SCENE);
  const { port } = program;
  const client = await Socket.open(port);
  const deaf = await Socket.open(port, { reads: false });
  assert.equal(deaf.status, 101);
  await deaf.send('{"do":"show","contacts":true}');
  const memory = await peakMemory(program.pid);

  say('the same run among hostile clients');
  const messages = malformedMessages(MESSAGES);
  const share = MESSAGES / 20;
  const attacks = new Map([
    ...Array.from({ length: 20 }, (_, i) =>
      [i, () => sendMalformed(port, messages.slice(i * share, (i + 1) * share))]),
    [21, () => sendBrokenFrames(port)], [23, () => sendForeign(port)], [25, () => climb(port)],
    [27, () => sendHuge(port)], [29, () => connectMany(port, 2)], [31, () => flood(port)],
  ]);
  const found = await hashes(client, async (i) => {
    // The deaf one asks and never hears.
    await deaf.send(`{"do":"scenes","id":${i}}`);
    await attacks.get(i)?.();
  });
  assert.deepEqual(found, expected);

  say('it goes on while nobody reads, and answers');
  await client.tell('step', { count: 600 });
  assert.equal((await get(port, '/')).status, 200);
  assert.ok(program.running);
  const grown = (await peakMemory(program.pid)) - memory;
  say(`its memory has grown by ${Math.round(grown / 1024)} MiB at most`);
  assert.ok(grown < 200 * 1024, 'it keeps what hostile clients send');
});
