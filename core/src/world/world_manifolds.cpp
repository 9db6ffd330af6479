// Where manifolds are kept: a contact has records while it has points, and their impulses have a place of their own
// only while they have no lane.

#include "world/lane_view.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// A contact that has found its first points notes where they wait: worker and index.
constexpr std::uint32_t kIndexBits = 26;

}  // namespace

std::uint32_t WorldImpl::allotManifolds(std::uint32_t count) {
    AlignedArray<std::uint32_t>& free = count > 1 ? freeMeshManifolds : freeManifolds;
    if (free.empty()) {
        // Those of one contact lie on one page.
        auto first = static_cast<std::uint32_t>(manifolds.size());
        for (; first % count != 0; ++first) freeManifolds.push(first);
        manifolds.resize(first + count, {});
        manifoldTouches.resize(manifolds.size(), 0);
        return first;
    }
    const std::uint32_t first = free.back();
    free.pop();
    return first;
}

/// Of a contact whose manifolds have neither points nor lanes.
void WorldImpl::releaseManifolds(ContactRecord& record) {
    if (record.firstManifold == kNone) return;
    for (ManifoldRecord& manifold : manifoldsOf(record)) {
        forgetStored(manifold);
        manifold.pointCount = 0;
    }
    (record.manifoldCapacity > 1 ? freeMeshManifolds : freeManifolds).push(record.firstManifold);
    record.firstManifold = kNone;
}

/// Records for what a contact without any has found. They wait beside those that the same thread has found, until
/// places are given in the order of the list of contacts.
std::span<ManifoldRecord> WorldImpl::holdManifolds(ContactRecord& record, int worker) {
    AlignedArray<ManifoldRecord>& held = heldManifolds[static_cast<std::size_t>(worker)];
    const std::size_t first = held.size();
    held.resize(first + record.manifoldCapacity, {});
    record.firstManifold = static_cast<std::uint32_t>(worker) << kIndexBits | static_cast<std::uint32_t>(first);
    return {&held[first], record.manifoldCapacity};
}

/// Each worker gets room for all that any step has found yet: which of them finds it is chance.
void WorldImpl::makeRoomToHold() {
    std::size_t most = 0, found = 0;
    for (AlignedArray<ManifoldRecord>& held : heldManifolds) {
        most = held.capacity() > most ? held.capacity() : most;
        found += held.size();
        held.clear();
    }
    for (AlignedArray<ManifoldRecord>& held : heldManifolds) held.reserve(found > most ? found + found / 2 : most);
}

void WorldImpl::settleManifolds(std::uint32_t index) {
    ContactRecord& record = contacts[index];
    const AlignedArray<ManifoldRecord>& held = heldManifolds[record.firstManifold >> kIndexBits];
    const std::uint32_t first = record.firstManifold & ((1u << kIndexBits) - 1);
    record.firstManifold = allotManifolds(record.manifoldCapacity);
    for (std::uint32_t k = 0; k < record.manifoldCapacity; ++k) {
        manifolds[record.firstManifold + k] = held[first + k];
        manifolds[record.firstManifold + k].contact = index;
        manifoldTouches[record.firstManifold + k] = held[first + k].pointCount > 0 ? kUnknownTouch : 0;
        // Impulses may be handed over from one direction to a new one, while nothing may grow.
        if (record.manifoldCapacity > 1) storeImpulses(manifolds[record.firstManifold + k]);
    }
}

ManifoldImpulses WorldImpl::impulsesOf(const ManifoldRecord& manifold) const {
    if (manifold.place.color == kNone)
        return manifold.stored == kNone ? ManifoldImpulses{} : storedImpulses[manifold.stored];
    const LaneReader lane(graph.lane(manifold.place), graph.lanes());
    ManifoldImpulses impulses;
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        impulses.impulse[j] = lane.at(j, contact::kImpulse);
        impulses.load[j] = lane.at(j, contact::kLoad);
    }
    impulses.frictionImpulse = lane.vector(contact::kFrictionImpulse);
    impulses.rollImpulse = lane.vector(contact::kRollImpulse);
    impulses.twistImpulse = lane.at(contact::kTwistImpulse);
    impulses.sliding = lane.at(contact::kSliding) > 0;
    impulses.stick = lane.vector(contact::kStick);
    impulses.substep = lastSubstep;
    return impulses;
}

/// Keeps the impulses of a manifold that is about to lose its lane.
void WorldImpl::storeImpulses(ManifoldRecord& manifold) {
    const ManifoldImpulses impulses = impulsesOf(manifold);
    if (manifold.stored != kNone) {
        storedImpulses[manifold.stored] = impulses;
    } else if (freeStored.empty()) {
        manifold.stored = static_cast<std::uint32_t>(storedImpulses.size());
        storedImpulses.push(impulses);
    } else {
        manifold.stored = freeStored.back();
        freeStored.pop();
        storedImpulses[manifold.stored] = impulses;
    }
}

void WorldImpl::forgetStored(ManifoldRecord& manifold) {
    if (manifold.stored == kNone) return;
    freeStored.push(manifold.stored);
    manifold.stored = kNone;
}

/// Of what has neither a lane nor stored impulses, they are zero and stay so.
void WorldImpl::writeImpulses(const ContactRecord& record, const ManifoldRecord& manifold,
                              const ManifoldImpulses& impulses) {
    if (manifold.place.color != kNone)
        writeLane(record, manifold, impulses);
    else if (manifold.stored != kNone)
        storedImpulses[manifold.stored] = impulses;
}

}  // namespace ragtop
