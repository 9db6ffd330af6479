#include "model/joint_bodies.h"

namespace ragtop {

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& joint) -> const JointBodies& { return joint.bodies; }, def);
}

DVec3 jointCenter(const Bodies& bodies, const JointRecord& joint, std::uint32_t body) {
    if (body != 0) return bodies[body].center;
    const JointBodies& def = bodiesOf(joint.def);
    return DVec3((joint.bodyA == 0 ? def.frameA : def.frameB).position);
}

JointBodiesAtStep jointBodies(const Bodies& bodies, const JointRecord& joint) {
    const BodyRecord &a = bodies[joint.bodyA], &b = bodies[joint.bodyB];
    return {relative(jointCenter(bodies, joint, joint.bodyB), jointCenter(bodies, joint, joint.bodyA)),
            definitionRotation(a), definitionRotation(b)};
}

JointBodiesAtStep jointBodies(const Bodies& bodies, const Joints& joints, std::uint32_t index) {
    const JointSim& sim = joints.sims[index];
    if (sim.stateA == 0 || sim.stateB == 0) return jointBodies(bodies, joints[index]);
    const BodyRecord &a = bodies[sim.stateA], &b = bodies[sim.stateB];
    return {relative(b.center, a.center), definitionRotation(a), definitionRotation(b)};
}

}  // namespace ragtop
