#pragma once

#include <array>

#include "ragtop/query.h"

namespace ragtop {

class World;

/// What a chassis sees of the world below it.
QueryFilter queryOf(const Filter& filter, BodyId chassis);

/// The shapes about a car, found once for all casts of its step.
class Nearby {
public:
    /// The query that sees these alone; of more than kMost, the same as it was, which goes through the world's trees.
    QueryFilter among(const World& world, const QueryFilter& query, const Bounds& bounds);

private:
    static constexpr std::size_t kMost = 16;  ///< as a cast goes past in the time that the trees take
    std::array<ShapeId, kMost> shapes_;
    std::size_t count_ = 0;
};

}  // namespace ragtop
