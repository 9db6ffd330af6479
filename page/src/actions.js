import { Vector3 } from 'three';
import { CAMERA_MODES } from './cameras.js';
import { rayAt } from './picking.js';

const AHEAD = 0.6; // m in front of the eye, where a ball starts
const CLOSE = 5; // m from which a picked body is looked at

/** What keys and buttons can make the page do. */
export function makeActions({ session, showing, stage, rig, timeline, driving, hand, panels, canvas, cameras }) {
  const pointer = () => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return hand.pointer ?? { clientX: left + width / 2, clientY: top + height / 2 };
  };
  return {
    playOrPause: () => timeline.playOrPause(),
    step: (count) => timeline.player.step(count),
    reset: () => timeline.player.reset(),
    slower: () => timeline.changeSpeed(-1),
    faster: () => timeline.changeSpeed(1),
    nextCamera: () => cameras.choose(CAMERA_MODES[(CAMERA_MODES.indexOf(rig.mode) + 1) % CAMERA_MODES.length]),
    frame() {
      const pose = showing.followed(driving);
      if (pose) rig.frame([pose[0], pose[1], pose[2]], CLOSE);
      stage.requestDraw();
    },
    shoot() {
      const { origin, direction } = rayAt(stage.camera, canvas, pointer());
      const start = new Vector3().copy(origin).addScaledVector(direction, AHEAD);
      session.tell('shoot', { origin: start.toArray(), direction: direction.toArray() });
    },
    shift: (by) => driving.shift(by),
    shiftAutomatically: () => driving.shiftAutomatically(),
    resetVehicle: () => driving.resetVehicle(),
    nextVehicle: () => driving.nextVehicle(),
    togglePanels: () => panels.toggleAll(),
    letGo() {
      hand.release();
      if (session.status?.picked !== null) session.tell('pick', { node: null });
    },
  };
}
