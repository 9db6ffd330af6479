import { makeActions } from './actions.js';
import { publishApi } from './api.js';
import { BodyCard } from './body_card.js';
import { CameraButtons } from './camera_buttons.js';
import { CameraRig } from './cameras.js';
import { Connection } from './connection.js';
import { byId } from './dom.js';
import { Driving } from './driving.js';
import { acceptFiles } from './file_drop.js';
import { Hand } from './hand.js';
import { Instruments } from './instruments.js';
import { bindKeys } from './keys.js';
import { listScenes, listSwitches, Panels, showCounts } from './panels.js';
import { Plots } from './plots.js';
import { PickedMarker } from './picked_marker.js';
import { reportProblems } from './problems.js';
import { Session } from './session.js';
import { Showing } from './showing.js';
import { Stage } from './stage.js';
import { Timeline } from './timeline.js';
import { Toasts } from './toasts.js';
import { Tuning } from './tuning.js';

const LONGEST = 0.1; // s; a page that was away does not jump

// Opened from disk there is no program to connect to, only recordings to show.
const served = location.protocol.startsWith('http');
const canvas = byId('canvas');
const connection = new Connection(`ws://${location.host}/live`);
const session = new Session(connection);
const toasts = new Toasts();
reportProblems(session, toasts);
if (served) connection.open();

const panels = new Panels();
listScenes(session);
listSwitches(session);
showCounts(session);
const timeline = new Timeline();
const stage = makeStage();
const rig = new CameraRig(stage.camera, canvas);
const showing = new Showing({ session, stage, rig, timeline, toasts });
const driving = new Driving(session);
const cameras = new CameraButtons(rig);
const hand = new Hand(stage, canvas, {
  view: () => (showing.recording ? null : showing.live.view),
  holder: (node) => showing.live.holder(node),
  tell: (name, args) => session.tell(name, args),
});
session.on('scene', () => hand.forget());
session.on('connected', () => hand.forget());
const marker = new PickedMarker(stage.camera);
stage.scene.add(marker.object);
bindKeys(makeActions({ session, showing, stage, rig, timeline, driving, hand, panels, canvas, cameras }), driving);
acceptFiles((file) => showing.openFile(file));
driving.onTakeover = () => {
  if (rig.mode === 'orbit') cameras.choose('chase');
};
document.body.classList.toggle('served', served);

function makeStage() {
  try {
    return new Stage(canvas, new URLSearchParams(location.search).get('quality'));
  } catch (error) {
    toasts.show('error', `This browser cannot draw the scene: it has no WebGL 2 (${error.message})`, { stay: true });
    throw error;
  }
}

/** Plots, numbers and sliders, which can wait until there is a picture. */
let instruments = [];
function makeInstruments() {
  instruments = [
    new Plots(session, driving),
    new BodyCard(session),
    new Instruments(driving),
    new Tuning(session, toasts),
  ];
}

let before = performance.now();
stage.beforeFrame = (now) => {
  const elapsed = Math.min((now - before) / 1000, LONGEST);
  before = now;
  showing.advance(now, elapsed);
  hand.update();
  if (rig.update(showing.followed(driving), elapsed)) stage.requestDraw();
  stage.focus.copy(rig.target);
  if (marker.update(showing.picked())) stage.requestDraw();
  instruments.forEach((instrument) => instrument.update?.(now));
};

const ready = new Promise((resolve) => {
  const steps = new Set();
  stage.afterDraw = () => {
    if (served && !showing.live.view) return;
    steps.add(showing.live.step);
    if (steps.size === 1 && instruments.length === 0) {
      performance.mark('ragtop:first-picture');
      makeInstruments();
      resolve();
    }
    if (steps.size === 3) {
      performance.mark('ragtop:moving-picture');
      stage.afterDraw = () => {};
    }
  };
});
publishApi({ session, showing, rig, stage, ready });
stage.start();
