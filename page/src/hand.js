import { CylinderGeometry, Group, Mesh, MeshBasicMaterial, Plane, SphereGeometry, Vector3 } from 'three';
import { toLocal, toWorld } from './matrices.js';
import { pick, rayAt } from './picking.js';

const CLICK = 4; // px; a pointer that moves less has clicked
const UP = new Vector3(0, 1, 0);

/** The spring between the pointer and the body that it holds. */
class SpringLine {
  #line;
  #ends;
  object = new Group();

  constructor() {
    const material = new MeshBasicMaterial({
      color: 0xe2572b,
      depthTest: false,
      transparent: true,
      fog: false,
      toneMapped: false,
    });
    this.#line = new Mesh(new CylinderGeometry(1, 1, 1, 8), material);
    this.#ends = [0, 1].map(() => new Mesh(new SphereGeometry(1, 12, 8), material));
    this.object.add(this.#line, ...this.#ends);
    this.object.renderOrder = 10;
    this.object.visible = false;
  }

  /** @param {Vector3} from  @param {Vector3} to  @param {number} thickness m */
  show(from, to, thickness) {
    const along = to.clone().sub(from);
    const length = Math.max(along.length(), 1e-6);
    this.#line.position.copy(from).addScaledVector(along, 0.5);
    this.#line.scale.set(thickness, length, thickness);
    this.#line.quaternion.setFromUnitVectors(UP, along.divideScalar(length));
    this.#ends[0].position.copy(from);
    this.#ends[1].position.copy(to);
    this.#ends.forEach((end) => end.scale.setScalar(2.5 * thickness));
    this.object.visible = true;
  }

  hide() {
    this.object.visible = false;
  }
}

/**
 * The mouse on the scene: a click picks a body, dragging one grabs it by a spring until the button is up, and the wheel
 * brings it nearer meanwhile. Everything else is left to the camera.
 */
export class Hand {
  #stage;
  #canvas;
  #host;
  #spring = new SpringLine();
  #pressed = null; // {hit, x, y, id} while the button is down
  #held = null; // {node, local, plane, target} while a body is held
  #unsent = false;
  pointer = null; // last place over the scene

  /**
   * @param {Stage} stage  @param {HTMLCanvasElement} canvas
   * @param {{view: function(): ?SceneView, holder: function(number): number, tell: function}} host `holder` names the
   *   node whose body a node moves with: a wheel has none of its own
   */
  constructor(stage, canvas, host) {
    this.#stage = stage;
    this.#canvas = canvas;
    this.#host = host;
    stage.scene.add(this.#spring.object);
    // Before the camera's own listeners, which are on the canvas itself.
    const outer = canvas.parentElement;
    outer.addEventListener('pointerdown', (event) => this.#down(event), true);
    outer.addEventListener('pointermove', (event) => this.#move(event), true);
    outer.addEventListener('pointerup', (event) => this.#up(event), true);
    outer.addEventListener('pointercancel', (event) => this.#up(event), true);
    outer.addEventListener('wheel', (event) => this.#wheel(event), { capture: true, passive: false });
  }

  /** Sends where the pointer is and draws the spring; call once per frame. */
  update() {
    if (!this.#held) return;
    if (this.#unsent) this.#host.tell('drag', { target: this.#held.target.toArray() });
    this.#unsent = false;
    this.#drawSpring();
  }

  /** Lets go. */
  release() {
    if (this.#held) this.#host.tell('release');
    this.forget();
  }

  /** Holds nothing any more: the program has let go by itself. */
  forget() {
    this.#held = this.#pressed = null;
    this.#spring.hide();
    this.#stage.requestDraw();
  }

  #down(event) {
    if (event.target !== this.#canvas || event.button !== 0) return;
    const view = this.#host.view();
    const hit = view && pick(view, this.#stage.camera, this.#canvas, event);
    this.#pressed = { hit, x: event.clientX, y: event.clientY, id: event.pointerId };
    if (!hit || hit.node.type === 'static') return;
    event.stopPropagation();
    this.#canvas.setPointerCapture(event.pointerId);
  }

  #move(event) {
    if (event.target === this.#canvas) this.pointer = { clientX: event.clientX, clientY: event.clientY };
    if (this.#held) {
      event.stopPropagation();
      this.#dragTo(event);
    } else if (this.#pressed?.hit && this.#moved(event) && this.#pressed.hit.node.type !== 'static') {
      this.#grab(event);
    }
  }

  #up(event) {
    if (this.#pressed?.id !== event.pointerId) return;
    if (!this.#held && event.type === 'pointerup' && !this.#moved(event)) {
      const node = this.#pressed.hit?.node;
      this.#host.tell('pick', { node: node && node.type !== 'static' ? this.#host.holder(node.node) : null });
    }
    this.release();
  }

  #moved(event) {
    return Math.hypot(event.clientX - this.#pressed.x, event.clientY - this.#pressed.y) > CLICK;
  }

  #grab(event) {
    const { hit } = this.#pressed;
    const view = this.#host.view();
    const held = this.#host.holder(hit.node.node);
    const facing = this.#stage.camera.getWorldDirection(new Vector3()).negate();
    const plane = new Plane().setFromNormalAndCoplanarPoint(facing, hit.point);
    const local = held === hit.node.node ? hit.local : toLocal(view.pose(held), hit.point.toArray());
    this.#held = { node: held, local, plane, target: hit.point.clone() };
    this.#host.tell('grab', { node: held, point: local, target: hit.point.toArray() });
    this.#dragTo(event);
  }

  #dragTo(event) {
    const ray = rayAt(this.#stage.camera, this.#canvas, event);
    if (ray.intersectPlane(this.#held.plane, this.#held.target)) this.#unsent = true;
  }

  #wheel(event) {
    if (!this.#held) return;
    event.preventDefault();
    event.stopPropagation();
    const { camera } = this.#stage;
    const away = this.#held.target
      .clone()
      .sub(camera.position)
      .multiplyScalar(event.deltaY > 0 ? 1.08 : 1 / 1.08);
    this.#held.target.copy(camera.position).add(away);
    this.#held.plane.setFromNormalAndCoplanarPoint(this.#held.plane.normal, this.#held.target);
    this.#unsent = true;
  }

  #drawSpring() {
    const pose = this.#host.view()?.pose(this.#held.node);
    if (!pose) return this.forget();
    const from = new Vector3(...toWorld(pose, this.#held.local));
    const distance = from.distanceTo(this.#stage.camera.position);
    this.#spring.show(from, this.#held.target, Math.max(0.0022 * distance, 0.002));
    this.#stage.requestDraw();
  }
}
