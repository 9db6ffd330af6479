import { Group, Quaternion, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { clone } from 'three/addons/utils/SkeletonUtils.js';

const position = new Vector3();
const rotation = new Quaternion();

/** Skins and car meshes that stand in for the shapes of bodies: files whose nodes are moved by the bodies. */
export class Visuals {
  #files = new Map();
  #driven = []; // {object, node, scale}
  object = new Group();

  /**
   * Loads the visuals of a scene. Calls `missing(nodes, why)` for each one that cannot be shown, `shown()` for others.
   */
  load(visuals, { shown, missing }) {
    for (const visual of visuals) {
      this.#file(visual.url)
        .then((file) => this.#add(visual, file))
        .then(shown, (error) => missing(Object.values(visual.nodes), `${visual.url}: ${error.message}`));
    }
  }

  /** Moves everything to the poses as drawn. */
  draw(view) {
    for (const { object, node, scale } of this.#driven) {
      const pose = view.pose(node);
      if (pose) object.matrixWorld.compose(position.fromArray(pose), rotation.fromArray(pose, 3), scale);
    }
  }

  #file(url) {
    if (!this.#files.has(url)) this.#files.set(url, fetchFile(url));
    return this.#files.get(url);
  }

  #add(visual, { gltf, names }) {
    // A copy has the objects of the original in the same order.
    const copy = clone(gltf.scene);
    const originals = [];
    gltf.scene.traverse((object) => originals.push(object));
    const driven = [];
    let i = 0;
    copy.updateMatrixWorld(true);
    copy.traverse((object) => {
      const node = visual.nodes[names.get(originals[i++])];
      if (node !== undefined) driven.push(this.#drive(object, node));
      if (object.isMesh) {
        object.castShadow = object.receiveShadow = true;
        object.frustumCulled = false;
      }
    });
    if (driven.length === 0) throw new Error('it has none of the nodes that the scene names');
    this.#driven.push(...driven);
    this.object.add(copy);
  }

  /** From now on the object's place in the world is the body's; the size it has in the file stays. */
  #drive(object, node) {
    object.matrixWorldAutoUpdate = false;
    return { object, node, scale: new Vector3().setFromMatrixScale(object.matrixWorld) };
  }

  dispose() {
    this.object.traverse((object) => {
      object.geometry?.dispose();
      object.material?.dispose();
    });
  }
}

async function fetchFile(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`the program answers ${answer.status}`);
  return parseGltf(await answer.arrayBuffer());
}

/**
 * Reads a binary glTF file. three.js changes names to fit its animation system, so `names` keeps those of the file and
 * `indices` the numbers of the nodes there.
 */
export async function parseGltf(buffer) {
  const gltf = await new GLTFLoader().parseAsync(buffer, '');
  const names = new Map();
  const indices = new Map();
  for (const [object, { nodes }] of gltf.parser.associations) {
    if (nodes === undefined || !object.isObject3D) continue;
    names.set(object, gltf.parser.json.nodes[nodes].name);
    indices.set(object, nodes);
  }
  return { gltf, names, indices };
}
