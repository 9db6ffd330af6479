import { RecordingPlayer } from './recording_player.js';
import { Recording } from './recording.js';

/** A recording on the stage. */
export class RecordingShow {
  #recording;
  #changed = true;
  player;

  static async open(buffer) {
    return new RecordingShow(await Recording.parse(buffer));
  }

  constructor(recording) {
    this.#recording = recording;
    this.player = new RecordingPlayer(recording);
    this.player.on('change', () => {
      this.#changed = true;
    });
  }

  get object() {
    return this.#recording.object;
  }

  /** As the scene message of a running scene, as far as a recording knows. */
  get scene() {
    return { nodes: this.#recording.nodes.map(({ node, name }) => ({ node, name })) };
  }

  get extent() {
    return this.#recording.extent();
  }

  /** @param {number} elapsed s  @returns {boolean} whether anything has changed */
  advance(elapsed) {
    this.player.advance(elapsed);
    const changed = this.#changed;
    this.#changed = false;
    return changed;
  }

  /** Pose of the first thing that moves and has a name of its own. */
  followed() {
    const { node } = this.#recording.lead ?? {};
    return node === undefined ? null : this.#recording.pose(node);
  }

  poses() {
    return this.#recording.poses();
  }

  dispose() {
    this.#recording.dispose();
  }
}
