import {
  BufferGeometry,
  DoubleSide,
  DynamicDrawUsage,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
} from 'three';
import { POINT_STRIDE } from './protocol.js';

/** The cloths of a live scene: surfaces seen from both sides, and lines where there are no faces. */
export class ClothView {
  #pieces = []; // {geometry, first, faces}: where its points begin among those of all
  #before;
  #latest;
  #moving = true; // do the two last frames differ, or is what is drawn not yet final?
  object = new Group();

  /** @param {Object[]} cloths of the message of the scene */
  constructor(cloths) {
    const points = cloths.flatMap(({ positions }) => positions);
    this.#before = new Float32Array(points);
    this.#latest = new Float32Array(points);
    let first = 0;
    for (const cloth of cloths) {
      this.#add(cloth, first);
      first += cloth.positions.length;
    }
  }

  /** A frame of poses has come: what was on its way is there. */
  settle() {
    this.#before.set(this.#latest);
  }

  /** Takes a decoded frame, of the same step as the poses before it. */
  receive({ floats, count }) {
    if (count * POINT_STRIDE !== this.#latest.length) return;
    this.#latest.set(floats);
    this.#moving = true;
  }

  /** Places everything at a time between the two last frames, 0 … 1. */
  draw(time) {
    if (!this.#moving) return;
    for (const { geometry, first, faces } of this.#pieces) {
      const { array } = geometry.attributes.position;
      for (let i = 0; i < array.length; ++i) {
        const from = this.#before[first + i];
        array[i] = from + time * (this.#latest[first + i] - from);
      }
      geometry.attributes.position.needsUpdate = true;
      if (faces) geometry.computeVertexNormals();
    }
    this.#moving = time < 1;
  }

  dispose() {
    for (const child of this.object.children) {
      child.geometry.dispose();
      child.material.dispose();
    }
  }

  #add({ positions, indices, lines, color }, first) {
    const position = new Float32BufferAttribute(positions, 3).setUsage(DynamicDrawUsage);
    if (indices.length > 0) {
      const mesh = new Mesh(this.#geometry(position, indices, first, true), surface(color));
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.frustumCulled = false;
      this.object.add(mesh);
    }
    if (lines.length > 0) {
      const rope = new LineSegments(this.#geometry(position, lines, first, false), new LineBasicMaterial({ color }));
      rope.frustumCulled = false;
      this.object.add(rope);
    }
  }

  #geometry(position, indices, first, faces) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', position);
    geometry.setIndex(indices);
    if (faces) geometry.computeVertexNormals();
    this.#pieces.push({ geometry, first, faces });
    return geometry;
  }
}

/** Shadows are cast by both sides, a little behind the surface, or it would lie in its own. */
function surface(color) {
  return new MeshLambertMaterial({ color, side: DoubleSide, shadowSide: DoubleSide });
}
