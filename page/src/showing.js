import { byId, setText } from './dom.js';
import { LivePlayer } from './live_player.js';
import { LiveShow } from './live_show.js';
import { RecordingShow } from './recording_show.js';

const NEAR = 60; // m, the least that is in sight

/** What is on the stage: the running scene, or a recording instead of it. */
export class Showing {
  #session;
  #stage;
  #rig;
  #timeline;
  #toasts;
  #player;
  #sceneName = null;
  live;
  recording = null;

  constructor({ session, stage, rig, timeline, toasts }) {
    Object.assign(this, { live: new LiveShow(session, toasts) });
    this.#session = session;
    this.#stage = stage;
    this.#rig = rig;
    this.#timeline = timeline;
    this.#toasts = toasts;
    this.#player = new LivePlayer(session);
    timeline.player = this.#player;
    stage.scene.add(this.live.object);
    session.on('scene', (scene) => this.#lookAt(scene));
    byId('back-to-live').addEventListener('click', () => this.closeRecording());
  }

  /** Shows a recording, a binary glTF file. Rejects when it is none. @param {ArrayBuffer} buffer */
  async openRecording(buffer, name = 'recording') {
    const show = await RecordingShow.open(buffer);
    this.closeRecording();
    this.recording = show;
    this.live.object.visible = false;
    this.#stage.scene.add(show.object);
    this.#timeline.player = show.player;
    const { center, size } = show.extent;
    const eye = [center.x - 0.5 * size, center.y + 0.35 * size, center.z - 0.65 * size];
    this.#rig.look(eye, center.toArray());
    this.#stage.setSun(eye, center.toArray());
    this.#stage.restartQuality();
    this.#stage.setExtent(1.5 * size);
    this.#caption(name, 'a recording', true);
  }

  /** Back to the running scene. */
  closeRecording() {
    if (!this.recording) return;
    this.#stage.scene.remove(this.recording.object);
    this.recording.dispose();
    this.recording = null;
    this.live.object.visible = true;
    this.#timeline.player = this.#player;
    const { scene } = this.#session;
    this.#caption(scene?.name ?? '', scene?.description ?? '', false);
    if (scene) this.#aim(scene);
  }

  /** Opens a file that the reader has chosen, and says so when it cannot be read. @param {File} file */
  async openFile(file) {
    try {
      await this.openRecording(await file.arrayBuffer(), file.name);
    } catch (error) {
      this.#toasts.show('error', `${file.name} is not a recording: ${error.message}`);
    }
  }

  /** Brings the stage to now. @param {number} now ms  @param {number} elapsed s */
  advance(now, elapsed) {
    const changed = this.recording ? this.recording.advance(elapsed) : this.live.advance(now);
    if (changed) this.#stage.requestDraw(true);
  }

  /** Pose of what cameras follow. @param {Driving} driving */
  followed(driving) {
    return (this.recording ?? this.live).followed(driving);
  }

  /** Pose of the picked body, if there is one. */
  picked() {
    const picked = this.#session.status?.picked ?? null;
    return this.recording || picked === null ? null : this.live.view?.pose(picked);
  }

  poses() {
    return (this.recording ?? this.live).poses();
  }

  /** A scene that is made anew keeps the view of the reader. */
  #lookAt(scene) {
    if (this.recording || scene.name === this.#sceneName) return;
    this.#sceneName = scene.name;
    this.#aim(scene);
    this.#caption(scene.name, scene.description ?? '', false);
  }

  #aim({ camera, nodes }) {
    this.#rig.look(camera.eye, camera.target);
    this.#stage.setSun(camera.eye, camera.target);
    this.#stage.restartQuality();
    const away = nodes
      .filter(({ type }) => type !== 'static')
      .map(({ pose }) => Math.hypot(pose[0] - camera.target[0], pose[2] - camera.target[2]));
    this.#stage.setExtent(Math.max(NEAR, 1.5 * Math.max(0, ...away)));
  }

  #caption(name, description, recorded) {
    document.title = name ? `${name} – Ragtop` : 'Ragtop';
    setText(byId('scene-name'), name);
    setText(byId('scene-description'), description);
    byId('back-to-live').hidden = !recorded || !this.#session.scene;
    document.body.classList.toggle('recorded', recorded);
  }
}
