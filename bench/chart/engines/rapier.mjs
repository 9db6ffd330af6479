// Rapier by npm's @dimforge/rapier3d-simd-compat, for `ragtop_bench chart --engine-command 'node rapier.mjs'`.
import { readFileSync } from 'node:fs';
import RAPIER from '@dimforge/rapier3d-simd-compat';
import { serve } from './protocol.mjs';

await RAPIER.init();
const packages = JSON.parse(readFileSync(new URL('package.json', import.meta.url)));

const xyz = ([x, y, z]) => ({ x, y, z });
const xyzw = ([x, y, z, w]) => ({ x, y, z, w });
/** The x axis of a frame. */
const axisOf = ({ rotation: [x, y, z, w] }) => [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)];
const list = ({ x, y, z }) => [x, y, z];

function geometryOf(shape) {
  switch (shape.type) {
    case 'box':
      return RAPIER.ColliderDesc.cuboid(...shape.half);
    case 'sphere':
      return RAPIER.ColliderDesc.ball(shape.radius);
    case 'capsule':
      return RAPIER.ColliderDesc.capsule(shape.half, shape.radius);
    default:
      return RAPIER.ColliderDesc.convexHull(new Float32Array(shape.vertices.flat()));
  }
}

class World {
  constructor(scene) {
    this.scene = scene;
    this.world = new RAPIER.World(xyz(scene.gravity));
    if (scene.iterations > 0) this.world.numSolverIterations = scene.iterations;
    this.bodies = scene.bodies.map((body) => this.makeBody(body));
    for (const joint of scene.joints) this.makeJoint(joint);
  }

  makeBody(body) {
    const makers = {
      fixed: () => RAPIER.RigidBodyDesc.fixed(),
      kinematic: () => RAPIER.RigidBodyDesc.kinematicVelocityBased(),
      dynamic: () => RAPIER.RigidBodyDesc.dynamic(),
    };
    const desc = makers[body.type]().setTranslation(...body.position).setRotation(xyzw(body.rotation)).setCanSleep(false);
    if (body.type !== 'fixed') desc.setLinvel(...body.v).setAngvel(xyz(body.w));
    if (body.type === 'dynamic')
      desc.setAdditionalMassProperties(body.mass, xyz(body.principal.position), xyz(body.moments), xyzw(body.principal.rotation));
    const made = this.world.createRigidBody(desc);
    for (const shape of body.shapes) {
      const collider = geometryOf(shape).setTranslation(...shape.position).setRotation(xyzw(shape.rotation)).setDensity(0)
        // Products of roots are the geometric mean.
        .setFriction(Math.sqrt(shape.friction)).setFrictionCombineRule(RAPIER.CoefficientCombineRule.Multiply)
        .setRestitution(shape.restitution).setRestitutionCombineRule(RAPIER.CoefficientCombineRule.Max);
      if (!shape.collides) collider.setCollisionGroups(0);
      this.world.createCollider(collider, made);
    }
    return made;
  }

  makeJoint(joint) {
    this.ground ??= this.world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
    const body = (index) => (index < 0 ? this.ground : this.bodies[index]);
    const [a, b] = [joint.frameA, joint.frameB].map(({ position }) => xyz(position));
    const data = joint.type === 'ball' ? RAPIER.JointData.spherical(a, b)
      : RAPIER.JointData.revoluteWithAxes(a, b, xyz(axisOf(joint.frameA)), xyz(axisOf(joint.frameB)));
    this.world.createImpulseJoint(data, body(joint.a), body(joint.b), true).setContactsEnabled(joint.collide);
  }

  step(dt, pushes) {
    this.world.timestep = dt / this.scene.substeps;
    for (const { body, force, point } of pushes) this.bodies[body].addForceAtPoint(xyz(force), xyz(point), true);
    for (let i = 0; i < this.scene.substeps; ++i) this.world.step();
    for (const { body } of pushes) this.bodies[body].resetForces(true);
  }

  setVelocity(index, v, w) {
    this.bodies[index].setLinvel(xyz(v), true);
    this.bodies[index].setAngvel(xyz(w), true);
  }

  state(index) {
    const body = this.bodies[index];
    const { x, y, z, w } = body.rotation();
    return [list(body.translation()), [x, y, z, w], list(body.linvel()), list(body.angvel())];
  }

  work() {
    return { passes: this.scene.substeps * this.world.numSolverIterations };
  }
}

await serve({
  name: 'rapier',
  version: packages.dependencies['@dimforge/rapier3d-simd-compat'],
  timed: false,
  substeps: [1],
  iterations: [4, 20],
  standard: { rate: 60, substeps: 1, iterations: 4 },
}, (scene) => new World(scene));
