#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <span>

#include "base/aligned_array.h"

namespace ragtop {

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
          weights(memory),
          ofIsland(memory),
          loads(memory),
          struck(memory),
          struckFound(memory),
          struckIn(memory) {}
    bool independent = false;                 ///< each goes through the substeps of this step by itself
    ByRegion bodies, articulations, modules;  ///< of this step, while they are independent; of modules, their groups
    AlignedArray<std::uint32_t> weights, ofIsland;  ///< scratch: per body that is the root of an island
    AlignedArray<std::uint32_t> loads;              ///< scratch: weight of each region
    ByRegion struck;                                ///< manifolds of this step that something strikes, or did lately
    AlignedArray<std::uint32_t> struckFound;        ///< scratch: the same in one list
    AlignedArray<int> struckIn;            ///< scratch: per body, the substep from 1 in which its loads were looked at
    std::uint32_t wait = 0, nextWait = 0;  ///< steps until islands are looked at again
};

}  // namespace ragtop
