// What holds of a world between two calls, of which every stage may make use. Facts only: nothing here is a matter of
// accuracy.

#include "world/invariants.h"

#include <cmath>
#include <cstring>
#include <vector>

#include "activity/activity.h"
#include "constraints/contact_layout.h"
#include "contacts/meets_nothing.h"

namespace ragtop {

namespace {

/// Keeps what was broken first.
class Findings {
public:
    bool none() const { return first_.empty(); }
    const std::string& first() const { return first_; }
    void expect(bool holds, const char* fact, std::uint32_t index = kNone) {
        if (holds || !none()) return;
        first_ = fact;
        if (index != kNone) first_ += " (" + std::to_string(index) + ")";
    }

private:
    std::string first_;
};

/// Does a list hold what says that it is in it, each once?
template <class PlaceOf, class Used>
void checkList(Findings& found, const AlignedArray<std::uint32_t>& list, std::uint32_t count, Used&& isUsed,
               PlaceOf&& placeOf, const char* fact) {
    std::size_t listed = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!isUsed(i)) continue;
        const std::uint32_t place = placeOf(i);
        if (place == kNone) continue;
        ++listed;
        found.expect(place < list.size() && list[place] == i, fact, i);
    }
    found.expect(listed == list.size(), fact);
}

/// Calls visit(key) for a body's list, whose edges must lead both ways, and counts what is in it.
template <class EdgeOf, class Visit>
std::size_t checkEdges(Findings& found, std::uint32_t first, std::size_t most, EdgeOf&& edgeOf, Visit&& visit,
                       const char* fact) {
    std::size_t count = 0;
    std::uint32_t before = kNone;
    for (std::uint32_t key = first; key != kNone && found.none(); key = edgeOf(key).next) {
        found.expect(key >> 1 < most && count <= 2 * most, fact, key >> 1);
        if (!found.none()) break;
        found.expect(edgeOf(key).previous == before, fact, key >> 1);
        visit(key);
        before = key;
        ++count;
    }
    return count;
}

bool isFinite(const BodyRecord& body, const BodyState& state) {
    const Quat& q = body.rotation;
    return std::isfinite(body.center.x + body.center.y + body.center.z) && std::isfinite(q.x + q.y + q.z + q.w) &&
           std::isfinite(lengthSquared(state.v)) && std::isfinite(lengthSquared(state.w));
}

void checkBody(Findings& found, const ConstTables& tables, std::uint32_t index) {
    const BodyRecord& body = tables.bodies[index];
    const BodyState& state = tables.bodies.states[index];
    const bool awake = tables.bodies.isAwake(index);
    found.expect(isFinite(body, state), "a body's pose and velocity are finite", index);
    found.expect(std::abs(body.rotation.x * body.rotation.x + body.rotation.y * body.rotation.y +
                          body.rotation.z * body.rotation.z + body.rotation.w * body.rotation.w - 1) < 1e-3f,
                 "a body's rotation has length 1", index);
    found.expect(body.state == (body.type == BodyType::fixed ? 0 : index), "fixed bodies share state 0", index);
    found.expect((state.invMass > 0) == (body.type == BodyType::dynamic && body.mass > 0),
                 "what is dynamic has an inverse mass, and nothing else", index);
    found.expect(!awake || body.type != BodyType::fixed, "fixed bodies are never awake", index);
    if (tables.bodies.moves(index) && !awake)
        found.expect(state.v == Vec3{} && state.w == Vec3{}, "what sleeps has no velocity", index);
    if (body.frozen)
        found.expect(awake && tables.bodies.moves(index) && body.firstJoint == kNone,
                     "what is frozen is awake, dynamic, and has no joint", index);
}

void checkBodies(Findings& found, const ConstTables& tables) {
    const Bodies& bodies = tables.bodies;
    const std::size_t size = bodies.size();
    found.expect(bodies.states.size() == size && bodies.inertias.size() == size && bodies.dynamics.size() == size &&
                     bodies.histories.size() == size && bodies.userData.size() == size && bodies.slots.count() == size,
                 "arrays of bodies are equally long");
    found.expect(bodies.isUsed(0) && bodies[0].type == BodyType::fixed, "body 0 is the world");
    checkList(
        found, bodies.awake, bodies.slots.count(), [&](std::uint32_t i) { return bodies.isUsed(i); },
        [&](std::uint32_t i) { return bodies[i].awakeIndex; }, "the list of awake bodies is that of their places");
    for (std::uint32_t i = 0; i < bodies.slots.count() && found.none(); ++i)
        if (bodies.isUsed(i)) checkBody(found, tables, i);
}

void checkShapes(Findings& found, const ConstTables& tables, const Broadphase& broadphase) {
    std::size_t listed = 0, moved = 0;
    for (std::uint32_t i = 0; i < tables.bodies.slots.count() && found.none(); ++i) {
        if (!tables.bodies.isUsed(i)) continue;
        for (std::uint32_t s = tables.bodies[i].firstShape; s != kNone && found.none(); s = tables.shapes[s].next) {
            const ShapeRecord& shape = tables.shapes[s];
            found.expect(++listed <= tables.shapes.slots.used(), "each shape is in the list of one body", s);
            found.expect(tables.shapes.slots.isUsed(s) && shape.body == i, "a body's list has its shapes", s);
            found.expect(shape.geometry < tables.shapes.geometries.size(), "a shape has a geometry", s);
            if (!tables.bodies.isEnabled(i)) {
                found.expect(shape.proxy == kNone, "shapes of what is disabled have no proxy", s);
                continue;
            }
            found.expect(shape.isStaticTree == (tables.bodies[i].type == BodyType::fixed),
                         "shapes of fixed bodies are in the tree of these", s);
            if (meetsNothing(shape.filter)) {
                found.expect(shape.proxy == kNone, "shapes that meet nothing have no proxy", s);
                continue;
            }
            found.expect(shape.proxy != kNone && broadphase.tree(shape.isStaticTree).value(shape.proxy) == s,
                         "a shape's proxy names it", s);
            moved += shape.inMoveBuffer;
        }
    }
    found.expect(listed == tables.shapes.slots.used(), "each shape is in the list of one body");
    for (const std::uint32_t s : broadphase.moved)
        found.expect(tables.shapes[s].inMoveBuffer, "shapes that look for partners say so", s);
    found.expect(moved == broadphase.moved.size(), "shapes that look for partners are listed once");
}

void checkContact(Findings& found, const ConstTables& tables, const Broadphase& broadphase, std::uint32_t index) {
    const ContactRecord& contact = tables.contacts[index];
    const ShapeRecord &a = tables.shapes[contact.shapeA], &b = tables.shapes[contact.shapeB];
    found.expect(tables.shapes.slots.isUsed(contact.shapeA) && tables.shapes.slots.isUsed(contact.shapeB) &&
                     a.body == contact.bodyA && b.body == contact.bodyB,
                 "a contact's bodies are those of its shapes", index);
    const std::uint32_t* known = broadphase.pairs.find(pairKey(contact.shapeA, contact.shapeB));
    found.expect(known && *known == index, "the table of pairs leads to each contact", index);
    const bool awake = tables.bodies.isAwake(contact.bodyA) || tables.bodies.isAwake(contact.bodyB);
    found.expect((contact.awakeIndex != kNone) == awake, "a contact is awake with its bodies", index);
    bool points = false, deep = false;
    for (const ManifoldRecord& manifold : tables.manifolds.of(contact)) {
        found.expect(manifold.contact == index, "manifolds name their contact", index);
        found.expect(manifold.pointCount >= 0 && manifold.pointCount <= kMaxManifoldPoints,
                     "a manifold has up to four points", index);
        points |= manifold.pointCount > 0;
        for (int j = 0; j < manifold.pointCount; ++j) deep |= -manifold.separation[j] > contact::kDeep * contact.size;
        if (manifold.place.color != kNone)
            found.expect(manifold.pointCount > 0 && !contact.sensor, "what is in the graph has points", index);
    }
    found.expect(contact.hasPoints == points, "a contact knows whether it has points", index);
    found.expect(contact.sensor || contact.isDeep == deep, "a contact knows whether its points are deep", index);
}

void checkContacts(Findings& found, const ConstTables& tables, const Broadphase& broadphase) {
    const Contacts& contacts = tables.contacts;
    checkList(
        found, contacts.awake, contacts.slots.count(), [&](std::uint32_t i) { return contacts.slots.isUsed(i); },
        [&](std::uint32_t i) { return contacts[i].awakeIndex; }, "the list of awake contacts is that of their places");
    found.expect(broadphase.pairs.size() == contacts.slots.used(), "each contact is in the table of pairs once");
    for (std::uint32_t i = 0; i < contacts.slots.count() && found.none(); ++i)
        if (contacts.slots.isUsed(i)) checkContact(found, tables, broadphase, i);
    std::size_t edges = 0;
    for (std::uint32_t i = 0; i < tables.bodies.slots.count() && found.none(); ++i) {
        if (!tables.bodies.isUsed(i)) continue;
        edges += checkEdges(
            found, tables.bodies[i].firstContact, contacts.size(),
            [&](std::uint32_t key) { return contacts.links[key >> 1].edges[key & 1]; },
            [&](std::uint32_t key) {
                const ContactRecord& contact = contacts[key >> 1];
                found.expect(contacts.slots.isUsed(key >> 1) && ((key & 1) != 0 ? contact.bodyB : contact.bodyA) == i,
                             "a body's list has its contacts", key >> 1);
            },
            "a body's list of contacts leads both ways");
    }
    found.expect(edges == 2 * std::size_t{contacts.slots.used()}, "each contact is in the lists of both its bodies");
}

void checkJoints(Findings& found, const ConstTables& tables) {
    const Joints& joints = tables.joints;
    std::size_t edges = 0;
    for (std::uint32_t i = 0; i < tables.bodies.slots.count() && found.none(); ++i) {
        if (!tables.bodies.isUsed(i)) continue;
        edges += checkEdges(
            found, tables.bodies[i].firstJoint, joints.size(),
            [&](std::uint32_t key) { return joints[key >> 1].edges[key & 1]; },
            [&](std::uint32_t key) {
                const JointRecord& joint = joints[key >> 1];
                found.expect(joints.slots.isUsed(key >> 1) && ((key & 1) != 0 ? joint.bodyB : joint.bodyA) == i,
                             "a body's list has its joints", key >> 1);
            },
            "a body's list of joints leads both ways");
    }
    found.expect(edges == 2 * std::size_t{joints.slots.used()}, "each joint is in the lists of both its bodies");
    for (std::uint32_t j = 0; j < joints.slots.count() && found.none(); ++j) {
        if (!joints.slots.isUsed(j)) continue;
        const JointRecord& joint = joints[j];
        const bool movesA = tables.bodies.moves(joint.bodyA), movesB = tables.bodies.moves(joint.bodyB);
        const bool awakeA = tables.bodies.isAwake(joint.bodyA), awakeB = tables.bodies.isAwake(joint.bodyB);
        found.expect(!movesA || !movesB || awakeA == awakeB || !mayHold(tables.bodies, joint),
                     "what is joined sleeps together", j);
        const bool isAwake = movesA ? awakeA : movesB && awakeB;
        found.expect(tables.joints.isHolding(j) == (mayHold(tables.bodies, joint) && isAwake),
                     "joints that hold what is awake are in the graph, and no others", j);
        found.expect(joints.sims[j].stateA == tables.bodies[joint.bodyA].state &&
                         joints.sims[j].stateB == tables.bodies[joint.bodyB].state,
                     "a joint solves the states of its bodies", j);
    }
}

/// No body that moves occurs twice in a colour, and lanes are of the bodies of their manifolds.
class GraphCheck {
public:
    GraphCheck(Findings& found, const ConstTables& tables)
        : found_(found), tables_(tables), graph_(tables.graph), seenIn_(tables.bodies.size(), -1) {}

    void run() {
        for (list_ = 0; list_ < graph_.listCount() && found_.none(); ++list_) {
            const ConstraintGraph::Color& color = graph_.color(list_);
            for (std::uint32_t slot = 0; slot < color.manifolds.size() && found_.none(); ++slot)
                checkManifold(color.manifolds[slot], slot);
            for (std::uint32_t slot = 0; slot < color.joints.size() && found_.none(); ++slot)
                checkJoint(color.joints[slot], slot);
        }
        std::size_t placed = 0, inGraph = 0;
        std::vector<int> used, known;
        for (int list = 0; list < graph_.listCount(); ++list) {
            inGraph += graph_.color(list).manifolds.size();
            if (!graph_.color(list).empty()) used.push_back(list);
        }
        graph_.forUsedLists([&](int list) { known.push_back(list); });
        found_.expect(used == known, "lists that hold something are known");
        for (std::uint32_t c = 0; c < tables_.contacts.slots.count(); ++c) {
            if (!tables_.contacts.slots.isUsed(c)) continue;
            for (const ManifoldRecord& manifold : tables_.manifolds.of(tables_.contacts[c]))
                placed += manifold.place.color != kNone;
        }
        found_.expect(placed == inGraph, "each manifold with a place in the graph is there once");
    }

private:
    bool isAt(GraphPlace place, std::uint32_t slot) const {
        return place.color == static_cast<std::uint32_t>(list_) && place.slot == slot;
    }
    void occupy(std::uint32_t body) {
        if (!tables_.bodies.moves(body)) return;
        found_.expect(tables_.bodies.isAwake(body), "what sleeps is not in the graph", body);
        if (ConstraintGraph::isSerial(list_) || !ConstraintGraph::isIterated(list_)) return;
        found_.expect(seenIn_[body] != list_, "no moving body occurs twice in a colour", body);
        seenIn_[body] = list_;
    }
    void checkManifold(std::uint32_t index, std::uint32_t slot) {
        const ManifoldRecord& manifold = tables_.manifolds[index];
        found_.expect(isAt(manifold.place, slot), "a manifold knows its place in the graph", index);
        if (!found_.none()) return;
        const ContactRecord& contact = tables_.contacts[manifold.contact];
        const std::uint32_t bodies[] = {contact.bodyA, contact.bodyB};
        const float* lane = graph_.lane(manifold.place);
        for (int side = 0; side < 2; ++side) {
            occupy(bodies[side]);
            std::uint32_t state = 0;
            std::memcpy(&state, lane + (contact::kBodyA + side) * graph_.lanes(), sizeof state);
            found_.expect(state == tables_.bodies[bodies[side]].state, "a lane is of its manifold's bodies", index);
        }
        if (list_ == ConstraintGraph::kFrozen)
            found_.expect(tables_.bodies[bodies[0]].frozen || tables_.bodies[bodies[1]].frozen,
                          "the list of frozen contacts has those of frozen bodies", index);
        else
            found_.expect(!tables_.bodies[bodies[0]].frozen && !tables_.bodies[bodies[1]].frozen,
                          "contacts of frozen bodies are frozen", index);
    }
    void checkJoint(std::uint32_t index, std::uint32_t slot) {
        found_.expect(isAt(tables_.joints[index].place, slot), "a joint knows its place in the graph", index);
        occupy(tables_.joints[index].bodyA);
        occupy(tables_.joints[index].bodyB);
    }

    Findings& found_;
    const ConstTables tables_;
    const ConstraintGraph& graph_;
    std::vector<int> seenIn_;  ///< per body, the last list that had it
    int list_ = 0;
};

}  // namespace

std::string firstBroken(const ConstTables& tables, const Broadphase& broadphase) {
    Findings found;
    checkBodies(found, tables);
    checkShapes(found, tables, broadphase);
    checkContacts(found, tables, broadphase);
    checkJoints(found, tables);
    if (found.none()) GraphCheck(found, tables).run();
    return found.first();
}

}  // namespace ragtop
