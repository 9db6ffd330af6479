#pragma once

#include <cstdint>

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

    explicit operator bool() const { return !shape.isNull(); }
};

}  // namespace ragtop
