#pragma once

#include <optional>

#include "../stability/engine.h"

namespace ragtop::speed {

/// How well a scene holds together, by geometry alone and so the same for every engine. Empty where there is nothing of
/// which it could be measured; NaN where a body of which it is measured is nowhere.
struct Quality {
    std::optional<double> overlapP99, overlapMax;  ///< m, of pairs that overlap; 0 where none does
    std::optional<double> below;                   ///< m, of the lowest centre below the surface of a mesh
    std::optional<double> gap;                     ///< m, between points that joints hold together
    std::optional<double> moved;                   ///< m, of dynamic bodies from where the scene put them
};

/// All of it, now.
Quality measureQuality(const Scene& scene, const stability::Engine& engine);
/// Takes what counts on the way too, `below` and `gap`, into what was the worst before.
void addQualityOnTheWay(const Scene& scene, const stability::Engine& engine, Quality& worst);

}  // namespace ragtop::speed
