#pragma once

#include <cstdint>

namespace ragtop {

/// Names an object in a world by an index, which is reused, and a generation, which is not: the id of a destroyed
/// object never names its successor. A default id is null and names nothing.
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
