import { BufferAttribute, BufferGeometry, Color, DataTexture, FloatType, Matrix4, Mesh, RGBAFormat } from 'three';
import { partMaterials, PARTS_PER_ROW, TEXELS } from './materials.js';
import { writeRows, writePartRows } from './matrices.js';

const STRIDE = TEXELS * 4; // numbers of a part in the texture
const COLOR = 12; // where its colour is
const color = new Color();

/**
 * All parts of one shape and look in one draw call: the shape is copied once per part, and the vertex shader takes
 * place and colour of the part from a texture. Hardware instancing would need less memory, but drawing without a
 * graphics card it costs two to three times as much, since every instance is set up as a draw call of its own.
 */
export class PartBatch {
  #shape;
  #parts = { value: null }; // the texture, as a uniform
  #owners = [];
  #capacity = 0;
  mesh;

  /** @param {BufferGeometry} shape  @param {{edges?: boolean, grid?: boolean, shadow?: boolean}} look */
  constructor(shape, { shadow = true, ...look }, capacity = 4) {
    this.#shape = shape;
    const { surface, depth } = partMaterials(this.#parts, look);
    this.mesh = new Mesh(new BufferGeometry(), surface);
    this.mesh.customDepthMaterial = depth;
    this.mesh.castShadow = shadow;
    this.mesh.receiveShadow = true;
    this.mesh.frustumCulled = false;
    this.mesh.raycast = (raycaster, hits) => this.#raycast(raycaster, hits);
    this.#reserve(capacity);
  }

  /** Adds a part; `owner` is an object whose `index` is kept at its place in the batch. */
  add(owner) {
    if (this.#owners.length === this.#capacity) this.#reserve(2 * this.#capacity);
    owner.index = this.#owners.length;
    this.#owners.push(owner);
    this.#showCount();
  }

  /** Takes a part away; the last one moves into its place. */
  remove(owner) {
    const moved = this.#owners.pop();
    this.#showCount();
    if (moved === owner) return;
    const data = this.#data;
    data.copyWithin(owner.index * STRIDE, moved.index * STRIDE, (moved.index + 1) * STRIDE);
    moved.index = owner.index;
    this.#owners[owner.index] = moved;
  }

  /** Places the part, whose matrix in the body is `matrix`, in the body whose pose is at `poses[p…]`. */
  place(owner, poses, p, matrix) {
    writePartRows(this.#data, owner.index * STRIDE, poses, p, matrix);
  }

  /** Gives the part a matrix of the world. @param {number[]} elements column by column */
  setMatrix(owner, elements) {
    writeRows(this.#data, owner.index * STRIDE, elements);
  }

  /** @param {number} rgb 0xRRGGBB */
  paint(owner, rgb) {
    this.paintColor(owner, color.setHex(rgb));
  }

  /** @param {Color} value */
  paintColor(owner, value) {
    value.toArray(this.#data, owner.index * STRIDE + COLOR);
  }

  dispose() {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.mesh.customDepthMaterial.dispose();
    this.#parts.value.dispose();
  }

  /** The numbers of all parts, about to change. */
  get #data() {
    this.#parts.value.needsUpdate = true;
    return this.#parts.value.image.data;
  }

  #showCount() {
    this.mesh.geometry.setDrawRange(0, this.#owners.length * this.#shape.index.count);
    this.mesh.visible = this.#owners.length > 0;
  }

  #reserve(capacity) {
    const rows = Math.ceil(capacity / PARTS_PER_ROW);
    const data = new Float32Array(rows * PARTS_PER_ROW * STRIDE);
    const old = this.#parts.value;
    if (old) data.set(old.image.data);
    old?.dispose();
    this.#parts.value = new DataTexture(data, PARTS_PER_ROW * TEXELS, rows, RGBAFormat, FloatType);
    this.#parts.value.needsUpdate = true;
    this.mesh.geometry.dispose();
    this.mesh.geometry = copies(this.#shape, capacity);
    this.#capacity = capacity;
    this.#showCount();
  }

  #raycast(raycaster, hits) {
    const probe = new Mesh(this.#shape, this.mesh.material);
    const found = [];
    const rows = this.#parts.value.image.data;
    for (const owner of this.#owners) {
      const o = owner.index * STRIDE;
      probe.matrixWorld.copy(new Matrix4(...rows.subarray(o, o + 12), 0, 0, 0, 1));
      probe.raycast(raycaster, found);
      for (const hit of found) hits.push({ ...hit, object: this.mesh, owner });
      found.length = 0;
    }
  }
}

/** The shape so many times, each vertex with the number of its copy. */
function copies(shape, count) {
  const { position, normal } = shape.attributes;
  const { array: index } = shape.index;
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', repeat(position, count));
  geometry.setAttribute('normal', repeat(normal, count));
  const part = new Float32Array(position.count * count);
  const indices = new Uint32Array(index.length * count);
  for (let i = 0; i < count; ++i) {
    part.fill(i, i * position.count, (i + 1) * position.count);
    for (let k = 0; k < index.length; ++k) indices[i * index.length + k] = index[k] + i * position.count;
  }
  geometry.setAttribute('part', new BufferAttribute(part, 1));
  geometry.setIndex(new BufferAttribute(indices, 1));
  return geometry;
}

function repeat({ array, itemSize }, count) {
  const all = new Float32Array(array.length * count);
  for (let i = 0; i < count; ++i) all.set(array, i * array.length);
  return new BufferAttribute(all, itemSize);
}
