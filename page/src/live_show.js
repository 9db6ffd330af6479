import { Group } from 'three';
import { ClothView } from './cloth_view.js';
import { DebugView } from './debug_view.js';
import { FrameClock } from './frame_clock.js';
import { gridUniforms } from './materials.js';
import { roadMarkings } from './roads.js';
import { SceneView } from './scene_view.js';
import { Visuals } from './visuals.js';

const GRID = 10; // m, the period of the grid on the ground
const LONGEST_FOLLOW = 60; // steps between frames that still are one motion

/** The running scene on the stage. */
export class LiveShow {
  #session;
  #toasts;
  #clock = new FrameClock();
  #debug = new DebugView();
  #visuals = null;
  #cloths = null;
  #shown = {}; // what debug drawing shows
  #changed = true; // is there anything to draw that was not drawn?
  view = null;
  step = 0; // of the last frame
  object = new Group();

  constructor(session, toasts) {
    this.#session = session;
    this.#toasts = toasts;
    session.on('scene', (scene) => this.#build(scene));
    session.on('nodes', (message) => this.#change(() => this.view?.change(message)));
    session.on('poses', (frame) => this.#receive(frame));
    session.on('points', (frame) => this.#change(() => this.#cloths?.receive(frame)));
    session.on('lines', (frame) => this.#change(() => this.#debug.receive(frame)));
    session.on('colors', (frame) => this.#change(() => this.view?.paint(frame)));
    session.on('status', (status) => this.#follow(status));
  }

  /** Brings the picture to now; whether anything has changed. @param {number} now ms */
  advance(now) {
    if (!this.view || !this.#changed) return false;
    const place = this.#session.status?.playing ? this.#clock.place(now) : 1;
    this.view.draw(place);
    this.#visuals.draw(this.view);
    this.#cloths.draw(place);
    this.#changed = place < 1;
    return true;
  }

  /** Pose of the body that cameras follow: the car while it is driven, the picked body, the car, a person. */
  followed({ chassis, active }) {
    const person = this.#session.scene?.ragdolls?.[0]?.parts[0]?.node;
    const candidates = [active ? chassis : null, this.#session.status?.picked, chassis, person];
    const node = candidates.find((each) => each !== null && each !== undefined);
    return node === undefined ? null : (this.view?.pose(node) ?? null);
  }

  /** The node whose body moves with this one: a wheel is part of its car. */
  holder(node) {
    return this.#session.scene.vehicles?.find(({ wheels }) => wheels.includes(node))?.chassis ?? node;
  }

  poses() {
    if (!this.#session.status?.playing) this.advance(Infinity);
    return this.view?.poses() ?? new Map();
  }

  #build(scene) {
    this.view?.dispose();
    this.#visuals?.dispose();
    this.#cloths?.dispose();
    this.#debug.clear();
    this.#shown = {};
    this.view = new SceneView(scene);
    this.#visuals = new Visuals();
    this.#cloths = new ClothView(scene.cloths ?? []);
    this.object.clear();
    this.object.add(this.view.object, this.#visuals.object, this.#cloths.object, this.#debug.object);
    if (scene.roads?.length > 0) this.object.add(roadMarkings(scene.roads));
    const [x, , z] = scene.origin;
    gridUniforms.gridOffset.value.set(x % GRID, z % GRID);
    this.#loadVisuals(scene.visuals ?? [], this.view);
    this.#changed = true;
  }

  /** @param {SceneView} view of the scene that they belong to; by the time they come there may be another one */
  #loadVisuals(visuals, view) {
    this.#visuals.load(visuals, {
      shown: () => this.#change(() => {}),
      missing: (nodes, why) =>
        this.#change(() => {
          view.uncover(nodes);
          this.#toasts.show('error', `Cannot show ${why}`);
        }),
    });
  }

  #receive(frame) {
    if (!this.view) return;
    const ahead = frame.step - this.step;
    this.#clock.receive(performance.now(), this.#session.status?.playing && ahead > 0 && ahead < LONGEST_FOLLOW);
    this.step = frame.step;
    this.#change(() => {
      this.view.receive(frame);
      this.#cloths.settle();
    });
  }

  #follow({ show = {} }) {
    if (!this.view || (show.shapes === this.#shown.shapes && show.islands === this.#shown.islands)) return;
    this.#shown = show;
    this.#change(() => {
      this.view.shapesVisible = Boolean(show.shapes);
      this.#visuals.object.visible = !show.shapes;
      if (!show.islands) this.view.unpaint();
    });
  }

  #change(act) {
    act();
    this.#changed = true;
  }
}
