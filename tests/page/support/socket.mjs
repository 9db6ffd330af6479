// HTTP and WebSocket by hand, to say what no browser and no library would.
import { createHash, randomBytes } from 'node:crypto';
import net from 'node:net';

export const TEXT = 1;
export const BINARY = 2;
const CLOSE = 8;

/** Sends bytes as they are; the status and the rest of the answer, status 0 when there is none. */
export function request(port, bytes, { seconds = 10 } = {}) {
  return new Promise((resolve) => {
    let answer = Buffer.alloc(0);
    const finish = () => {
      clearTimeout(timer);
      socket.destroy();
      const text = answer.toString('latin1');
      resolve({ status: Number(/^HTTP\/1\.[01] (\d+)/.exec(text)?.[1] ?? 0), text });
    };
    const timer = setTimeout(finish, 1000 * seconds);
    const socket = net.connect(port, '127.0.0.1', () => socket.write(bytes));
    socket.on('data', (chunk) => { answer = Buffer.concat([answer, chunk]); });
    socket.on('close', finish);
    socket.on('error', finish);
  });
}

export function get(port, path, headers = {}) {
  const all = { Host: `127.0.0.1:${port}`, Connection: 'close', ...headers };
  const lines = Object.entries(all).map(([name, value]) => `${name}: ${value}\r\n`).join('');
  return request(port, `GET ${path} HTTP/1.1\r\n${lines}\r\n`);
}

/** One WebSocket frame with the mask that clients must use. */
export function frame(payload, { opcode = TEXT, final = true, masked = true, claim = payload.length } = {}) {
  const head = Buffer.alloc(14);
  head[0] = (final ? 0x80 : 0) | opcode;
  let at = 2;
  if (claim < 126) head[1] = claim;
  else if (claim < 65536) {
    head[1] = 126;
    head.writeUInt16BE(claim, 2);
    at = 4;
  } else {
    head[1] = 127;
    head.writeBigUInt64BE(BigInt(claim), 2);
    at = 10;
  }
  if (!masked) return Buffer.concat([head.subarray(0, at), payload]);
  head[1] |= 0x80;
  const mask = randomBytes(4);
  mask.copy(head, at);
  const body = Buffer.from(payload);
  for (let i = 0; i < body.length; ++i) body[i] ^= mask[i & 3];
  return Buffer.concat([head.subarray(0, at + 4), body]);
}

/** A WebSocket client that may misbehave. */
export class Socket {
  #socket;
  #bytes = Buffer.alloc(0);
  #waiting = [];     // {accepts, resolve, reject}
  #fragments = [];
  #nextId = 1;
  status = 0;        // of the handshake
  closeCode = null;
  errors = [];       // of messages of the type "error"

  static async open(port, { origin = `http://127.0.0.1:${port}`, path = '/live', reads = true } = {}) {
    const client = new Socket();
    await client.#open(port, origin, path, reads);
    return client;
  }

  get closed() {
    return this.#socket.destroyed;
  }

  /** Writes bytes; resolves when they are on their way or the connection has gone. */
  write(bytes) {
    return new Promise((resolve) => {
      if (this.closed) resolve();
      else this.#socket.write(bytes, () => resolve());
    });
  }

  send(text) {
    return this.write(frame(Buffer.from(text)));
  }

  /** Asks as the page does; the answer, which may say that it failed. */
  async ask(name, args = {}) {
    const id = this.#nextId++;
    const answer = this.#expect(`the answer to ${name}`, (message) => message.re === id);
    await this.send(JSON.stringify({ do: name, id, ...args }));
    return answer;
  }

  /** As ask, but throws the error that it answers with. */
  async tell(name, args) {
    const answer = await this.ask(name, args);
    if (!answer.ok) throw new Error(answer.error);
    return answer;
  }

  /** Sends a frame that is wrong; resolves to what it is answered with, or to null when the connection is closed. */
  async provoke(bytes) {
    const answer = this.#expect('an error', (message) => message.type === 'error' || message.type === 're');
    await this.write(bytes);
    return answer.catch((error) => {
      if (this.closed) return null;
      throw error;
    });
  }

  close() {
    this.#socket.destroy();
  }

  #expect(what, accepts, seconds = 60) {
    return new Promise((resolve, reject) => {
      const waiting = { accepts, resolve, reject };
      waiting.timer = setTimeout(() => reject(new Error(`${what} has not come after ${seconds} s`)), 1000 * seconds);
      this.#waiting.push(waiting);
      if (this.closed) this.#end();
    });
  }

  #open(port, origin, path, reads) {
    const key = randomBytes(16).toString('base64');
    const lines = [`GET ${path} HTTP/1.1`, `Host: 127.0.0.1:${port}`, 'Upgrade: websocket', 'Connection: Upgrade',
      `Sec-WebSocket-Key: ${key}`, 'Sec-WebSocket-Version: 13', ...(origin === null ? [] : [`Origin: ${origin}`])];
    return new Promise((resolve, reject) => {
      this.#socket = net.connect(port, '127.0.0.1', () => this.#socket.write(`${lines.join('\r\n')}\r\n\r\n`));
      const shake = (chunk) => {
        this.#bytes = Buffer.concat([this.#bytes, chunk]);
        const end = this.#bytes.indexOf('\r\n\r\n');
        if (end < 0) return;
        const head = this.#bytes.subarray(0, end).toString('latin1');
        this.#bytes = this.#bytes.subarray(end + 4);
        this.status = Number(/^HTTP\/1\.1 (\d+)/.exec(head)?.[1] ?? 0);
        this.#socket.off('data', shake);
        if (this.status === 101) {
          const accept = createHash('sha1').update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
          if (!head.includes(accept)) reject(new Error('the handshake is answered with another key'));
          if (reads) this.#socket.on('data', (more) => this.#take(more));
          else this.#socket.pause();
          if (reads) this.#take(Buffer.alloc(0));
        }
        resolve();
      };
      this.#socket.on('data', shake);
      this.#socket.on('error', () => {});
      this.#socket.on('close', () => {
        this.#end();
        resolve();
      });
    });
  }

  #end() {
    for (const { reject, timer } of this.#waiting.splice(0)) {
      clearTimeout(timer);
      reject(new Error('the connection is closed'));
    }
  }

  #take(chunk) {
    this.#bytes = Buffer.concat([this.#bytes, chunk]);
    while (this.#bytes.length >= 2) {
      let length = this.#bytes[1] & 0x7f;
      let at = 2;
      if (length === 126) {
        if (this.#bytes.length < 4) return;
        length = this.#bytes.readUInt16BE(2);
        at = 4;
      } else if (length === 127) {
        if (this.#bytes.length < 10) return;
        length = Number(this.#bytes.readBigUInt64BE(2));
        at = 10;
      }
      if (this.#bytes.length < at + length) return;
      const [first] = this.#bytes;
      const payload = this.#bytes.subarray(at, at + length);
      this.#bytes = this.#bytes.subarray(at + length);
      this.#takeFrame(first & 0x0f, (first & 0x80) !== 0, payload);
    }
  }

  #takeFrame(opcode, final, payload) {
    if (opcode === CLOSE) {
      this.closeCode = payload.length >= 2 ? payload.readUInt16BE(0) : null;
      return;
    }
    if (opcode > BINARY) return;
    if (opcode !== 0) this.#fragments = [];
    if (opcode === TEXT) this.#fragments.text = true;
    this.#fragments.push(payload);
    if (!final || !this.#fragments.text) return;
    const message = JSON.parse(Buffer.concat(this.#fragments).toString('utf8'));
    if (message.type === 'error') this.errors.push(message.error);
    const found = this.#waiting.findIndex(({ accepts }) => accepts(message));
    if (found < 0) return;
    const [{ resolve, timer }] = this.#waiting.splice(found, 1);
    clearTimeout(timer);
    resolve(message);
  }
}
