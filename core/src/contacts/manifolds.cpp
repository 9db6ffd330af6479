#include "contacts/manifolds.h"

#include <cassert>

#include "constraints/lane_view.h"

namespace ragtop {

namespace {

/// The place of what is held: worker and index.
constexpr std::uint32_t kIndexBits = 26;

}  // namespace

Manifolds::Manifolds(int workers, std::pmr::memory_resource* memory)
    : meshMemory(memory),
      touches(memory),
      records_(memory),
      free_(memory),
      freeRows_(memory),
      stored_(memory),
      freeStored_(memory) {
    for (int worker = 0; worker < workers; ++worker) held_.emplace_back(memory);
}

std::uint32_t Manifolds::acquire(std::uint32_t count) {
    AlignedArray<std::uint32_t>& free = count > 1 ? freeRows_ : free_;
    if (free.empty()) {
        // Those of one contact lie on one page.
        auto first = static_cast<std::uint32_t>(records_.size());
        for (; first % count != 0; ++first) free_.push(first);
        records_.resize(first + count, {});
        touches.resize(records_.size(), 0);
        return first;
    }
    const std::uint32_t first = free.back();
    free.pop();
    return first;
}

void Manifolds::release(ContactRecord& contact) {
    if (contact.firstManifold == kNone) return;
    for (ManifoldRecord& manifold : of(contact)) {
        assert(manifold.place.color == kNone);
        forgetStored(manifold);
        manifold.pointCount = 0;
    }
    (contact.manifoldCapacity > 1 ? freeRows_ : free_).push(contact.firstManifold);
    contact.firstManifold = kNone;
}

std::span<ManifoldRecord> Manifolds::hold(ContactRecord& contact, int worker) {
    AlignedArray<ManifoldRecord>& held = held_[static_cast<std::size_t>(worker)];
    const std::size_t first = held.size();
    assert(first + contact.manifoldCapacity < (std::size_t{1} << kIndexBits));
    held.resize(first + contact.manifoldCapacity, {});
    contact.firstManifold = static_cast<std::uint32_t>(worker) << kIndexBits | static_cast<std::uint32_t>(first);
    return {&held[first], contact.manifoldCapacity};
}

/// Which worker finds how much is chance.
void Manifolds::makeRoomToHold() {
    std::size_t most = 0, found = 0;
    for (AlignedArray<ManifoldRecord>& held : held_) {
        most = held.capacity() > most ? held.capacity() : most;
        found += held.size();
        held.clear();
    }
    for (AlignedArray<ManifoldRecord>& held : held_) held.reserve(found > most ? found + found / 2 : most);
}

void Manifolds::settle(ContactRecord& contact, std::uint32_t index) {
    const AlignedArray<ManifoldRecord>& held = held_[contact.firstManifold >> kIndexBits];
    const std::uint32_t first = contact.firstManifold & ((1u << kIndexBits) - 1);
    contact.firstManifold = acquire(contact.manifoldCapacity);
    for (std::uint32_t k = 0; k < contact.manifoldCapacity; ++k) {
        ManifoldRecord& manifold = records_[contact.firstManifold + k];
        manifold = held[first + k];
        manifold.contact = index;
        touches[contact.firstManifold + k] = manifold.pointCount > 0 ? kUnknownTouch : 0;
        // Impulses may be handed over from one direction to a new one, while nothing may grow.
        if (contact.manifoldCapacity > 1) store(manifold, {});
    }
}

void Manifolds::makeRoomToStore() {
    stored_.reserve(records_.capacity());
    freeStored_.reserve(records_.capacity());
}

ManifoldImpulses Manifolds::impulsesOf(const ManifoldRecord& manifold, const ConstraintGraph& graph,
                                       float substep) const {
    if (manifold.place.color == kNone) return manifold.stored == kNone ? ManifoldImpulses{} : stored_[manifold.stored];
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
    impulses.substep = substep;
    return impulses;
}

void Manifolds::store(ManifoldRecord& manifold, const ManifoldImpulses& impulses) {
    if (manifold.stored != kNone) {
        stored_[manifold.stored] = impulses;
    } else if (freeStored_.empty()) {
        manifold.stored = static_cast<std::uint32_t>(stored_.size());
        stored_.push(impulses);
    } else {
        manifold.stored = freeStored_.back();
        freeStored_.pop();
        stored_[manifold.stored] = impulses;
    }
}

void Manifolds::forgetStored(ManifoldRecord& manifold) {
    if (manifold.stored == kNone) return;
    freeStored_.push(manifold.stored);
    manifold.stored = kNone;
}

}  // namespace ragtop
