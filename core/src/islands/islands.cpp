#include "islands/islands.h"

#include <algorithm>
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

namespace {

bool isInGraph(const ConstTables& t, std::uint32_t contact) {
    bool is = false;
    Manifolds::forEach(t.contacts[contact], [&](std::uint32_t m) { is |= t.manifolds[m].place.color != kNone; });
    return is;
}

/// Calls visit(body) for those that are solved directly, or whose constraints still are in that list.
template <class Visit>
void forEachDirectBody(const ConstTables& t, Visit&& visit) {
    for (const std::uint32_t body : t.bodies.awake)
        if (t.bodies.isDirect(body)) visit(body);
    const ConstraintGraph::Color& list = t.graph.color(ConstraintGraph::kDirect);
    for (const std::uint32_t m : list.manifolds) {
        visit(t.contacts[t.manifolds[m].contact].bodyA);
        visit(t.contacts[t.manifolds[m].contact].bodyB);
    }
    for (const std::uint32_t j : list.joints) visit(t.joints[j].bodyA), visit(t.joints[j].bodyB);
}

/// Calls visit(contact, joint, other, first) for what a body shares with others; of contact and joint one is kNone, and
/// what two bodies that move share is the first's once.
template <class Visit>
void forEachShared(const ConstTables& t, std::uint32_t body, Visit&& visit) {
    const BodyRecord& record = t.bodies[body];
    for (std::uint32_t key = record.firstContact; key != kNone; key = t.contacts.next(key)) {
        const ContactRecord& contact = t.contacts[key >> 1];
        const std::uint32_t other = (key & 1) != 0 ? contact.bodyA : contact.bodyB;
        if (isInGraph(t, key >> 1)) visit(key >> 1, kNone, other, (key & 1) == 0 || !t.bodies.moves(other));
    }
    for (std::uint32_t key = record.firstJoint; key != kNone; key = t.joints.next(key)) {
        const JointRecord& joint = t.joints[key >> 1];
        const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
        if (joint.place.color != kNone) visit(kNone, key >> 1, other, (key & 1) == 0 || !t.bodies.moves(other));
    }
}

}  // namespace

IslandLists Islands::findDirect(const ConstTables& t) {
    parent.resizeForOverwrite(t.bodies.size());
    for (const std::uint32_t body : t.bodies.awake) parent[body] = kNone;
    for (AlignedArray<std::uint32_t>* list : {&directBodies, &directContacts, &directJoints}) list->clear();
    const auto reach = [&](std::uint32_t body, std::uint32_t from) {
        if (!t.bodies.moves(body) || parent[body] != kNone) return;
        parent[body] = from;
        directBodies.push(body);
    };
    forEachDirectBody(t, [&](std::uint32_t seed) {
        std::size_t next = directBodies.size();
        const std::size_t begin = next;
        reach(seed, seed);
        std::uint32_t lowest = seed;
        for (; next < directBodies.size(); ++next) {
            lowest = std::min(lowest, directBodies[next]);
            forEachShared(t, directBodies[next],
                          [&](std::uint32_t contact, std::uint32_t joint, std::uint32_t other, bool first) {
                              reach(other, seed);
                              if (first && contact != kNone) directContacts.push(contact);
                              if (first && joint != kNone) directJoints.push(joint);
                          });
        }
        for (std::size_t i = begin; i < directBodies.size(); ++i) parent[directBodies[i]] = lowest;
    });
    const auto byPlace = [](const auto& table) {
        return [&](std::uint32_t a, std::uint32_t b) { return table[a].awakeIndex < table[b].awakeIndex; };
    };
    std::sort(directBodies.begin(), directBodies.end(), byPlace(t.bodies));
    std::sort(directContacts.begin(), directContacts.end(), byPlace(t.contacts));
    std::sort(directJoints.begin(), directJoints.end());
    return {{directBodies.begin(), directBodies.end()},
            {directContacts.begin(), directContacts.end()},
            {directJoints.begin(), directJoints.end()}};
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
