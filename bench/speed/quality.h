#pragma once

#include "../stability/engine.h"

namespace ragtop::speed {

/// How well a scene holds together, by geometry alone and so the same for every engine.
struct Quality {
    double overlapP99 = 0, overlapMax = 0;  ///< m, of moving boxes, balls and capsules with anything but hulls
    double gapMax = 0;                      ///< m, between points that joints hold together
    double movedMax = 0;                    ///< m, of dynamic bodies from where the scene put them
};
Quality measureQuality(const Scene& scene, const stability::Engine& engine);

}  // namespace ragtop::speed
