#pragma once

#include <cstddef>
#include <memory_resource>

#include "base/stage_runner.h"
#include "broadphase/broadphase.h"
#include "model/bodies.h"
#include "model/joints.h"
#include "model/shapes.h"
#include "ragtop/world.h"

namespace ragtop {

/// What the search for pairs reads, and the broad phase, in whose search the pairs are left.
struct PairView {
    const Bodies& bodies;
    const Shapes& shapes;
    const Joints& joints;
    Broadphase& broadphase;
    const WorldCallbacks& callbacks;
    std::pmr::memory_resource* memory;
};

/// Pairs that are not known yet of all shapes in the move buffer, and of obstacles there one by one, since few come
/// anew: the first so many lists of the search's `found`, in an order that depends on the scene alone.
std::size_t findPairs(const PairView& view, StageRunner& runner, bool obstaclesToo);

}  // namespace ragtop
