/**
 * `window.ragtop`: the page for scripts and tests. What a person does by mouse and key, they do by `do`; what a person
 * sees, they read from `status`, `telemetry` and `poses()`.
 */
export function publishApi({ session, showing, rig, stage, ready }) {
  window.ragtop = {
    /** Resolves when there is something to see, or, without a program, when the page can take a recording. */
    ready,
    /** Asks the program; resolves to its answer, rejects with its error. */
    do: (name, args) => session.ask(name, args),
    get status() {
      return session.status;
    },
    get scene() {
      return showing.recording?.scene ?? session.scene;
    },
    get telemetry() {
      return session.telemetry;
    },
    get tunables() {
      return session.tunables;
    },
    get connected() {
      return session.connected;
    },
    get framesReceived() {
      return session.framesReceived;
    },
    /** Step of the poses received last. */
    get step() {
      return showing.live.step;
    },
    /** Node → [x, y, z, qx, qy, qz, qw] as drawn; exactly as received while the program is paused. */
    poses: () => showing.poses(),
    loadRecording: (buffer) => showing.openRecording(buffer),
    /** s; stops there. */
    seekRecording: (time) => showing.recording?.player.seek(time),
    get recording() {
      const { first, last, at, unit } = showing.recording?.player.state ?? {};
      return showing.recording ? { first, last, at, frameTime: unit } : null;
    },
    camera: {
      get mode() {
        return rig.mode;
      },
      set mode(mode) {
        rig.mode = mode;
      },
      get eye() {
        return stage.camera.position.toArray();
      },
      get target() {
        return rig.target.toArray();
      },
      look(eye, target) {
        rig.look(eye, target);
        stage.requestDraw();
      },
      /** Pixels of the page, from the top left corner, where a point of the scene is seen. */
      project: (point) => rig.project(point),
    },
    /** Pictures drawn so far, and how coarse they are: 0 is the finest. */
    get draws() {
      return stage.draws;
    },
    /** Whether the picture is of what has been received, as finely as it will be drawn. */
    get settled() {
      return stage.settled;
    },
    get quality() {
      return stage.level;
    },
    /** False: nothing is drawn until it is true again; for those who want one picture, not those on the way to it. */
    get drawing() {
      return stage.drawing;
    },
    set drawing(on) {
      stage.drawing = on;
    },
  };
}
