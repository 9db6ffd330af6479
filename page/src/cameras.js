import { Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { rotate } from './matrices.js';

export const CAMERA_MODES = ['orbit', 'follow', 'chase'];

const TURN_RATE = 3; // 1/s, how fast the chase camera comes round behind the car
const CHASE_DISTANCE = 7; // m
const CHASE_HEIGHT = 2.2; // m
const ABOVE = new Vector3(0, 0.7, 0); // m, where it looks, over the origin of the car
const FORWARD = [0, 0, 1];

/**
 * Moves the camera. In all modes the mouse orbits, pans and zooms; `follow` keeps up with a body, and `chase` turns
 * with it too.
 */
export class CameraRig {
  #camera;
  #mode = 'orbit';
  #last = null; // position of the body at the last update
  #heading = null; // rad, where the chase camera looks
  controls;

  constructor(camera, element) {
    this.#camera = camera;
    this.controls = new OrbitControls(camera, element);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = 0.53 * Math.PI;
    this.controls.minDistance = 0.3;
  }

  get mode() {
    return this.#mode;
  }

  set mode(mode) {
    this.#mode = mode;
    this.#last = this.#heading = null;
  }

  get target() {
    return this.controls.target;
  }

  /** Looks from a point at another one. */
  look(eye, target) {
    this.#camera.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.#last = this.#heading = null;
    this.controls.update();
  }

  /** Brings a point into the middle from `distance` m, in the direction it is seen from now. */
  frame(point, distance) {
    const direction = this.#camera.position.clone().sub(this.target).setLength(distance);
    this.look(direction.add(new Vector3(...point)).toArray(), point);
  }

  /** Pixels of the page where a point of the scene is seen. */
  project(point) {
    this.#camera.updateMatrixWorld();
    const { x, y } = new Vector3(...point).project(this.#camera);
    const { left, top, width, height } = this.controls.domElement.getBoundingClientRect();
    return [left + ((x + 1) / 2) * width, top + ((1 - y) / 2) * height];
  }

  /**
   * @param {?Float32Array} pose of the body to follow, if there is one
   * @param {number} elapsed s
   * @returns {boolean} whether the view has changed
   */
  update(pose, elapsed) {
    const before = this.#camera.matrix.clone();
    if (pose && this.#mode !== 'orbit') this.#follow(pose, elapsed);
    this.controls.update(elapsed);
    this.#camera.updateMatrix();
    return !this.#camera.matrix.equals(before);
  }

  #follow(pose, elapsed) {
    const at = new Vector3(pose[0], pose[1], pose[2]);
    if (this.#mode === 'chase') at.add(ABOVE);
    const entering = this.#last === null;
    const shift = at.clone().sub(entering ? this.target : this.#last);
    this.target.add(shift);
    this.#camera.position.add(shift);
    this.#last = at;
    if (this.#mode === 'chase') this.#turn(headingOf(pose), elapsed, entering);
  }

  #turn(heading, elapsed, entering) {
    if (heading === null) return;
    if (entering || this.#heading === null) {
      this.#heading = heading;
      const back = new Vector3(Math.sin(heading), 0, Math.cos(heading)).multiplyScalar(-CHASE_DISTANCE);
      this.#camera.position.copy(this.target).add(back).y += CHASE_HEIGHT;
      return;
    }
    const turn = wrap(heading - this.#heading) * (1 - Math.exp(-TURN_RATE * elapsed));
    this.#heading += turn;
    const offset = this.#camera.position.clone().sub(this.target).applyAxisAngle(this.#camera.up, turn);
    this.#camera.position.copy(this.target).add(offset);
  }
}

/** rad about y of a body's forward axis; null where that points up or down. */
function headingOf(pose) {
  const [x, , z] = rotate([pose[3], pose[4], pose[5], pose[6]], FORWARD);
  return Math.hypot(x, z) < 0.3 ? null : Math.atan2(x, z);
}

function wrap(angle) {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}
