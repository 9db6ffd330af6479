#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "base/paged_array.h"
#include "constraints/coupling.h"
#include "constraints/joint_bundles.h"
#include "constraints/joint_sim.h"
#include "model/joint_sims.h"
#include "model/records.h"

namespace ragtop {

/// Joints with springs, in the order of the lists of the graph, and where those of each list begin.
struct Springs {
    explicit Springs(std::pmr::memory_resource* memory) : joints(memory), starts(memory) {}
    AlignedArray<std::uint32_t> joints, starts;
};

/// The joints of a world: a record of each with its definition, the form in which solvers know it, and the bundles in
/// which those of a colour are solved side by side.
class Joints {
public:
    Joints(int lanes, std::pmr::memory_resource* memory)
        : slots(memory),
          sims(memory),
          created(memory),
          violated(memory),
          broken(memory),
          bundles(lanes, memory),
          springs(memory),
          records_(memory) {}

    /// A joint with all values as they are declared; those that were released are used first.
    std::uint32_t acquire(JointKind kind) {
        const std::uint32_t joint = slots.acquire();
        if (joint >= records_.size()) records_.resize(joint + 1, JointRecord{});
        records_[joint] = JointRecord{};
        sims.acquire(joint, kind);
        return joint;
    }
    /// Of a joint that hangs on no body and has no place in the graph.
    void release(std::uint32_t joint) {
        unlist(joint);
        sims.release(joint);
        slots.release(joint);
    }
    /// It is no longer one that was just made, or made beyond its limits.
    void unlist(std::uint32_t joint) {
        for (AlignedArray<std::uint32_t>* list : {&created, &violated})
            for (std::uint32_t& listed : *list)
                if (listed == joint) listed = kNone;
    }
    /// Is it in the graph, as joints are between bodies that take part, of which one is awake and moved by forces?
    bool isHolding(std::uint32_t joint) const { return records_[joint].place.color != kNone; }

    std::size_t size() const { return records_.size(); }
    std::size_t bytes() const { return records_.bytes() + sims.bytes() + bundles.bytes(); }
    JointRecord& operator[](std::size_t joint) { return records_[joint]; }
    const JointRecord& operator[](std::size_t joint) const { return records_[joint]; }
    JointId id(std::uint32_t joint) const { return {joint, slots.generation(joint)}; }
    /// The next edge key of a body's list of joints.
    std::uint32_t next(std::uint32_t key) const { return records_[key >> 1].edges[key & 1].next; }

    template <class Archive>
    void archive(Archive& archive) {
        slots.archive(archive);
        archive(records_);
        sims.archive(archive);
        archive(created);
        archive(violated);
    }

    Slots slots;
    JointSims sims;
    AlignedArray<std::uint32_t> created;     ///< since the last step; kNone: gone again
    bool opened = false;                     ///< a caller has put ends of some apart since groups were found
    AlignedArray<std::uint32_t> violated;    ///< made beyond their hard limits, and beyond them still; kNone: gone
    std::pmr::vector<std::uint32_t> broken;  ///< scratch of breaking
    JointBundles bundles;
    Springs springs;             ///< derived, as bundles are
    bool bundlesChanged = true;  ///< joints came, went or changed since they were bundled

private:
    PagedArray<JointRecord> records_;
};

/// The couplings of a world, which hang in a list of each of their joints.
class Couplings {
public:
    explicit Couplings(std::pmr::memory_resource* memory)
        : slots(memory), sims(memory), iterated(memory), records_(memory) {}

    std::uint32_t acquire() {
        const std::uint32_t coupling = slots.acquire();
        if (coupling >= records_.size()) {
            records_.resize(coupling + 1, CouplingRecord{});
            sims.resize(coupling + 1, CouplingSim{});
        }
        records_[coupling] = CouplingRecord{};
        sims[coupling] = CouplingSim{};
        return coupling;
    }
    void release(std::uint32_t coupling) { slots.release(coupling); }

    std::size_t size() const { return records_.size(); }
    CouplingRecord& operator[](std::size_t coupling) { return records_[coupling]; }
    const CouplingRecord& operator[](std::size_t coupling) const { return records_[coupling]; }
    CouplingId id(std::uint32_t coupling) const { return {coupling, slots.generation(coupling)}; }

    template <class Archive>
    void archive(Archive& archive) {
        slots.archive(archive);
        archive(records_);
        archive(sims);
    }

    Slots slots;
    AlignedArray<CouplingSim> sims;
    AlignedArray<std::uint32_t> iterated;  ///< in this step: those whose joints are

private:
    AlignedArray<CouplingRecord> records_;
};

}  // namespace ragtop
