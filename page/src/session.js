import { Emitter } from './emitter.js';
import { decodeFrame } from './protocol.js';

/**
 * What the program says, kept: scenes, scene, status, telemetry and tunables. Each text message is an event of its
 * type, each binary frame one of its kind; besides there are `connected` (boolean) and `problem` (text for the reader).
 */
export class Session extends Emitter {
  #connection;
  scenes = [];
  scene = null;
  status = null;
  telemetry = null;
  tunables = [];
  framesReceived = 0;

  constructor(connection) {
    super();
    this.#connection = connection;
    connection.on('open', () => this.emit('connected', true));
    connection.on('lost', () => this.emit('connected', false));
    connection.on('message', (message) => this.#take(message));
    connection.on('frame', (buffer) => this.#takeFrame(buffer));
  }

  get connected() {
    return this.#connection.connected;
  }

  /** The program's answer; rejects with its error. */
  ask(name, args) {
    return this.#connection.do(name, args);
  }

  /** Asks and shows the error, if there is one; for buttons and keys. Resolves to whether it was done. */
  async tell(name, args) {
    try {
      await this.ask(name, args);
      return true;
    } catch (error) {
      this.emit('problem', error.message);
      return false;
    }
  }

  /** Keeps a value that the program has answered with. */
  setTunable(path, value) {
    const tunable = this.tunables.find((each) => each.path === path);
    if (tunable) tunable.value = value;
  }

  #take(message) {
    switch (message.type) {
      case 'hello':
        this.scenes = message.scenes;
        break;
      case 'scene':
        this.scene = message;
        this.tunables = message.tunables ?? [];
        this.telemetry = null;
        break;
      case 'status':
        this.status = message;
        break;
      case 'telemetry':
        this.telemetry = message;
        break;
      case 'tunables':
        this.#takeTunables(message);
        break;
      case 'error':
        this.emit('problem', message.error);
        break;
    }
    this.emit(message.type, message);
  }

  #takeTunables({ tunables, values = [] }) {
    if (tunables) this.tunables = tunables;
    const byPath = new Map(this.tunables.map((tunable) => [tunable.path, tunable]));
    for (const { path, value } of values) {
      if (byPath.has(path)) byPath.get(path).value = value;
    }
  }

  #takeFrame(buffer) {
    const frame = decodeFrame(buffer);
    if (frame.kind === 'poses') ++this.framesReceived;
    this.emit(frame.kind, frame);
  }
}
