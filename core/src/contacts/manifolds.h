#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/aligned_array.h"
#include "base/paged_array.h"
#include "constraints/constraint_graph.h"
#include "contacts/mesh_memory.h"
#include "model/records.h"

namespace ragtop {

/// The manifolds of contacts that have points, and their impulses while these have no lane in the graph: those of
/// contacts that sleep. A contact has manifoldCapacity records one after the other, from its firstManifold on.
///
/// Records stay where they are while a step collides: what a contact without any finds is held beside what the same
/// worker has found, and gets its place when contacts are gone through in the order of their list, so that places
/// depend on no thread.
class Manifolds {
public:
    Manifolds(int workers, std::pmr::memory_resource* memory);

    std::size_t size() const { return records_.size(); }
    std::size_t bytes() const { return records_.bytes() + meshMemory.bytes(); }
    ManifoldRecord& operator[](std::size_t manifold) { return records_[manifold]; }
    const ManifoldRecord& operator[](std::size_t manifold) const { return records_[manifold]; }
    PagedArray<ManifoldRecord>& records() { return records_; }
    const PagedArray<ManifoldRecord>& records() const { return records_; }

    std::span<ManifoldRecord> of(const ContactRecord& contact) {
        if (contact.firstManifold == kNone) return {};
        return {&records_[contact.firstManifold], contact.manifoldCapacity};
    }
    std::span<const ManifoldRecord> of(const ContactRecord& contact) const {
        return const_cast<Manifolds*>(this)->of(contact);
    }
    /// Calls visit(index) for the manifolds of a contact.
    template <class Visit>
    static void forEach(const ContactRecord& contact, Visit&& visit) {
        for (std::uint32_t k = 0; contact.firstManifold != kNone && k < contact.manifoldCapacity; ++k)
            visit(contact.firstManifold + k);
    }

    /// So many records in a row, of any values.
    std::uint32_t acquire(std::uint32_t count);
    /// Of a contact whose manifolds have neither points nor lanes.
    void release(ContactRecord& contact);
    /// Records for what a contact without any has found, until `settle`. On any worker.
    std::span<ManifoldRecord> hold(ContactRecord& contact, int worker);
    /// Before a step collides: each worker has room for what any may find.
    void makeRoomToHold();
    /// Gives held records their place.
    void settle(ContactRecord& contact, std::uint32_t index);
    /// All may fall asleep at once, when nothing may grow.
    void makeRoomToStore();

    /// N s; of what has a lane, what the lane says of substeps of so many seconds. Without lane or stored ones: zero.
    ManifoldImpulses impulsesOf(const ManifoldRecord& manifold, const ConstraintGraph& graph, float substep) const;
    /// Keeps impulses for the time without a lane.
    void store(ManifoldRecord& manifold, const ManifoldImpulses& impulses);
    void forgetStored(ManifoldRecord& manifold);
    /// Of one that has stored impulses.
    ManifoldImpulses& storedOf(const ManifoldRecord& manifold) { return stored_[manifold.stored]; }

    /// Calls move(first, count) for each row of free records, rows of several before single ones.
    template <class Move>
    void moveFree(std::uint32_t count, Move&& move) {
        for (std::uint32_t& first : count > 1 ? freeRows_ : free_) move(first, count);
    }

    template <class Archive>
    void archive(Archive& archive) {
        archive(records_);
        meshMemory.archive(archive);
        archive(free_);
        archive(freeRows_);
        archive(stored_);
        archive(freeStored_);
    }

    MeshMemory meshMemory;               ///< triangles around pairs with meshes
    AlignedArray<std::uint8_t> touches;  ///< per manifold, a ManifoldTouch at the end of the last step; not saved

private:
    PagedArray<ManifoldRecord> records_;
    AlignedArray<std::uint32_t> free_, freeRows_;  ///< single, and rows of kMaxManifolds
    AlignedArray<ManifoldImpulses> stored_;
    AlignedArray<std::uint32_t> freeStored_;
    std::vector<AlignedArray<ManifoldRecord>> held_;  ///< per worker
};

}  // namespace ragtop
