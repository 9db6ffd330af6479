import { Mesh, MeshBasicMaterial, RingGeometry } from 'three';

const SIZE = 0.022; // of the distance to the eye

/** A ring around the picked body, over everything. */
export class PickedMarker {
  #camera;
  object = new Mesh(
    new RingGeometry(0.86, 1, 40),
    new MeshBasicMaterial({
      color: 0xffd9a0,
      depthTest: false,
      transparent: true,
      fog: false,
      toneMapped: false,
    }),
  );

  constructor(camera) {
    this.#camera = camera;
    this.object.renderOrder = 9;
    this.object.visible = false;
  }

  /** @param {?Float32Array} pose of the picked body, if there is one; @returns {boolean} whether it is news */
  update(pose) {
    const before = this.object.visible;
    this.object.visible = Boolean(pose);
    if (pose) {
      this.object.position.set(pose[0], pose[1], pose[2]);
      this.object.scale.setScalar(SIZE * this.object.position.distanceTo(this.#camera.position));
      this.object.quaternion.copy(this.#camera.quaternion);
    }
    return before !== this.object.visible;
  }
}
