#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/aligned_array.h"
#include "model/records.h"
#include "ragtop/id.h"
#include "ragtop/math.h"

/// What stages of a step find, for a moment.
namespace ragtop {

/// What a pass over constraints does.
enum class SolvePass { warmStart, solve, relax };

/// Numbers by region.
struct ByRegion {
    explicit ByRegion(std::pmr::memory_resource* memory) : items(memory), starts(memory) {}
    std::span<const std::uint32_t> of(int region) const {
        const auto r = static_cast<std::size_t>(region);
        return {items.data() + starts[r], starts[r + 1] - starts[r]};
    }
    /// item(i) of `count`, in that order, to regionOf(i) from 0 to `regions`.
    template <class Item, class RegionOf>
    void fill(int regions, std::size_t count, Item&& item, RegionOf&& regionOf) {
        starts.clear();
        starts.resize(static_cast<std::size_t>(regions) + 3, 0);
        for (std::size_t i = 0; i < count; ++i) ++starts[regionOf(i) + 2];
        for (std::size_t r = 2; r < starts.size(); ++r) starts[r] += starts[r - 1];
        items.resizeForOverwrite(count);
        for (std::size_t i = 0; i < count; ++i) items[starts[regionOf(i) + 1]++] = item(i);
    }
    AlignedArray<std::uint32_t> items, starts;
};

/// Islands that are solved side by side (world/world_regions.cpp); region 0 is what belongs to none.
struct Regions {
    explicit Regions(std::pmr::memory_resource* memory)
        : bodies(memory),
          articulations(memory),
          modules(memory),
          usedLists(memory),
          listStarts(memory),
          weights(memory),
          ofIsland(memory),
          loads(memory) {}
    bool independent = false;                  ///< each goes through the substeps of this step by itself
    ByRegion bodies, articulations, modules;   ///< of this step, while they are independent; of modules, their groups
    AlignedArray<std::uint32_t> usedLists;     ///< per region: a bit per list that holds something
    AlignedArray<int> listStarts;              ///< scratch: blocks of each list of the graph
    AlignedArray<std::uint32_t> weights, ofIsland;  ///< scratch: per body that is the root of an island
    AlignedArray<std::uint32_t> loads;              ///< scratch: weight of each region
    std::uint32_t wait = 0, nextWait = 0;           ///< steps until islands are looked at again
};

/// What modules do between the substeps of a step, and to whom (world_modules.cpp). Modules that name a moving body in
/// common are a group, and groups have nothing to do with each other. Found anew in every step.
struct ModuleWork {
    explicit ModuleWork(std::pmr::memory_resource* memory)
        : named(memory), namer(memory), spans(memory), acting(memory), parent(memory), groupOf(memory), starts(memory),
          members(memory) {}
    bool onAll = false;                           ///< some module names no body: it may act on any body
    bool inSubsteps = false;                      ///< modules may act now, on any worker
    AlignedArray<std::uint32_t> named;            ///< bodies, each once, in the order of modules
    AlignedArray<std::uint32_t> namer;            ///< per body: 1 + the first place in `acting` that named it; 0: none
    AlignedArray<std::span<const BodyId>> spans;  ///< per module, what it named
    AlignedArray<std::uint32_t> acting;           ///< modules that named something, in the order of registration
    AlignedArray<std::uint32_t> parent, groupOf;  ///< per place there: union-find; the group
    AlignedArray<std::uint32_t> starts, members;  ///< of each group, and the end; places in `acting`, in their order
    double ms = 0;                                ///< of this step, between its substeps
    std::uint64_t strays = 0;                     ///< impulses left out, since the world was made

    std::size_t groupCount() const { return starts.empty() ? 0 : starts.size() - 1; }
    bool acts() const { return onAll || !acting.empty(); }
    bool actsOn(std::uint32_t body) const { return onAll || (body < namer.size() && namer[body] != 0); }
};

/// Which bodies a step solves (world_freezing.cpp).
struct Freezing {
    explicit Freezing(std::pmr::memory_resource* memory) : unfrozen(memory) {}
    /// Counts the steps for which a body has been still; `slow`: below what counts as that, over the whole step.
    void record(BodyRecord& body, bool slow);
    /// m/s, when gravity gives so much in a substep.
    static float slowest(float gravityStep);
    std::atomic<bool> anyStill{false};       ///< has any body been still for long enough to rest?
    std::span<const std::uint32_t> solved;   ///< awake bodies that do not rest
    AlignedArray<std::uint32_t> unfrozen;    ///< the same while some rest
};

}  // namespace ragtop
