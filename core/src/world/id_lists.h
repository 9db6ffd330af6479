#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "ragtop/id.h"

namespace ragtop {

/// What a world is asked for as a whole: derived data, rebuilt when objects have come or gone.
struct IdLists {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    std::vector<CouplingId> couplings;
    std::vector<std::vector<ShapeId>> bodyShapes;  ///< per slot of a body
    std::vector<std::vector<JointId>> bodyJoints;  ///< likewise
    std::uint64_t version = ~std::uint64_t{0};     ///< of the structure that they tell of
    std::mutex mutex;                              ///< guards all of it
};

}  // namespace ragtop
