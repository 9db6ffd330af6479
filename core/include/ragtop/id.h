#pragma once

#include <cstdint>

namespace ragtop {

/// A name for an object in a world: an index that is reused and a generation that is not, so that the id of a
/// destroyed object never names its successor. A default id names nothing.
template <class Tag>
struct Id {
    std::uint32_t index = 0;
    std::uint32_t generation = 0;

    constexpr bool isNull() const { return generation == 0; }
    constexpr bool operator==(const Id&) const = default;
    constexpr auto operator<=>(const Id&) const = default;
};

using BodyId = Id<struct BodyTag>;
using ShapeId = Id<struct ShapeTag>;
using JointId = Id<struct JointTag>;
using CouplingId = Id<struct CouplingTag>;

}  // namespace ragtop
