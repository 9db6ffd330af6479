// Who falls asleep and who wakes: bodies leave all lists of awake things, and come back, with their constraints.

#include "activity/activity.h"

namespace ragtop {
namespace {

bool isDriven(const Bodies& bodies, std::uint32_t index) {
    const BodyState& state = bodies.states[index];
    return bodies[index].type == BodyType::kinematic && (state.v != Vec3{} || state.w != Vec3{});
}

}  // namespace

void Activity::sleepQuietIslands(const ConstTables& tables, float sleepTime) const {
    bool candidate = false;
    for (const std::uint32_t body : bodies.awake) candidate |= bodies[body].sleepTimer >= sleepTime;
    if (!candidate) return;
    islands.findQuiet(tables);
    islands.stack.clear();
    for (const std::uint32_t body : bodies.awake) {
        const float quiet = bodies.moves(body) ? islands.quiet[islands.root(body)] : bodies[body].sleepTimer;
        if (quiet >= sleepTime) islands.stack.push(body);
    }
    for (const std::uint32_t body : islands.stack) sleepBody(body);
}

/// What happens between steps is told by the next one.
void Activity::recordSleep(std::uint32_t index, bool asleep) const { events.sleep({bodies.id(index), asleep}); }

void Activity::sleepBody(std::uint32_t index) const {
    if (!bodies.isAwake(index)) return;
    bodies.stop(index);
    leaveAwake(index);
    recordSleep(index, true);
}

void Activity::leaveAwake(std::uint32_t index) const {
    BodyRecord& body = bodies[index];
    // What stands has taken several substeps at once, and may wake as part of what does not.
    if (body.direct.reason == direct::Reason::stiff) body.direct.pace.stepFactor = 1;
    bodies.removeAwake(index);
    articulations.forget();
    for (std::uint32_t key = body.firstContact; key != kNone; key = contacts.next(key)) {
        const std::uint32_t c = key >> 1;
        const ContactRecord& contact = contacts[c];
        Manifolds::forEach(contact, [&](std::uint32_t manifold) { removeFromGraph(manifold); });
        if (contact.awakeIndex != kNone && !bodies.isAwake(contact.bodyA) && !bodies.isAwake(contact.bodyB))
            contacts.removeAwake(c);
    }
    // What hangs from a kinematic body that stands still goes on swinging.
    const auto sleeps = [&](std::uint32_t other) { return bodies.moves(other) && !bodies.isAwake(other); };
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints.next(key))
        if (sleeps(joints[key >> 1].bodyA) || sleeps(joints[key >> 1].bodyB)) removeJointFromGraph(key >> 1);
}

void Activity::wakeBody(std::uint32_t first) const {
    islands.stack.clear();
    islands.stack.push(first);
    wakeStack();
}

void Activity::wakeStack() const {
    while (!islands.stack.empty()) {
        const std::uint32_t index = islands.stack.back();
        islands.stack.pop();
        BodyRecord& body = bodies[index];
        if (body.type == BodyType::fixed || index == 0) continue;
        body.sleepTimer = 0;
        unfreeze(index);
        if (body.awakeIndex != kNone) {
            if (isDriven(bodies, index)) pushJoined(index);
            continue;
        }
        recordSleep(index, false);
        enterAwake(index);
    }
}

/// What is joined to a kinematic body sleeps while that stands still, and wakes when it is moved.
void Activity::pushJoined(std::uint32_t index) const {
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints.next(key)) {
        const JointRecord& joint = joints[key >> 1];
        const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
        if (bodies.moves(other) && !bodies.isAwake(other)) islands.stack.push(other);
    }
}

void Activity::enterAwake(std::uint32_t index) const {
    bodies.addAwake(index);
    articulations.forget();
    islands.structureChangedAt();
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        if (contact.awakeIndex == kNone) addAwakeContact(key >> 1);
        const std::uint32_t other = (key & 1) != 0 ? contact.bodyA : contact.bodyB;
        if (contact.touching && !contact.sensor && bodies.moves(other) && bodies.moves(index) && !bodies.isAwake(other))
            islands.stack.push(other);
    }
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints.next(key)) {
        const JointRecord& joint = joints[key >> 1];
        const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
        if (bodies.moves(other) && !bodies.isAwake(other)) islands.stack.push(other);
        addJointToGraph(key >> 1);
        if (joint.firstCoupling != kNone) pushCoupledBodies(key >> 1);
    }
    restoreContacts(index);
}

void Activity::restoreContacts(std::uint32_t index) const {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        const bool sleeps = (bodies.moves(contact.bodyA) && !bodies.isAwake(contact.bodyA)) ||
                            (bodies.moves(contact.bodyB) && !bodies.isAwake(contact.bodyB));
        if (sleeps) continue;
        Manifolds::forEach(contact, [&](std::uint32_t manifold) { addToGraph(manifold); });
    }
}

void Activity::wakeTouching(std::uint32_t index) const {
    wakeBody(index);
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        if (contact.touching && !contact.sensor) wakeBody((key & 1) != 0 ? contact.bodyA : contact.bodyB);
    }
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next)
        wakeBody((key & 1) != 0 ? joints[key >> 1].bodyA : joints[key >> 1].bodyB);
}

/// What a coupling reaches from this joint wakes with it.
void Activity::pushCoupledBodies(std::uint32_t joint) const {
    for (std::uint32_t key = joints[joint].firstCoupling; key != kNone;
         key = couplings[key / CouplingDef::kMostParts].next[key % CouplingDef::kMostParts]) {
        const CouplingDef& def = couplings[key / CouplingDef::kMostParts].def;
        for (int i = 0; i < def.count; ++i) {
            const JointRecord& other = joints[def.parts[static_cast<std::size_t>(i)].joint.index];
            for (const std::uint32_t body : {other.bodyA, other.bodyB})
                if (bodies.moves(body) && !bodies.isAwake(body)) islands.stack.push(body);
        }
    }
}

}  // namespace ragtop
