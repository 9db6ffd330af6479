import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, LineBasicMaterial, LineSegments } from 'three';
import { LINE_STRIDE } from './protocol.js';

const FIRST_CAPACITY = 2048; // segments
const color = new Color();

/** The lines of debug drawing, over everything else. */
export class DebugView {
  object = new LineSegments(
    new BufferGeometry(),
    new LineBasicMaterial({
      vertexColors: true,
      depthTest: false,
      transparent: true,
      opacity: 0.9,
      fog: false,
      toneMapped: false,
    }),
  );
  #capacity = 0;

  constructor() {
    this.object.frustumCulled = false;
    this.object.renderOrder = 5;
    this.clear();
  }

  /** Shows the lines of a decoded frame instead of those before. */
  receive({ ints, floats, count }) {
    if (count === 0) return this.clear();
    if (count > this.#capacity) this.#reserve(count);
    const { position, color: tint } = this.object.geometry.attributes;
    for (let i = 0; i < count; ++i) {
      const from = i * LINE_STRIDE;
      for (let k = 0; k < 6; ++k) position.array[i * 6 + k] = floats[from + k];
      color.setHex(ints[from + 6]);
      color.toArray(tint.array, i * 6);
      color.toArray(tint.array, i * 6 + 3);
    }
    position.needsUpdate = tint.needsUpdate = true;
    this.object.geometry.setDrawRange(0, count * 2);
    this.object.visible = count > 0;
  }

  clear() {
    this.object.visible = false;
  }

  #reserve(count) {
    this.#capacity = Math.max(FIRST_CAPACITY, 2 ** Math.ceil(Math.log2(count)));
    this.object.geometry.dispose();
    const geometry = new BufferGeometry();
    for (const name of ['position', 'color']) {
      const attribute = new BufferAttribute(new Float32Array(this.#capacity * 6), 3);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    this.object.geometry = geometry;
  }
}
