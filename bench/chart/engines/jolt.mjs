// Jolt by npm's jolt-physics, for `ragtop_bench chart --engine-command 'node jolt.mjs'`.
import { readFileSync } from 'node:fs';
import initJolt from 'jolt-physics/wasm-compat';
import { serve, Unsupported } from './protocol.mjs';

const packages = JSON.parse(readFileSync(new URL('package.json', import.meta.url)));
// What the library prints must not stand between answers.
const Jolt = await initJolt({ print: () => {}, printErr: () => {} });
const [FIXED, MOVING, GHOST] = [0, 1, 2];  // layers; ghosts touch nothing
const POSITION_STEPS = 2;

const vec = ([x, y, z]) => new Jolt.Vec3(x, y, z);
const rvec = ([x, y, z]) => new Jolt.RVec3(x, y, z);
const quat = ([x, y, z, w]) => new Jolt.Quat(x, y, z, w);
const list = (v) => [v.GetX(), v.GetY(), v.GetZ()];

function makeSystem() {
  const settings = new Jolt.JoltSettings();
  const pairs = new Jolt.ObjectLayerPairFilterTable(3);
  pairs.EnableCollision(FIXED, MOVING);
  pairs.EnableCollision(MOVING, MOVING);
  const phases = new Jolt.BroadPhaseLayerInterfaceTable(3, 3);
  for (const layer of [FIXED, MOVING, GHOST]) phases.MapObjectToBroadPhaseLayer(layer, new Jolt.BroadPhaseLayer(layer));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = phases;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(phases, 3, pairs, 3);
  return new Jolt.JoltInterface(settings);
}

function geometryOf(shape) {
  switch (shape.type) {
    case 'box':
      return new Jolt.BoxShape(vec(shape.half), Math.min(0.05, 0.1 * Math.min(...shape.half)));
    case 'sphere':
      return new Jolt.SphereShape(shape.radius);
    case 'capsule':
      return new Jolt.CapsuleShape(shape.half, shape.radius);
    default:
      throw new Unsupported(`a ${shape.type}`);
  }
}

const isZero = (numbers) => numbers.every((x) => x === 0);

class World {
  constructor(scene) {
    this.scene = scene;
    this.jolt = makeSystem();
    this.system = this.jolt.GetPhysicsSystem();
    this.system.SetGravity(vec(scene.gravity));
    const physics = this.system.GetPhysicsSettings();
    physics.mAllowSleeping = false;
    if (scene.iterations > 0) physics.mNumVelocitySteps = scene.iterations;
    physics.mNumPositionSteps = POSITION_STEPS;
    this.system.SetPhysicsSettings(physics);
    this.interface = this.system.GetBodyInterface();
    this.bodies = scene.bodies.map((body) => this.makeBody(body));
    for (const joint of scene.joints) this.makeJoint(joint);
  }

  makeBody(body) {
    const [shape] = body.shapes;
    if (body.shapes.length !== 1 || !isZero(shape.position) || !isZero(shape.rotation.slice(0, 3)))
      throw new Unsupported('bodies of several shapes, or of one off its frame');
    if (body.type === 'dynamic' && (!isZero(body.principal.position) || !isZero(body.principal.rotation.slice(0, 3))))
      throw new Unsupported('a centre of mass or principal axes off the frame');
    const motion = { fixed: Jolt.EMotionType_Static, kinematic: Jolt.EMotionType_Kinematic, dynamic: Jolt.EMotionType_Dynamic };
    const layer = !shape.collides ? GHOST : body.type === 'fixed' ? FIXED : MOVING;
    const settings = new Jolt.BodyCreationSettings(geometryOf(shape), rvec(body.position), quat(body.rotation), motion[body.type], layer);
    settings.mFriction = shape.friction;
    settings.mRestitution = shape.restitution;
    settings.mLinearDamping = settings.mAngularDamping = 0;
    settings.mAllowSleeping = false;
    settings.mMaxLinearVelocity = settings.mMaxAngularVelocity = 1e6;
    settings.mApplyGyroscopicForce = true;
    if (body.type === 'dynamic') {
      settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
      settings.mMassPropertiesOverride.mMass = body.mass;
      settings.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScale(vec(body.moments));
    }
    if (body.type !== 'fixed') {
      settings.mLinearVelocity = vec(body.v);
      settings.mAngularVelocity = vec(body.w);
    }
    const made = this.interface.CreateBody(settings);
    this.interface.AddBody(made.GetID(), body.type === 'fixed' ? Jolt.EActivation_DontActivate : Jolt.EActivation_Activate);
    return made;
  }

  makeJoint(joint) {
    if (joint.type !== 'ball') throw new Unsupported(`a ${joint.type}`);
    const touches = (index) => index >= 0 && this.scene.bodies[index].shapes.some(({ collides }) => collides);
    if (!joint.collide && touches(joint.a) && touches(joint.b)) throw new Unsupported('joined bodies that pass through each other');
    const body = (index) => (index < 0 ? Jolt.Body.prototype.sFixedToWorld : this.bodies[index]);
    const settings = new Jolt.PointConstraintSettings();
    settings.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
    settings.mPoint1 = rvec(joint.frameA.position);
    settings.mPoint2 = rvec(joint.frameB.position);
    this.system.AddConstraint(settings.Create(body(joint.a), body(joint.b)));
  }

  step(dt, pushes) {
    for (const { body, force, point } of pushes) this.interface.AddForce(this.bodies[body].GetID(), vec(force), rvec(point));
    this.jolt.Step(dt, this.scene.substeps);
  }

  setVelocity(index, v, w) {
    this.interface.SetLinearAndAngularVelocity(this.bodies[index].GetID(), vec(v), vec(w));
  }

  state(index) {
    const body = this.bodies[index];
    const q = body.GetRotation();
    return [list(body.GetPosition()), [q.GetX(), q.GetY(), q.GetZ(), q.GetW()], list(body.GetLinearVelocity()), list(body.GetAngularVelocity())];
  }

  work() {
    return { passes: this.scene.substeps * (this.scene.iterations + POSITION_STEPS) };
  }
}

await serve({
  name: 'jolt',
  version: packages.dependencies['jolt-physics'],
  timed: false,
  substeps: [1, 4],
  iterations: [10, 40],
  standard: { rate: 60, substeps: 1, iterations: 10 },
}, (scene) => new World(scene));
