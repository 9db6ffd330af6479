#include <limits>

#include "world/graph_contacts.h"

namespace ragtop {

std::uint32_t WorldImpl::findRoot(std::uint32_t body) {
    while (islandParent[body] != body) {
        islandParent[body] = islandParent[islandParent[body]];
        body = islandParent[body];
    }
    return body;
}

void WorldImpl::unite(std::uint32_t a, std::uint32_t b) {
    if (!moves(a) || !moves(b)) return;
    const std::uint32_t rootA = findRoot(a), rootB = findRoot(b);
    if (rootA == rootB) return;
    // The lower index becomes the root, so that roots depend on the scene alone.
    if (rootA < rootB)
        islandParent[rootB] = rootA;
    else
        islandParent[rootA] = rootB;
}

void WorldImpl::uniteConstraints(bool touchingOnly) {
    islandParent.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : awakeBodies) islandParent[body] = body;
    for (int c = 0; c < graph.listCount(); ++c) {
        forContactsOf(*this, graph.color(c).manifolds,
                      [&](std::uint32_t, const ManifoldRecord&, const ContactRecord& contact) {
                          if (contact.touching || !touchingOnly) unite(contact.bodyA, contact.bodyB);
                      });
        for (const std::uint32_t j : graph.color(c).joints) unite(joints[j].bodyA, joints[j].bodyB);
    }
    forEachCoupledPair([&](std::uint32_t a, std::uint32_t b) { unite(a, b); });
}

/// Islands are the components of moving bodies that touch or are joined.
void WorldImpl::buildIslands() {
    uniteConstraints(true);
    islandQuiet.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        islandQuiet[body] = std::numeric_limits<float>::max();
    }
    for (const std::uint32_t body : awakeBodies) {
        if (!moves(body)) continue;
        float& quiet = islandQuiet[findRoot(body)];
        if (bodies[body].sleepTimer < quiet) quiet = bodies[body].sleepTimer;
    }
    // What a moving kinematic body touches does not rest, however slow it is.
    for (const std::uint32_t body : awakeBodies) {
        if (moves(body) || bodies[body].sleepTimer > 0) continue;
        for (std::uint32_t key = bodies[body].firstContact; key != kNone;
             key = nextContact(key)) {
            const ContactRecord& contact = contacts[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? contact.bodyA : contact.bodyB;
            if (contact.touching && !contact.sensor && moves(other) && isAwake(other)) islandQuiet[findRoot(other)] = 0;
        }
    }
}

void WorldImpl::sleepQuietIslands() {
    if (!settings.sleeping) return;
    bool candidate = false;
    for (const std::uint32_t body : awakeBodies) candidate |= bodies[body].sleepTimer >= settings.sleepTime;
    if (!candidate) return;
    buildIslands();
    bodyStack.clear();
    for (const std::uint32_t body : awakeBodies) {
        const float quiet = moves(body) ? islandQuiet[findRoot(body)] : bodies[body].sleepTimer;
        if (quiet >= settings.sleepTime) bodyStack.push(body);
    }
    for (const std::uint32_t body : bodyStack) sleepBody(body);
}

/// What happens between steps is told by the next one.
void WorldImpl::recordSleep(std::uint32_t index, bool asleep) {
    (stepping ? sleepEvents : sleepEventsBetweenSteps).push_back({id(index), asleep});
}

/// Takes a body out of all awake lists; its constraints keep their impulses for the day it wakes.
void WorldImpl::sleepBody(std::uint32_t index) {
    BodyRecord& body = bodies[index];
    if (body.awakeIndex == kNone) return;
    const std::uint32_t last = awakeBodies.back();
    awakeBodies[body.awakeIndex] = last;
    bodies[last].awakeIndex = body.awakeIndex;
    awakeBodies.pop();
    articulations.known = false;
    body.awakeIndex = kNone;
    states[index].v = states[index].w = {};
    histories[index].velocityBefore = histories[index].lastChange = {};
    storeMomentum(index);
    for (std::uint32_t key = body.firstContact; key != kNone; key = nextContact(key)) {
        const std::uint32_t c = key >> 1;
        const ContactRecord& contact = contacts[c];
        forEachManifold(contact, [&](std::uint32_t manifold) { removeFromGraph(manifold); });
        if (contact.awakeIndex != kNone && !isAwake(contact.bodyA) && !isAwake(contact.bodyB)) removeAwakeContact(c);
    }
    for (std::uint32_t key = body.firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next)
        removeJointFromGraph(key >> 1);
    recordSleep(index, true);
}

/// Wakes a body and all sleeping ones that it touches or is joined to, directly or through others.
void WorldImpl::wakeBody(std::uint32_t first) {
    bodyStack.clear();
    bodyStack.push(first);
    while (!bodyStack.empty()) {
        const std::uint32_t index = bodyStack.back();
        bodyStack.pop();
        BodyRecord& body = bodies[index];
        if (body.type == BodyType::fixed || index == 0) continue;
        body.sleepTimer = 0;
        unfreeze(index);
        if (body.awakeIndex != kNone) continue;
        body.awakeIndex = static_cast<std::uint32_t>(awakeBodies.size());
        awakeBodies.push(index);
        articulations.known = false;
        structureChanged = graphChanged = true;
        recordSleep(index, false);
        for (std::uint32_t key = body.firstContact; key != kNone; key = nextContact(key)) {
            const ContactRecord& contact = contacts[key >> 1];
            if (contact.awakeIndex == kNone) addAwakeContact(key >> 1);
            const std::uint32_t other = (key & 1) != 0 ? contact.bodyA : contact.bodyB;
            if (contact.touching && !contact.sensor && moves(other) && moves(index) && !isAwake(other))
                bodyStack.push(other);
        }
        for (std::uint32_t key = body.firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
            const JointRecord& joint = joints[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
            if (moves(other) && !isAwake(other)) bodyStack.push(other);
            addJointToGraph(key >> 1);
            if (joint.firstCoupling != kNone) pushCoupledBodies(key >> 1);
        }
        restoreContacts(index);
    }
}

/// Puts the contacts of a body that woke back into the graph, those with bodies that still sleep excepted.
void WorldImpl::restoreContacts(std::uint32_t index) {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = nextContact(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        const bool sleeps =
            (moves(contact.bodyA) && !isAwake(contact.bodyA)) || (moves(contact.bodyB) && !isAwake(contact.bodyB));
        if (sleeps) continue;
        forEachManifold(contact, [&](std::uint32_t manifold) { addToGraph(manifold); });
    }
}

void WorldImpl::wakeTouching(std::uint32_t index) {
    wakeBody(index);
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = nextContact(key)) {
        const ContactRecord& contact = contacts[key >> 1];
        if (contact.touching && !contact.sensor) wakeBody((key & 1) != 0 ? contact.bodyA : contact.bodyB);
    }
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next)
        wakeBody((key & 1) != 0 ? joints[key >> 1].bodyA : joints[key >> 1].bodyB);
}

}  // namespace ragtop
