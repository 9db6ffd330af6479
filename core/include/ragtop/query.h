#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"

namespace ragtop {

/// A ray or the path of a shape: from `origin` along `translation`.
struct Ray {
    DVec3 origin{};
    Vec3 translation{};  ///< m, from start to end
};

/// Which shapes a query sees: its category must meet the shape's mask, and its mask the shape's category.
struct QueryFilter {
    std::uint32_t category = 0xffffffffu;
    std::uint32_t mask = 0xffffffffu;
    BodyId ignore{};         ///< a body that is not seen; null: none
    bool sensors = false;  ///< see sensors too
    /// Shapes that it sees alone, where they are given: for several casts at one place, around which World::overlap
    /// finds them once. Of shapes that are equally near any may be met.
    std::optional<std::span<const ShapeId>> among{};
};

/// The nearest shape that a query met.
struct Hit {
    ShapeId shape;  ///< null: nothing was met
    BodyId body;
    float fraction = 1;  ///< share of the translation travelled; 0 when the query starts inside
    DVec3 point;         ///< m, in the world
    Vec3 normal;                 ///< of the surface, towards the side that the query comes from
    std::uint32_t triangle = 0;  ///< index, of a mesh or height field
    std::uint32_t surface = 0;   ///< Material::surface there
    /// The front of a triangle, met within its edges by a ray or a ball: point and normal are its plane's, to a
    /// rounding.
    bool onFace = false;

    explicit operator bool() const { return !shape.isNull(); }
};

}  // namespace ragtop
