// Constraints in the graph, in the lists of the solvers of their islands.

#include "activity/activity.h"

namespace ragtop {
namespace {

bool isFree(const AxisDef& axis) {
    return !axis.limit && !axis.motor && !axis.spring && !axis.bearing && axis.friction == 0;
}

/// Does it leave all six directions as they are? Such a joint only keeps its bodies from meeting.
bool isFree(const JointRecord& joint) {
    const auto* def = std::get_if<SixDofDef>(&joint.def);
    return def && joint.firstCoupling == kNone && isFree(def->x) && isFree(def->y) && isFree(def->z) &&
           isFree(def->twist) && isFree(def->swingY) && isFree(def->swingZ);
}

}  // namespace

bool mayHold(const Bodies& bodies, const JointRecord& joint) {
    return !isFree(joint) && bodies.isEnabled(joint.bodyA) && bodies.isEnabled(joint.bodyB) &&
           (bodies.moves(joint.bodyA) || bodies.moves(joint.bodyB));
}

void Activity::recordGraphChange(GraphPlace place) const {
    islands.graphChangedAt(place.color == ConstraintGraph::kDirect);
}

void Activity::addToGraph(std::uint32_t index) const {
    ManifoldRecord& manifold = manifolds[index];
    const ContactRecord& record = contacts[manifold.contact];
    if (manifold.place.color != kNone || manifold.pointCount == 0 || record.sensor) return;
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    const ManifoldImpulses impulses = writer.impulsesOf(manifold);
    const bool direct = bodies.isDirect(record.bodyA) || bodies.isDirect(record.bodyB);
    manifold.place = graph.insertContact(index, bodies[record.bodyA].state, bodies.moves(record.bodyA),
                                         bodies[record.bodyB].state, bodies.moves(record.bodyB),
                                         direct ? ConstraintGraph::By::direct : ConstraintGraph::By::iteration);
    recordGraphChange(manifold.place);
    writer.writeLane(record, manifold, impulses);
    if (record.manifoldCapacity == 1) manifolds.forgetStored(manifold);
}

void Activity::removeFromGraph(std::uint32_t index) const {
    ManifoldRecord& manifold = manifolds[index];
    if (manifold.place.color == kNone) return;
    const ContactRecord& record = contacts[manifold.contact];
    unfreeze(record.bodyA), unfreeze(record.bodyB);
    if (manifold.pointCount > 0) manifolds.store(manifold, writer.impulsesOf(manifold));
    const std::uint32_t moved =
        graph.removeContact(manifold.place, bodies[record.bodyA].state, bodies.moves(record.bodyA),
                            bodies[record.bodyB].state, bodies.moves(record.bodyB));
    if (moved != kNone) manifolds[moved].place.slot = manifold.place.slot;
    recordGraphChange(manifold.place);
    manifold.place = {};
    manifolds.touches[index] = manifold.pointCount > 0 ? kUnknownTouch : 0;
    contacts[manifold.contact].until = 0;
}

/// A direct solve leaves the loads that hold: soft rows would take a share of them back one after the other, and where
/// a press makes loads large each share throws a light body.
void Activity::carryWholeLoad(std::uint32_t index) const {
    const ManifoldRecord& manifold = manifolds[index];
    ManifoldImpulses known = writer.impulsesOf(manifold);
    for (int j = 0; j < manifold.pointCount; ++j) known.load[j] = known.impulse[j];
    writer.writeImpulses(contacts[manifold.contact], manifold, known);
}

void Activity::addJointToGraph(std::uint32_t index) const {
    JointRecord& joint = joints[index];
    const bool movesA = bodies.moves(joint.bodyA), movesB = bodies.moves(joint.bodyB);
    if (joint.place.color != kNone || !mayHold(bodies, joint)) return;
    if ((movesA && !bodies.isAwake(joint.bodyA)) || (movesB && !bodies.isAwake(joint.bodyB))) return;
    joint.place = graph.insertJoint(index, bodies[joint.bodyA].state, movesA, bodies[joint.bodyB].state, movesB,
                                    bodies.isDirect(joint.bodyA) || bodies.isDirect(joint.bodyB));
    recordGraphChange(joint.place);
    joints.bundlesChanged = directSet.treesChanged = true;
}

void Activity::removeJointFromGraph(std::uint32_t index) const {
    JointRecord& joint = joints[index];
    if (joint.place.color == kNone) return;
    const std::uint32_t moved = graph.removeJoint(joint.place, bodies[joint.bodyA].state, bodies.moves(joint.bodyA),
                                                  bodies[joint.bodyB].state, bodies.moves(joint.bodyB));
    if (moved != kNone) joints[moved].place.slot = joint.place.slot;
    recordGraphChange(joint.place);
    joint.place = {};
    joints.bundlesChanged = directSet.treesChanged = true;
}

void Activity::applyChoices(const ConstTables& tables, const IslandLists* some) const {
    const ConstraintGraph::Color& list = graph.color(ConstraintGraph::kDirect);
    bool any = !list.manifolds.empty() || !list.joints.empty();
    for (std::size_t i = 0; i < bodies.awake.size() && !any; ++i) any = bodies.isDirect(bodies.awake[i]);
    if (!any) return;
    directSet.movedConstraints.clear();
    const auto changes = [&](std::uint32_t a, std::uint32_t b, GraphPlace place) {
        return (bodies.isDirect(a) || bodies.isDirect(b)) != (place.color == ConstraintGraph::kDirect);
    };
    std::size_t contactCount = 0, becomeDirect = 0;
    forEachInGraph(
        tables, some,
        [&](std::uint32_t m) {
            const ContactRecord& contact = contacts[manifolds[m].contact];
            if (!changes(contact.bodyA, contact.bodyB, manifolds[m].place)) return;
            directSet.movedConstraints.push(m), ++contactCount;
            becomeDirect += manifolds[m].place.color != ConstraintGraph::kDirect;
        },
        [&](std::uint32_t j) {
            if (changes(joints[j].bodyA, joints[j].bodyB, joints[j].place)) directSet.movedConstraints.push(j);
        });
    graph.expectContacts(contactCount - becomeDirect, becomeDirect);
    for (std::size_t i = 0; i < directSet.movedConstraints.size(); ++i) {
        const std::uint32_t moved = directSet.movedConstraints[i];
        if (i < contactCount) {
            const bool wasDirect = manifolds[moved].place.color == ConstraintGraph::kDirect;
            removeFromGraph(moved), addToGraph(moved);
            if (wasDirect) carryWholeLoad(moved);
        } else
            removeJointFromGraph(moved), addJointToGraph(moved);
    }
    graph.expectContacts(0);
}

}  // namespace ragtop
