import { AnimationMixer, Box3, Group, Vector3 } from 'three';
import { withNormals } from './geometries.js';
import { PartBatch } from './part_batch.js';
import { parseGltf } from './visuals.js';

const FEW = 4; // meshes of one shape and colour that are drawn one by one

/** A recorded run: a glTF file with animation, as `ragtop run` writes it, or any other one. */
export class Recording {
  #gltf;
  #mixer;
  #animated; // names of the objects that move
  #parts = []; // {batch, index, object}
  #batches = [];
  nodes = []; // {node: number in the file, name, object} at the top of the file
  object = new Group();

  /** Reads a file; throws an Error when it is no binary glTF. */
  static async parse(buffer) {
    const magic = new TextDecoder().decode(buffer.slice(0, 4));
    if (magic !== 'glTF') throw new Error('it is not binary glTF (.glb)');
    return new Recording(await parseGltf(buffer));
  }

  constructor({ gltf, names, indices }) {
    this.#gltf = gltf;
    const tracks = gltf.animations.flatMap((clip) => clip.tracks);
    this.#animated = new Set(tracks.map(({ name }) => name.slice(0, name.lastIndexOf('.'))));
    for (const child of gltf.scene.children) {
      if (indices.has(child))
        this.nodes.push({ node: indices.get(child), name: names.get(child) ?? '', object: child });
    }
    this.object.add(gltf.scene);
    this.#mixer = new AnimationMixer(gltf.scene);
    gltf.animations.forEach((clip) => this.#mixer.clipAction(clip).play());
    this.seek(0);
    this.#drawTogether();
    this.seek(0);
  }

  /** s */
  get duration() {
    return Math.max(0, ...this.#gltf.animations.map((clip) => clip.duration));
  }

  /** s between the frames of the finest track. */
  get frameTime() {
    let shortest = Infinity;
    for (const clip of this.#gltf.animations) {
      for (const { times } of clip.tracks) {
        for (let i = 1; i < times.length; ++i) shortest = Math.min(shortest, times[i] - times[i - 1]);
      }
    }
    return Number.isFinite(shortest) && shortest > 1e-4 ? shortest : 1 / 30;
  }

  /** Shows the time, s. */
  seek(time) {
    // An action that has come to its end starts again; a hair before it, it holds the last frame.
    this.#mixer.setTime(Math.min(Math.max(time, 0), this.duration * (1 - 1e-9)));
    this.#gltf.scene.updateMatrixWorld(true);
    for (const part of this.#parts) part.batch.setMatrix(part, part.object.matrixWorld.elements);
  }

  /** The pose of a node at the top of the file, as drawn. */
  pose(node) {
    const { object } = this.nodes.find((entry) => entry.node === node);
    return [...object.position.toArray(), ...object.quaternion.toArray()];
  }

  poses() {
    return new Map(this.nodes.map(({ node }) => [node, this.pose(node)]));
  }

  /** The first node that moves and has a name of its own, else the first that moves. */
  get lead() {
    const moving = this.nodes.filter(({ object }) => !this.#isStill(object));
    return moving.find(({ name }) => !/^(body|brick|box)\b/.test(name)) ?? moving[0];
  }

  /** Where most of what is there happens: middle and size, m. */
  extent() {
    const moving = this.nodes.filter(({ object }) => !this.#isStill(object));
    const box = new Box3();
    for (const time of [0, this.duration / 3]) {
      this.seek(time);
      for (const { object } of moving.length > 0 ? moving : this.nodes) {
        if (object.scale.x > 0) box.expandByPoint(object.position);
      }
    }
    this.seek(0);
    return { center: box.getCenter(new Vector3()), size: Math.max(box.getSize(new Vector3()).length(), 4) };
  }

  dispose() {
    this.#mixer.stopAllAction();
    this.#batches.forEach((batch) => batch.dispose());
  }

  #isStill(object) {
    return !this.#animated.has(object.name || object.uuid);
  }

  /** Draws all meshes of one shape by one call; a house of two thousand bricks needs it. */
  #drawTogether() {
    const groups = new Map();
    this.#gltf.scene.traverse((object) => {
      if (!object.isMesh) return;
      object.castShadow = object.receiveShadow = true;
      if (object.isSkinnedMesh || object.material.map || object.geometry.attributes.color) return;
      const still = this.#isStill(rootOf(object, this.#gltf.scene));
      const key = `${object.geometry.attributes.position.uuid ?? object.geometry.uuid} ${still}`;
      if (!groups.has(key)) groups.set(key, { still, objects: [] });
      groups.get(key).objects.push(object);
    });
    for (const { still, objects } of groups.values()) {
      if (objects.length > FEW || still) this.#makeBatch(objects, still);
    }
  }

  #makeBatch(objects, still) {
    const geometry = withNormals(objects[0].geometry);
    const isBox = geometry.attributes.position.count === 24;
    const batch = new PartBatch(geometry, { edges: isBox && !still, grid: still, shadow: !still }, objects.length);
    for (const object of objects) {
      const part = { batch, object };
      batch.add(part);
      batch.paintColor(part, object.material.color);
      object.visible = false;
      this.#parts.push(part);
    }
    this.#batches.push(batch);
    this.object.add(batch.mesh);
  }
}

function rootOf(object, scene) {
  while (object.parent !== scene) object = object.parent;
  return object;
}
