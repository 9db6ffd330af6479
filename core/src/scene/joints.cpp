#include <algorithm>
#include <stdexcept>
#include <string>

#include "constraints/joint_bundles.h"
#include "model/edge_list.h"
#include "model/joint_bodies.h"
#include "scene/scene.h"

namespace ragtop {

std::uint32_t Scene::createJoint(const JointDef& def) const {
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

    const std::uint32_t index = joints.acquire(kindOf(def));
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
            if (contact.bodyA == b || contact.bodyB == b) activity.destroyContact(key >> 1);
            key = next;
        }
    link(joints, bodies[a].firstJoint, 2 * index);
    link(joints, bodies[b].firstJoint, 2 * index + 1);
    ++versions.structure;
    const bool awakeA = bodies.moves(a) && bodies.isAwake(a), awakeB = bodies.moves(b) && bodies.isAwake(b);
    if (bodies.moves(a) && !awakeA) activity.wakeBody(a);
    if (bodies.moves(b) && !awakeB) activity.wakeBody(b);
    activity.unfreeze(a), activity.unfreeze(b);
    activity.addJointToGraph(index);
    if (mayHold(bodies, joint)) joints.created.push(index);
    islands.structureChanged = true;
    return index;
}

void Scene::compile(std::uint32_t index) const {
    const JointRecord& joint = joints[index];
    const JointBodies& joined = bodiesOf(joint.def);
    compileJoint(joint.def, joint.bodyA == 0 ? joined.frameA.position : bodies[joint.bodyA].local.position,
                 joint.bodyB == 0 ? joined.frameB.position : bodies[joint.bodyB].local.position, joints.sims[index]);
    joints.bundlesChanged = directSet.treesChanged = true;
}

void Scene::noteOpening(std::uint32_t index) const {
    JointSim& sim = joints.sims[index];
    const JointBodiesAtStep at = jointBodies(bodies, joints[index]);
    sim.apart = openingOf(sim, jointState(sim, at, bodies.states.data(), 0), at);
    joints.opened |= sim.apart.way > 0 || sim.apart.turn > 0;
}

void Scene::redefineJoint(std::uint32_t index, const JointDef& def) const {
    JointRecord& joint = joints[index];
    const bool held = mayHold(bodies, joint);
    joint.def = def;
    // A distance is of no tree, and of its bundle while it has the rows that it had.
    const bool bundled = !joints.bundlesChanged, planned = !directSet.treesChanged;
    const std::uint64_t before = placeInBundles(joints.sims[index]);
    compile(index);
    if (std::holds_alternative<DistanceDef>(def) && placeInBundles(joints.sims[index]) == before) {
        joints.bundlesChanged = !bundled;
        directSet.treesChanged = !planned;
    }
    if (!mayHold(bodies, joint)) activity.removeJointFromGraph(index);
    settleJoint(index, held);
    noteOpening(index);
    for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
        if (bodies.moves(body)) activity.wakeBody(body);
    activity.addJointToGraph(index);
}

void Scene::destroyJoint(std::uint32_t index) const {
    JointRecord& joint = joints[index];
    while (joint.firstCoupling != kNone) destroyCoupling(joint.firstCoupling / CouplingDef::kMostParts);
    if (bodies.moves(joint.bodyA)) activity.wakeBody(joint.bodyA);
    if (bodies.moves(joint.bodyB)) activity.wakeBody(joint.bodyB);
    activity.removeJointFromGraph(index);
    unlink(joints, bodies[joint.bodyA].firstJoint, 2 * index);
    unlink(joints, bodies[joint.bodyB].firstJoint, 2 * index + 1);
    const bool collided = bodiesOf(joint.def).collide;
    joints.release(index);
    ++versions.structure;
    articulations.forget();  // also where the joint held nothing, and was in no list of the graph
    if (collided) return;
    // The bodies may collide from now on: their shapes look for partners again.
    for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
        for (std::uint32_t s = bodies[body].firstShape; s != kNone; s = shapes[s].next) bounds.markMoved(s);
}

void Scene::breakJoints(float dt) const {
    joints.broken.clear();
    activity.graph.forUsedLists([&](int c) {
        for (const std::uint32_t j : activity.graph.color(c).joints) {
            if (joints.sims[j].breakable == 0) continue;
            const JointBodies& bound = bodiesOf(joints[j].def);
            const PairVector& impulse = joints.sims[j].stepImpulse;
            if (length(impulse.linear) > bound.breakForce * dt || length(impulse.angular) > bound.breakTorque * dt)
                joints.broken.push_back(j);
        }
    });
    std::sort(joints.broken.begin(), joints.broken.end());
    for (const std::uint32_t j : joints.broken) {
        const JointBodies bound = bodiesOf(joints[j].def);
        const PairVector& impulse = joints.sims[j].stepImpulse;
        events.jointBreak(
            {joints.id(j), bound.a, bound.b, bound.userData, (1 / dt) * impulse.linear, (1 / dt) * impulse.angular});
        destroyJoint(j);
    }
}

}  // namespace ragtop
