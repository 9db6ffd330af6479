#include "islands/islands.h"

#include <limits>

#include "base/economy.h"
#include "base/union_find.h"

namespace ragtop {

void Islands::begin(const Bodies& bodies) {
    parent.resizeForOverwrite(bodies.size());
    for (const std::uint32_t body : bodies.awake) parent[body] = body;
}

std::uint32_t Islands::root(std::uint32_t body) { return rootOf(parent, body); }

void Islands::unite(const Bodies& bodies, std::uint32_t a, std::uint32_t b) {
    if (!bodies.moves(a) || !bodies.moves(b)) return;
    ragtop::unite(parent, a, b);
}

static void uniteAll(const Bodies& bodies, Islands& islands) {
    std::uint32_t last = kNone;
    for (const std::uint32_t body : bodies.awake) {
        if (!bodies.moves(body)) continue;
        if (last != kNone) islands.unite(bodies, last, body);
        last = body;
    }
}

void Islands::uniteConstraints(const ConstTables& t, bool touchingOnly) {
    begin(t.bodies);
    for (int c = 0; c < t.graph.listCount(); ++c) {
        forContactsOf(t, t.graph.color(c).manifolds,
                      [&](std::uint32_t, const ManifoldRecord&, const ContactRecord& contact) {
                          if (contact.touching || !touchingOnly) unite(t.bodies, contact.bodyA, contact.bodyB);
                      });
        for (const std::uint32_t j : t.graph.color(c).joints) unite(t.bodies, t.joints[j].bodyA, t.joints[j].bodyB);
    }
    forEachCoupledPair(t, [&](std::uint32_t a, std::uint32_t b) { unite(t.bodies, a, b); });
    if (!economy.islands) uniteAll(t.bodies, *this);
}

void Islands::findQuiet(const ConstTables& t) {
    uniteConstraints(t, true);
    quiet.resizeForOverwrite(t.bodies.size());
    for (const std::uint32_t body : t.bodies.awake) {
        if (!t.bodies.moves(body)) continue;
        quiet[body] = std::numeric_limits<float>::max();
    }
    for (const std::uint32_t body : t.bodies.awake) {
        if (!t.bodies.moves(body)) continue;
        float& least = quiet[root(body)];
        if (t.bodies[body].sleepTimer < least) least = t.bodies[body].sleepTimer;
    }
    // What a moving kinematic body touches or is joined to does not rest, however slow it is.
    for (const std::uint32_t body : t.bodies.awake) {
        if (t.bodies.moves(body) || t.bodies[body].sleepTimer > 0) continue;
        for (std::uint32_t key = t.bodies[body].firstContact; key != kNone; key = t.contacts.next(key)) {
            const ContactRecord& contact = t.contacts[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? contact.bodyA : contact.bodyB;
            if (contact.touching && !contact.sensor && t.bodies.moves(other) && t.bodies.isAwake(other))
                quiet[root(other)] = 0;
        }
        for (std::uint32_t key = t.bodies[body].firstJoint; key != kNone; key = t.joints.next(key)) {
            const JointRecord& joint = t.joints[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
            if (t.bodies.moves(other) && t.bodies.isAwake(other)) quiet[root(other)] = 0;
        }
    }
}

}  // namespace ragtop
