import { Group } from 'three';
import { describeGeometry } from './geometries.js';
import { poseMatrix } from './matrices.js';
import { PartBatch } from './part_batch.js';
import { PoseStore } from './poses.js';
import { COLOR_STRIDE, OWN_COLOR } from './protocol.js';

const GROUND = 20; // m; what is static and larger stands on nothing, so its shadow is not seen

const CROWD = 300; // round shapes

/** The bodies of a live scene: which nodes there are, where they are drawn and in which colour. */
export class SceneView {
  #geometries = [];
  #batches = new Map();
  #nodes = new Map();
  #bySlot = [];
  #roads; // names of bodies that are roads, and have no grid
  #crowded; // are there so many round shapes that coarse ones must do?
  #skinned = new Group(); // shapes that a visual stands in for
  #poses = new PoseStore();
  object = new Group();

  /** @param {Object} scene the message of that type */
  constructor(scene) {
    this.object.add(this.#skinned);
    this.#skinned.visible = false;
    const isRound = ({ geometry }) => ['sphere', 'capsule'].includes(scene.geometries[geometry].kind);
    this.#roads = new Set(scene.roads?.map(({ name }) => name));
    this.#crowded = scene.nodes.flatMap(({ parts }) => parts).filter(isRound).length > CROWD;
    this.change({ geometries: scene.geometries, added: scene.nodes });
  }

  /** Takes a message of added and removed nodes. */
  change({ geometries = [], added = [], removed = [] }) {
    for (const geometry of geometries) {
      this.#geometries.push(describeGeometry(geometry, this.#geometries.length));
    }
    removed.forEach((node) => this.#remove(node));
    added.forEach((node) => this.#add(node));
  }

  receive(frame) {
    this.#poses.receive(frame);
  }

  /** Colours of a frame, which stay until another one comes. */
  paint({ ints, count }) {
    for (let i = 0; i < count; ++i) {
      const entry = this.#nodes.get(ints[i * COLOR_STRIDE]);
      const rgb = ints[i * COLOR_STRIDE + 1];
      if (entry) this.#paint(entry, rgb === OWN_COLOR ? entry.node.color : rgb);
    }
  }

  /** Gives every node its own colour again. */
  unpaint() {
    for (const entry of this.#nodes.values()) this.#paint(entry, entry.node.color);
  }

  /** Places everything at a time between the two last frames, 0 … 1. */
  draw(time) {
    this.#poses.draw(time, (slot) => {
      const entry = this.#bySlot[slot];
      for (const part of entry.parts) part.batch.place(part, this.#poses.drawn, slot * 7, part.matrix);
    });
  }

  /** Shows or hides the shapes under skins. */
  set shapesVisible(visible) {
    this.#skinned.visible = visible;
  }

  /** Draws a node's own shapes after all, because its visual is missing. */
  uncover(nodes) {
    for (const id of nodes) {
      const { node } = this.#nodes.get(id) ?? {};
      if (!node?.hidden) continue;
      const pose = [...this.pose(id)];
      this.#remove(id);
      this.#add({ ...node, pose, hidden: false });
    }
  }

  node(id) {
    return this.#nodes.get(id)?.node;
  }

  /** The pose of a node as drawn: seven numbers, valid until the next draw. */
  pose(id) {
    return this.#poses.pose(id);
  }

  poses() {
    return new Map([...this.#poses.nodes()].map((id) => [id, [...this.#poses.pose(id)]]));
  }

  /** Meshes for a ray, hidden ones included. */
  targets() {
    return [...this.#batches.values()].map((batch) => batch.mesh);
  }

  dispose() {
    for (const batch of this.#batches.values()) batch.dispose();
  }

  #add(node) {
    this.#remove(node.node);
    const slot = this.#poses.add(node.node, node.pose);
    const entry = { node, slot, parts: node.parts.map((part) => this.#makePart(node, part)) };
    this.#nodes.set(node.node, entry);
    this.#bySlot[slot] = entry;
    this.#paint(entry, node.color);
  }

  #makePart(node, { geometry, position, rotation }) {
    const described = this.#geometries[geometry];
    const matrix = poseMatrix([...position, ...rotation], described.scale);
    const part = { node: node.node, batch: this.#batch(described, node), matrix };
    part.batch.add(part);
    return part;
  }

  #batch({ key, size, make }, node) {
    const fixed = node.type === 'static';
    const ground = fixed && size > GROUND;
    const road = this.#roads.has(node.name);
    const name = `${key} ${fixed} ${ground} ${road} ${Boolean(node.hidden)}`;
    if (!this.#batches.has(name)) {
      const look = { edges: key === 'box' && !fixed, grid: fixed && !road, shadow: !ground };
      const batch = new PartBatch(make(this.#crowded), look);
      (node.hidden ? this.#skinned : this.object).add(batch.mesh);
      this.#batches.set(name, batch);
    }
    return this.#batches.get(name);
  }

  #remove(id) {
    const entry = this.#nodes.get(id);
    if (!entry) return;
    for (const part of entry.parts) part.batch.remove(part);
    this.#nodes.delete(id);
    this.#poses.remove(id);
  }

  #paint(entry, rgb) {
    for (const part of entry.parts) part.batch.paint(part, rgb);
  }
}
