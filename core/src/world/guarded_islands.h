#pragma once

#include <cstdint>
#include <span>

#include "world/energy_guard.h"

/// The islands of groups that have gained energy, as the energy guard looks at them.
namespace ragtop {

/// In a group.
inline bool isJoined(const GuardView& view, std::uint32_t body) { return view.bodies[body].firstJoint != kNone; }

/// Its room and what it owes are kept with it: a body without joints, or the lowest of a group.
inline bool keepsLedger(const GuardView& view, std::uint32_t body) {
    return !isJoined(view, body) || view.guard.parent[body] == body;
}

inline std::span<const std::uint32_t> bodiesOf(const EnergyGuard& guard, const GuardedIsland& look) {
    return {guard.visited.data() + look.begin, look.end - look.begin};
}

/// Calls visit(contact, other) for all that a body touches.
template <class Visit>
void forEachTouch(const GuardView& view, std::uint32_t body, Visit&& visit) {
    for (std::uint32_t key = view.bodies[body].firstContact; key != kNone; key = view.contacts.next(key))
        if (const ContactRecord& contact = view.contacts[key >> 1]; !contact.sensor && contact.firstManifold != kNone)
            visit(contact, (key & 1) != 0 ? contact.bodyA : contact.bodyB);
}

/// Is its account of this step kept? Trees that go alone and have kept their energy have been finished.
bool isAccountKept(const GuardView& view, std::size_t group);
/// Of a group in this step.
const EnergyAccount& keepAccount(const GuardView& view, std::size_t group);
/// All that a body touches or is joined to, and so on; each island is looked at once in a step, whatever asks for
/// it, before energy is taken from any of it.
GuardedIsland& islandOf(const GuardView& view, std::uint32_t body);

/// J, that overlaps lift a group by: the bodies that are in something, and all of it with the one that goes farthest.
struct Lifts {
    double own = 0, whole = 0;
};
Lifts liftsOf(const GuardView& view, const GuardedIsland& look, std::span<const std::uint32_t> group);

}  // namespace ragtop
