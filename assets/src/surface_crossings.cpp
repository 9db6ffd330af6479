#include "surface_crossings.h"

#include <algorithm>
#include <cmath>

namespace ragtop {

void SurfaceCrossings::add(const Shape& surface, const Pose& pose) {
    BodyDef def;
    def.type = BodyType::fixed;
    def.pose = pose;
    def.shapes.push_back({.geometry = surface});
    const Bounds one = world_.bounds(world_.shapes(world_.create(def))[0]);
    if (!bounds_) bounds_ = one;
    bounds_->lower = min(bounds_->lower, one.lower);
    bounds_->upper = max(bounds_->upper, one.upper);
}

SurfaceCrossings::Behind SurfaceCrossings::behind(const DVec3& point) const {
    const auto isBetween = [](double x, float lower, float upper) {
        return static_cast<double>(lower) <= x && x <= static_cast<double>(upper);
    };
    if (!bounds_ || !isBetween(point.x, bounds_->lower.x, bounds_->upper.x) ||
        !isBetween(point.z, bounds_->lower.z, bounds_->upper.z) || !(point.y < static_cast<double>(bounds_->upper.y)))
        return {};
    const double top = static_cast<double>(bounds_->upper.y) + 1;
    const double bottom = std::min(point.y, static_cast<double>(bounds_->lower.y)) - 1;
    const auto above = lastFront({point.x, top, point.z}, point.y), ceiling = firstFront(point, top);
    if (!above || (ceiling && *ceiling < *above)) return {};
    const auto below = lastFront({point.x, bottom, point.z}, point.y), floor = firstFront(point, bottom);
    if (floor && (!below || *below < *floor)) return {};
    const double depth = std::min(*above - point.y, below ? point.y - *below : *above - point.y);
    return {static_cast<float>(depth), below.has_value()};
}

std::optional<double> SurfaceCrossings::firstFront(const DVec3& from, double height) const {
    const Hit hit = world_.castRay({from, {0, static_cast<float>(height - from.y), 0}});
    return hit ? std::optional(hit.point.y) : std::nullopt;
}

std::optional<double> SurfaceCrossings::lastFront(DVec3 from, double height) const {
    constexpr int kMostLayers = 64;
    std::optional<double> last;
    // Past what was met by what a float can tell there.
    const double past = std::copysign(1e-6 * (1 + std::abs(from.y - height) + std::abs(height)), height - from.y);
    for (int i = 0; i < kMostLayers; ++i) {
        if (!((height - from.y) * past > 0)) break;
        const auto next = firstFront(from, height);
        if (!next) break;
        last = next;
        from.y = *next + past;
    }
    return last;
}

}  // namespace ragtop
