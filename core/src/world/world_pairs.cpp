#include <algorithm>

#include "contacts/contact_order.h"
#include "contacts/find_pairs.h"
#include "world/world_impl.h"

namespace ragtop {

/// Of all shapes in the move buffer.
void WorldImpl::createPairs(const Activity& active, bool obstaclesToo) {
    const std::size_t lists =
        findPairs({tables.bodies, tables.shapes, tables.joints, collision.broadphase, callbacks, machine.memory},
                  machine.runner, obstaclesToo);
    for (std::size_t list = 0; list < lists; ++list)
        for (const PairFound& pair : collision.broadphase.search.found[list]) active.createContact(pair.a, pair.b);
}

/// Pairs that come to be in this step; `longer`: than the last one.
void WorldImpl::updatePairs(const Activity& active, bool longer) {
    createPairs(active, true);
    for (const std::uint32_t shape : collision.broadphase.moved) tables.shapes[shape].inMoveBuffer = false;
    collision.broadphase.moved.clear();
    shapeBounds().coverNewVelocities(longer);
    if (!collision.broadphase.moved.empty()) createPairs(active, false);
}

/// Contacts come and go in any order, and records are found faster in that of memory. Seldom: a few in disorder do
/// little.
static void sortAwakeContacts(Contacts& contacts, std::uint64_t stepCount) {
    constexpr std::uint64_t kSteps = 64;  // between two sorts, a second at 60 Hz
    if (stepCount % kSteps != 0) return;
    std::sort(contacts.awake.begin(), contacts.awake.end());
    for (std::size_t i = 0; i < contacts.awake.size(); ++i)
        contacts[contacts.awake[i]].awakeIndex = static_cast<std::uint32_t>(i);
}

void WorldImpl::updateContacts() {
    if (orderContacts({tables.bodies, tables.contacts, tables.manifolds, collision.broadphase.pairs, tables.graph},
                      machine.stageMemory)) {
        forgetTouches(tables.manifolds, collision.finds);
        partition.direct.grouped = false;
    }
    sortAwakeContacts(tables.contacts, clock.stepCount);
    narrowPhase().collide(machine.runner);
}

}  // namespace ragtop
