#pragma once

#include "base/prefetch.h"
#include "constraints/constraint_graph.h"
#include "contacts/contacts.h"
#include "contacts/manifolds.h"
#include "model/bodies.h"
#include "model/joints.h"
#include "model/shapes.h"

/// What there is in a world, to read.
namespace ragtop {

struct ConstTables {
    const Bodies& bodies;
    const Shapes& shapes;
    const Contacts& contacts;
    const Manifolds& manifolds;
    const Joints& joints;
    const Couplings& couplings;
    const ConstraintGraph& graph;
};

/// Is one of the two held by the other, which does not move?
inline bool holds(const Bodies& bodies, const ContactRecord& contact) {
    return bodies.moves(contact.bodyA) != bodies.moves(contact.bodyB);
}

/// Islands: their bodies, contacts and joints, each in the order of what is awake.
struct IslandLists {
    std::span<const std::uint32_t> bodies, contacts, joints;
};

/// Calls contact(manifold), then joint(joint), for all that is in the graph, in an order that depends on the scene
/// alone; of some islands if there are lists of them.
template <class Contact, class Joint>
void forEachInGraph(const ConstTables& t, const IslandLists* some, Contact&& contact, Joint&& joint) {
    const auto visitContact = [&](std::uint32_t index) {
        const ContactRecord& record = t.contacts[index];
        if (record.firstManifold == kNone) return;
        for (std::uint32_t k = record.firstManifold; k < record.firstManifold + record.manifoldCapacity; ++k)
            if (t.manifolds[k].place.color != kNone) contact(k);
    };
    const auto visitJoint = [&](std::uint32_t j) {
        if (t.joints.slots.isUsed(j) && t.joints[j].place.color != kNone) joint(j);
    };
    if (some) {
        for (const std::uint32_t index : some->contacts) visitContact(index);
        for (const std::uint32_t j : some->joints) visitJoint(j);
        return;
    }
    for (const std::uint32_t index : t.contacts.awake) visitContact(index);
    for (std::uint32_t j = 0; j < t.joints.slots.count(); ++j) visitJoint(j);
}

/// Calls visit(manifold's index, manifold, contact) for the contacts of a list of the graph. Records and bodies of
/// those that follow each other there lie anywhere: they are asked for some places ahead, each when what leads to it
/// has come.
template <class Visit>
void forContactsOf(const ConstTables& t, const AlignedArray<std::uint32_t>& list, Visit&& visit) {
    constexpr std::size_t kManifold = 24, kContact = 16, kBodies = 8;  // places ahead, by trial
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (i + kManifold < list.size()) {
            const ManifoldRecord& manifold = t.manifolds[list[i + kManifold]];
            prefetch(&manifold.pointCount);
            prefetch(&manifold.separation);
            prefetch(&manifold.contact);
        }
        if (i + kContact < list.size()) prefetch(&t.contacts[t.manifolds[list[i + kContact]].contact]);
        if (i + kBodies < list.size()) {
            const ContactRecord& contact = t.contacts[t.manifolds[list[i + kBodies]].contact];
            for (const std::uint32_t body : {contact.bodyA, contact.bodyB}) {
                prefetch(&t.bodies[body].type);
                prefetch(&t.bodies[body].mass);
            }
        }
        const ManifoldRecord& manifold = t.manifolds[list[i]];
        visit(list[i], manifold, t.contacts[manifold.contact]);
    }
}

/// Calls visit(first, body) for the awake bodies of each coupling that move, `first` being the first of them.
template <class Visit>
void forEachCoupledPair(const ConstTables& t, Visit&& visit) {
    for (std::uint32_t c = 0; c < t.couplings.slots.count(); ++c) {
        if (!t.couplings.slots.isUsed(c)) continue;
        const CouplingDef& def = t.couplings[c].def;
        std::uint32_t first = kNone;
        for (int i = 0; i < def.count; ++i) {
            const JointRecord& joint = t.joints[def.parts[static_cast<std::size_t>(i)].joint.index];
            for (const std::uint32_t body : {joint.bodyA, joint.bodyB}) {
                if (!t.bodies.moves(body) || !t.bodies.isAwake(body)) continue;
                if (first == kNone) first = body;
                visit(first, body);
            }
        }
    }
}

}  // namespace ragtop
