import { blendPose } from './matrices.js';
import { POSE_STRIDE } from './protocol.js';

const SIZE = 7;

/**
 * Poses of the nodes: the last one received, the one before, and the one drawn, which lies between them. Each node has
 * a slot of seven numbers.
 */
export class PoseStore {
  #slots = new Map();
  #free = [];
  #before = new Float32Array(64 * SIZE);
  #latest = new Float32Array(64 * SIZE);
  #moving = new Set(); // slots whose two last poses differ
  #stale = new Set(); // slots whose drawn pose is not yet final
  drawn = new Float32Array(64 * SIZE);

  /** Adds a node, or places a known one; its slot. */
  add(node, pose) {
    const slot = this.#slots.get(node) ?? this.#newSlot(node);
    for (const array of [this.#before, this.#latest, this.drawn]) array.set(pose, slot * SIZE);
    this.#stale.add(slot);
    return slot;
  }

  remove(node) {
    const slot = this.#slots.get(node);
    if (slot === undefined) return;
    this.#slots.delete(node);
    this.#moving.delete(slot);
    this.#stale.delete(slot);
    this.#free.push(slot);
  }

  slot(node) {
    return this.#slots.get(node);
  }

  nodes() {
    return this.#slots.keys();
  }

  /** The pose of a node as drawn. */
  pose(node) {
    const slot = this.#slots.get(node);
    return slot === undefined ? undefined : this.drawn.subarray(slot * SIZE, (slot + 1) * SIZE);
  }

  /** Takes a decoded frame of poses; nodes that it does not mention have stayed where they are. */
  receive(frame) {
    for (const slot of this.#moving) {
      this.#settle(slot);
      this.#stale.add(slot);
    }
    this.#moving.clear();
    const { ints, floats, count } = frame;
    for (let i = 0; i < count; ++i) {
      const slot = this.#slots.get(ints[i * POSE_STRIDE]);
      if (slot === undefined) continue;
      const from = i * POSE_STRIDE + 1;
      for (let k = 0; k < SIZE; ++k) this.#latest[slot * SIZE + k] = floats[from + k];
      this.#moving.add(slot);
    }
  }

  /**
   * Moves what is drawn to the time between the two last frames, 0 … 1, and calls `changed` with every slot whose
   * drawn pose is new.
   */
  draw(time, changed) {
    for (const slot of this.#stale) {
      if (!this.#moving.has(slot)) this.#show(slot, 1, changed);
    }
    this.#stale.clear();
    for (const slot of this.#moving) this.#show(slot, time, changed);
    if (time < 1) return;
    for (const slot of this.#moving) this.#settle(slot);
    this.#moving.clear();
  }

  #show(slot, time, changed) {
    if (time < 1) blendPose(this.drawn, this.#before, this.#latest, slot * SIZE, time);
    else for (let k = slot * SIZE; k < (slot + 1) * SIZE; ++k) this.drawn[k] = this.#latest[k];
    changed(slot);
  }

  #settle(slot) {
    for (let k = slot * SIZE; k < (slot + 1) * SIZE; ++k) this.#before[k] = this.#latest[k];
  }

  #newSlot(node) {
    const slot = this.#free.pop() ?? this.#slots.size;
    this.#slots.set(node, slot);
    while ((slot + 1) * SIZE > this.drawn.length) this.#grow();
    return slot;
  }

  #grow() {
    const larger = (array) => {
      const copy = new Float32Array(array.length * 2);
      copy.set(array);
      return copy;
    };
    this.#before = larger(this.#before);
    this.#latest = larger(this.#latest);
    this.drawn = larger(this.drawn);
  }
}
