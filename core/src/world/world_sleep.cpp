// Who falls asleep and who wakes: bodies leave all lists of awake things, and come back, with their constraints.

#include "world/world_impl.h"

namespace ragtop {

void WorldImpl::sleepQuietIslands() {
    if (!settings.sleeping) return;
    bool candidate = false;
    for (const std::uint32_t body : bodies.awake) candidate |= bodies[body].sleepTimer >= settings.sleepTime;
    if (!candidate) return;
    islands.findQuiet(tables());
    islands.stack.clear();
    for (const std::uint32_t body : bodies.awake) {
        const float quiet = bodies.moves(body) ? islands.quiet[islands.root(body)] : bodies[body].sleepTimer;
        if (quiet >= settings.sleepTime) islands.stack.push(body);
    }
    for (const std::uint32_t body : islands.stack) sleepBody(body);
}

/// What happens between steps is told by the next one.
void WorldImpl::recordSleep(std::uint32_t index, bool asleep) { events.sleep({bodies.id(index), asleep}); }

/// Takes a body out of all awake lists; its constraints keep their impulses for the day it wakes.
void WorldImpl::sleepBody(std::uint32_t index) {
    if (!bodies.isAwake(index)) return;
    bodies.stop(index);
    leaveAwake(index);
    recordSleep(index, true);
}

void WorldImpl::leaveAwake(std::uint32_t index) {
    const BodyRecord& body = bodies[index];
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

/// Wakes a body and all sleeping ones that it touches or is joined to, directly or through others.
void WorldImpl::wakeBody(std::uint32_t first) {
    islands.stack.clear();
    islands.stack.push(first);
    wakeStack();
}

void WorldImpl::wakeStack() {
    while (!islands.stack.empty()) {
        const std::uint32_t index = islands.stack.back();
        islands.stack.pop();
        BodyRecord& body = bodies[index];
        if (body.type == BodyType::fixed || index == 0) continue;
        body.sleepTimer = 0;
        unfreeze(index);
        if (body.awakeIndex != kNone) continue;
        recordSleep(index, false);
        enterAwake(index);
    }
}

/// Puts a body into the lists of what is awake, with its constraints; what wakes with it is put on the stack.
void WorldImpl::enterAwake(std::uint32_t index) {
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

/// Puts the contacts of a body that woke back into the graph, those with bodies that still sleep excepted.
void WorldImpl::restoreContacts(std::uint32_t index) {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        const bool sleeps = (bodies.moves(contact.bodyA) && !bodies.isAwake(contact.bodyA)) ||
                            (bodies.moves(contact.bodyB) && !bodies.isAwake(contact.bodyB));
        if (sleeps) continue;
        Manifolds::forEach(contact, [&](std::uint32_t manifold) { addToGraph(manifold); });
    }
}

void WorldImpl::wakeTouching(std::uint32_t index) {
    wakeBody(index);
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        if (contact.touching && !contact.sensor) wakeBody((key & 1) != 0 ? contact.bodyA : contact.bodyB);
    }
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next)
        wakeBody((key & 1) != 0 ? joints[key >> 1].bodyA : joints[key >> 1].bodyB);
}

}  // namespace ragtop
