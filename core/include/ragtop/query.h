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

/// Which shapes a query sees: category must meet the shape's mask and mask its category.
struct QueryFilter {
    std::uint32_t category = 0xffffffffu;
    std::uint32_t mask = 0xffffffffu;
    BodyId ignore{};         ///< a body it does not see
    bool sensors = false;  ///< see sensors too
};

/// The nearest thing a query met. `fraction` is the share of the translation travelled, 0 when it starts inside.
struct Hit {
    ShapeId shape;  ///< null: nothing was met
    BodyId body;
    float fraction = 1;
    DVec3 point;
    Vec3 normal;                 ///< of the surface met, towards the ray's origin
    std::uint32_t triangle = 0;  ///< of a mesh or height field
    std::uint32_t surface = 0;   ///< Material::surface there

    explicit operator bool() const { return !shape.isNull(); }
};

}  // namespace ragtop
