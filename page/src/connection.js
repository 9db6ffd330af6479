import { Emitter } from './emitter.js';

const FIRST_DELAY = 500; // ms
const LONGEST_DELAY = 4000;

/**
 * The WebSocket to the program, opened again whenever it is lost. Events: `open`, `lost`, `frame` (ArrayBuffer),
 * `message` (object).
 */
export class Connection extends Emitter {
  #url;
  #socket = null;
  #waiting = new Map();
  #nextId = 1;
  #delay = FIRST_DELAY;

  constructor(url) {
    super();
    this.#url = url;
  }

  open() {
    const socket = new WebSocket(this.#url);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.#delay = FIRST_DELAY;
      this.emit('open');
    };
    socket.onmessage = ({ data }) => {
      if (data instanceof ArrayBuffer) this.emit('frame', data);
      else this.#read(data);
    };
    socket.onclose = () => this.#lost();
    this.#socket = socket;
  }

  get connected() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  /**
   * Asks the program to do something; resolves to its answer. Rejects with the program's own words when it refuses, or
   * when the connection goes before the answer comes.
   */
  do(name, args = {}) {
    if (!this.connected) return Promise.reject(new Error('not connected to the program'));
    const id = this.#nextId++;
    this.#socket.send(JSON.stringify({ ...args, do: name, id }));
    return new Promise((resolve, reject) => this.#waiting.set(id, { resolve, reject }));
  }

  #read(text) {
    const message = JSON.parse(text);
    if (message.type !== 're' && message.re === undefined) {
      this.emit('message', message);
      return;
    }
    const waiting = this.#waiting.get(message.re);
    this.#waiting.delete(message.re);
    if (message.ok) waiting?.resolve(message);
    else waiting?.reject(new Error(message.error));
  }

  #lost() {
    for (const { reject } of this.#waiting.values()) reject(new Error('the connection was lost'));
    this.#waiting.clear();
    this.emit('lost');
    setTimeout(() => this.open(), this.#delay);
    this.#delay = Math.min(this.#delay * 2, LONGEST_DELAY);
  }
}
