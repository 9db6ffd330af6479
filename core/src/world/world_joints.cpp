#include <algorithm>
#include <stdexcept>
#include <string>

#include "model/edge_list.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& joint) -> const JointBodies& { return joint.bodies; }, def);
}

}  // namespace

/// Of one of a joint's bodies. The world as a body has its centre at the joint's frame, so that nothing large is
/// rounded.
DVec3 WorldImpl::jointCenter(const JointRecord& joint, std::uint32_t body) const {
    if (body != 0) return bodies[body].center;
    const JointBodies& def = bodiesOf(joint.def);
    return DVec3((joint.bodyA == 0 ? def.frameA : def.frameB).position);
}

/// Of two bodies that have states the record is not needed, which lies by itself.
JointBodiesAtStep WorldImpl::jointBodies(std::uint32_t index) const {
    const JointSim& sim = joints.sims[index];
    if (sim.stateA == 0 || sim.stateB == 0) return jointBodies(joints[index]);
    const BodyRecord &a = bodies[sim.stateA], &b = bodies[sim.stateB];
    return {relative(b.center, a.center), definitionRotation(a), definitionRotation(b)};
}

JointBodiesAtStep WorldImpl::jointBodies(const JointRecord& joint) const {
    const BodyRecord &a = bodies[joint.bodyA], &b = bodies[joint.bodyB];
    return {relative(jointCenter(joint, joint.bodyB), jointCenter(joint, joint.bodyA)), definitionRotation(a),
            definitionRotation(b)};
}

std::uint32_t WorldImpl::createJoint(const JointDef& def) {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    const JointBodies& joined = bodiesOf(def);
    const auto bodyIndex = [&](BodyId id, const char* name) {
        if (id.isNull()) return std::uint32_t{0};
        if (!bodies.slots.isValid(id.index, id.generation))
            throw std::invalid_argument(std::string("bodies.") + name + " names no body of this world");
        return id.index;
    };
    const std::uint32_t a = bodyIndex(joined.a, "a"), b = bodyIndex(joined.b, "b");
    if (bodies.typeOf(a) != BodyType::dynamic && bodies.typeOf(b) != BodyType::dynamic)
        throw std::invalid_argument("bodies.a and bodies.b: at least one must be dynamic");

    const std::uint32_t index = joints.acquire();
    JointRecord& joint = joints[index];
    joint.def = def;
    joint.bodyA = a;
    joint.bodyB = b;
    JointSim& sim = joints.sims[index];
    sim.stateA = bodies[a].state;
    sim.stateB = bodies[b].state;
    compile(index);
    // Bodies that were in contact and no longer collide lose that contact.
    if (!joined.collide)
        for (std::uint32_t key = bodies[a].firstContact; key != kNone;) {
            const std::uint32_t next = contacts.next(key);
            const ContactRecord& contact = contacts[key >> 1];
            if (contact.bodyA == b || contact.bodyB == b) destroyContact(key >> 1);
            key = next;
        }
    link(joints, bodies[a].firstJoint, 2 * index);
    link(joints, bodies[b].firstJoint, 2 * index + 1);
    ++structureVersion;
    const bool awakeA = bodies.moves(a) && bodies.isAwake(a), awakeB = bodies.moves(b) && bodies.isAwake(b);
    if (bodies.moves(a) && !awakeA) wakeBody(a);
    if (bodies.moves(b) && !awakeB) wakeBody(b);
    unfreeze(a), unfreeze(b);
    addJointToGraph(index);
    if (mayHold(joint)) joints.created.push(index);
    islands.structureChanged = true;
    return index;
}

/// The solver's form of a joint, from its definition and the centres of its bodies.
void WorldImpl::compile(std::uint32_t index) {
    const JointRecord& joint = joints[index];
    const JointBodies& joined = bodiesOf(joint.def);
    compileJoint(joint.def, joint.bodyA == 0 ? joined.frameA.position : bodies[joint.bodyA].local.position,
                 joint.bodyB == 0 ? joined.frameB.position : bodies[joint.bodyB].local.position, joints.sims[index]);
    joints.bundlesChanged = directSet.treesChanged = true;
}

void WorldImpl::destroyJoint(std::uint32_t index) {
    JointRecord& joint = joints[index];
    while (joint.firstCoupling != kNone) destroyCoupling(joint.firstCoupling / CouplingDef::kMostParts);
    if (bodies.moves(joint.bodyA)) wakeBody(joint.bodyA);
    if (bodies.moves(joint.bodyB)) wakeBody(joint.bodyB);
    removeJointFromGraph(index);
    unlink(joints, bodies[joint.bodyA].firstJoint, 2 * index);
    unlink(joints, bodies[joint.bodyB].firstJoint, 2 * index + 1);
    const bool collided = bodiesOf(joint.def).collide;
    joints.release(index);
    ++structureVersion;
    articulations.forget();  // also where the joint held nothing, and was in no list of the graph
    if (collided) return;
    // The bodies may collide from now on: their shapes look for partners again.
    for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
        for (std::uint32_t s = bodies[body].firstShape; s != kNone; s = shapes[s].next) shapeBounds().markMoved(s);
}

/// In the order of their ids, so that events depend on the scene alone.
void WorldImpl::breakJoints() {
    joints.broken.clear();
    for (int c = 0; c < graph.listCount(); ++c)
        for (const std::uint32_t j : graph.color(c).joints) {
            if (joints.sims[j].breakable == 0) continue;
            const JointBodies& bound = bodiesOf(joints[j].def);
            const PairVector& impulse = joints.sims[j].stepImpulse;
            if (length(impulse.linear) > bound.breakForce * dt || length(impulse.angular) > bound.breakTorque * dt)
                joints.broken.push_back(j);
        }
    std::sort(joints.broken.begin(), joints.broken.end());
    for (const std::uint32_t j : joints.broken) {
        const JointBodies bound = bodiesOf(joints[j].def);
        const PairVector& impulse = joints.sims[j].stepImpulse;
        events.jointBreak(
            {joints.id(j), bound.a, bound.b, bound.userData, (1 / dt) * impulse.linear, (1 / dt) * impulse.angular});
        destroyJoint(j);
    }
}

void WorldImpl::addJointToGraph(std::uint32_t index) {
    JointRecord& joint = joints[index];
    const bool movesA = bodies.moves(joint.bodyA), movesB = bodies.moves(joint.bodyB);
    if (joint.place.color != kNone || !mayHold(joint)) return;
    if ((movesA && !bodies.isAwake(joint.bodyA)) || (movesB && !bodies.isAwake(joint.bodyB))) return;
    joint.place = graph.insertJoint(index, bodies[joint.bodyA].state, movesA, bodies[joint.bodyB].state, movesB,
                                    bodies.isDirect(joint.bodyA) || bodies.isDirect(joint.bodyB));
    recordGraphChange(joint.place);
    joints.bundlesChanged = directSet.treesChanged = true;
}

void WorldImpl::removeJointFromGraph(std::uint32_t index) {
    JointRecord& joint = joints[index];
    if (joint.place.color == kNone) return;
    const std::uint32_t moved = graph.removeJoint(joint.place, bodies[joint.bodyA].state, bodies.moves(joint.bodyA),
                                                  bodies[joint.bodyB].state, bodies.moves(joint.bodyB));
    if (moved != kNone) joints[moved].place.slot = joint.place.slot;
    recordGraphChange(joint.place);
    joint.place = {};
    joints.bundlesChanged = directSet.treesChanged = true;
}

}  // namespace ragtop
