import {
  AgXToneMapping,
  Color,
  DirectionalLight,
  Fog,
  HemisphereLight,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { LEVELS, Quality } from './quality.js';
import { makeSky, SKY } from './sky.js';

const SUN_HEIGHT = 0.95; // rad over the horizon
const SUN_ASIDE = 0.95; // rad from behind the reader's back to the left
const REST = 500; // ms without change after which a coarse picture is drawn once more in full

/** Draws the scene when something has changed, as fine as the machine can. */
export class Stage {
  #renderer;
  #sun = new DirectionalLight(SKY.sun, 2.5);
  #sky = makeSky();
  #quality;
  #fixedQuality;
  #software;
  #level = LEVELS[0];
  #dirty = true;
  #moved = true;
  #lastDrawn = 0;
  #drawnBefore = false; // in the last animation frame
  #sharp = false;
  #shadowRadius = 0;
  #towardsSun = new Vector3(0, 1, 0);
  draws = 0;
  drawing = true; // false: nothing is, and all that is asked for waits
  scene = new Scene();
  camera = new PerspectiveCamera(50, 1, 0.1, 1000);
  focus = new Vector3(); // what the shadows are finest around
  beforeFrame = () => {}; // called in each animation frame with the time, ms; asks for a draw where needed
  afterDraw = () => {};

  /** @param {HTMLCanvasElement} canvas  @param {?string} quality `high` keeps the finest picture at any speed */
  constructor(canvas, quality) {
    this.#software = isSoftware();
    this.#fixedQuality = quality === 'high';
    this.#renderer = new WebGLRenderer({ canvas, antialias: !this.#software || this.#fixedQuality });
    this.#renderer.toneMapping = AgXToneMapping;
    this.#renderer.toneMappingExposure = 1.25;
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = PCFShadowMap;
    this.#renderer.shadowMap.autoUpdate = false;
    this.scene.background = new Color(SKY.horizon);
    this.scene.fog = new Fog(SKY.horizon, 60, 220);
    this.scene.add(this.#sky, new HemisphereLight(SKY.fill, SKY.bounce, 1.9), this.#sun, this.#sun.target);
    this.#sun.castShadow = true;
    this.#sun.shadow.radius = 2.5;
    this.#sun.shadow.bias = -0.0004;
    this.restartQuality();
    new ResizeObserver(() => this.#resize(canvas.parentElement)).observe(canvas.parentElement);
    this.#resize(canvas.parentElement);
  }

  start() {
    this.#renderer.setAnimationLoop((now) => this.#frame(now));
  }

  /** The picture is out of date; `moved` when bodies, and so their shadows, are elsewhere. */
  requestDraw(moved = false) {
    this.#dirty = true;
    this.#moved ||= moved;
  }

  /** A new scene may be lighter than the one before: tries again how fine the picture can be. */
  restartQuality() {
    this.#quality = new Quality(this.#software && !this.#fixedQuality ? 1 : 0);
    this.#applyLevel();
  }

  /** Puts the sun where it lights well what is seen from the eye. */
  setSun(eye, target) {
    const azimuth = Math.atan2(eye[0] - target[0], eye[2] - target[2]) - SUN_ASIDE;
    this.#towardsSun.setFromSphericalCoords(1, Math.PI / 2 - SUN_HEIGHT, azimuth);
    this.#shadowRadius = 0;
    this.requestDraw(true);
  }

  /** Distances of fog and far plane for a scene of this extent, m. */
  setExtent(extent) {
    const reach = Math.max(extent, 60);
    this.scene.fog.near = reach;
    this.scene.fog.far = 4 * reach;
    this.camera.far = 8 * reach;
    this.camera.updateProjectionMatrix();
    this.#sky.scale.setScalar(this.camera.far * 0.9);
    this.requestDraw(true);
  }

  get level() {
    return this.#quality.level;
  }

  /** Nothing is asked for that is not drawn, as finely as it will be. */
  get settled() {
    return this.#sharp && !this.#dirty;
  }

  #frame(now) {
    this.beforeFrame(now);
    if (!this.drawing) return;
    if (!this.#dirty) {
      this.#drawnBefore = false;
      if (!this.#sharp && now - this.#lastDrawn > REST) this.#drawSharp();
      return;
    }
    if (this.#drawnBefore && !this.#fixedQuality && this.#quality.frame(now - this.#lastDrawn)) this.#applyLevel();
    else if (this.#sharp) this.#applyLevel();
    this.#sharp = this.#quality.level === 0;
    this.#draw();
    this.#lastDrawn = now;
    this.#drawnBefore = true;
  }

  #drawSharp() {
    this.#sharp = true;
    if (this.#quality.level <= 1) return;
    this.#applyLevel(LEVELS[1]);
    this.#draw();
  }

  #draw() {
    this.#dirty = false;
    this.#sky.position.copy(this.camera.position);
    this.#castShadows();
    this.#renderer.render(this.scene, this.camera);
    ++this.draws;
    this.afterDraw();
  }

  #castShadows() {
    const fitted = this.#fitShadow();
    const due = this.#moved && this.draws % this.#level.every === 0;
    if (!fitted && !due) return;
    this.#renderer.shadowMap.needsUpdate = true;
    this.#moved = false;
  }

  /** Keeps the shadow map around the focus, in whole texels so that edges of shadows stand still; true if it moved. */
  #fitShadow() {
    const light = this.#sun;
    const wanted = Math.min(Math.max(this.camera.position.distanceTo(this.focus) * 1.1, 6), 90);
    const radius = wanted > this.#shadowRadius || wanted < this.#shadowRadius / 1.5 ? wanted * 1.2 : this.#shadowRadius;
    const grain = (2 * radius) / light.shadow.mapSize.x;
    const snapped = this.focus
      .clone()
      .divideScalar(4 * grain)
      .round()
      .multiplyScalar(4 * grain);
    if (radius === this.#shadowRadius && snapped.equals(light.target.position)) return false;
    this.#shadowRadius = radius;
    light.target.position.copy(snapped);
    light.position
      .copy(this.#towardsSun)
      .multiplyScalar(3 * radius)
      .add(snapped);
    Object.assign(light.shadow.camera, {
      left: -radius,
      right: radius,
      top: radius,
      bottom: -radius,
      near: radius / 10,
      far: 6 * radius,
    });
    light.shadow.camera.updateProjectionMatrix();
    light.shadow.normalBias = 1.5 * grain;
    return true;
  }

  #applyLevel(level = LEVELS[this.#quality.level]) {
    this.#level = level;
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * level.ratio);
    this.#sun.castShadow = level.shadow > 0;
    if (level.shadow > 0 && this.#sun.shadow.mapSize.x !== level.shadow) {
      this.#sun.shadow.mapSize.setScalar(level.shadow);
      this.#sun.shadow.map?.dispose();
      this.#sun.shadow.map = null;
    }
    this.requestDraw(true);
  }

  #resize({ clientWidth, clientHeight }) {
    if (clientWidth === 0 || clientHeight === 0) return;
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.#renderer.setSize(clientWidth, clientHeight);
    this.requestDraw();
  }
}

/** Does the browser draw without a graphics card? */
function isSoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}
