import { Emitter } from './emitter.js';

/** A recording, as the timeline sees it: places are seconds, `unit` is the time of a frame, s. */
export class RecordingPlayer extends Emitter {
  #recording;
  #unit;
  #state;

  /** @param {Recording} recording */
  constructor(recording) {
    super();
    this.#recording = recording;
    this.#unit = recording.frameTime;
    this.#state = { playing: true, at: 0, speed: 1 };
  }

  get state() {
    const { playing, at, speed } = this.#state;
    return {
      counts: 'frame',
      playing,
      first: 0,
      last: this.#recording.duration,
      at,
      time: at,
      unit: this.#unit,
      speed,
      realTimeFactor: null,
    };
  }

  play() {
    const ended = this.#state.at >= this.#recording.duration;
    this.#set({ playing: true, at: ended ? 0 : this.#state.at });
  }

  pause() {
    this.#set({ playing: false });
  }

  /** Frames of the recording, back or on. */
  step(count) {
    this.#set({ playing: false, at: this.#state.at + count * this.#unit });
  }

  reset() {
    this.#set({ at: 0 });
  }

  setSpeed(speed) {
    this.#set({ speed });
  }

  seek(at) {
    this.#set({ playing: false, at });
  }

  /** Plays on by so many seconds of real time; whether the picture changes. */
  advance(elapsed) {
    const { playing, at, speed } = this.#state;
    if (!playing) return false;
    const next = at + elapsed * speed;
    this.#set({ at: next, playing: next < this.#recording.duration });
    return true;
  }

  #set(change) {
    Object.assign(this.#state, change);
    this.#state.at = Math.min(Math.max(this.#state.at, 0), this.#recording.duration);
    this.#recording.seek(this.#state.at);
    this.emit('change');
  }
}
