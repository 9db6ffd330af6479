#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/aligned_array.h"
#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/module.h"

namespace ragtop {

/// What modules do between the substeps of a step, and to whom (world/world_modules.cpp). Modules that name a moving
/// body in common are a group, and groups have nothing to do with each other. Found anew in every step.
struct ModuleWork {
    explicit ModuleWork(std::pmr::memory_resource* memory)
        : named(memory),
          namer(memory),
          velocityBefore(memory),
          spans(memory),
          acting(memory),
          parent(memory),
          groupOf(memory),
          starts(memory),
          members(memory) {}
    std::vector<StepModule*> modules;             ///< those there are, in the order of registration
    bool onAll = false;                           ///< some module names no body: it may act on any body
    bool inSubsteps = false;                      ///< modules may act now, on any worker
    AlignedArray<std::uint32_t> named;            ///< bodies, each once, in the order of modules
    AlignedArray<std::uint32_t> namer;            ///< per body: 1 + the first place in `acting` that named it; 0: none
    AlignedArray<Vec3> velocityBefore;  ///< m/s, per body that modules act on: before they did in this substep
    AlignedArray<std::span<const BodyId>> spans;  ///< per module, what it named
    AlignedArray<std::uint32_t> acting;           ///< modules that named something, in the order of registration
    AlignedArray<std::uint32_t> parent, groupOf;  ///< per place there: union-find; the group
    AlignedArray<std::uint32_t> starts, members;  ///< of each group, and the end; places in `acting`, in their order
    double ms = 0;                                ///< of this step, between its substeps
    std::uint64_t strays = 0;                     ///< impulses left out, since the world was made

    std::size_t groupCount() const { return starts.empty() ? 0 : starts.size() - 1; }
    bool acts() const { return onAll || !acting.empty(); }
    bool names(std::uint32_t body) const { return body < namer.size() && namer[body] != 0; }
    bool actsOn(std::uint32_t body) const { return onAll || names(body); }
};

}  // namespace ragtop
