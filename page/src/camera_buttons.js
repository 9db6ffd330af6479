import { CAMERA_MODES } from './cameras.js';
import { byId, el } from './dom.js';

const MEANINGS = {
  orbit: 'stand still; drag to turn, right button to move, wheel to zoom',
  follow: 'keep up with the picked body or the car',
  chase: 'stay behind the car',
};

/** The buttons that choose the camera. */
export class CameraButtons {
  #rig;
  #buttons;

  constructor(rig) {
    this.#rig = rig;
    this.#buttons = CAMERA_MODES.map((mode) =>
      el(
        'button',
        {
          dataset: { camera: mode },
          title: `${MEANINGS[mode]} (C)`,
          onclick: () => this.choose(mode),
        },
        mode,
      ),
    );
    byId('cameras').append(...this.#buttons);
    this.choose('orbit');
  }

  choose(mode) {
    this.#rig.mode = mode;
    for (const button of this.#buttons) button.setAttribute('aria-pressed', String(button.dataset.camera === mode));
  }
}
