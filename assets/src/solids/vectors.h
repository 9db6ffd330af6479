#pragma once

#include <algorithm>
#include <cmath>

#include "ragtop/math.h"

/// Products of vectors in double precision, for geometry at load time.
namespace ragtop {

constexpr double dot(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr DVec3 cross(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr DVec3 lowest(const DVec3& a, const DVec3& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr DVec3 highest(const DVec3& a, const DVec3& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline double length(const DVec3& a) { return std::sqrt(dot(a, a)); }

/// normal · x = offset on it.
struct DPlane {
    DVec3 normal;  ///< unit
    double offset = 0;

    constexpr double height(const DVec3& p) const { return dot(normal, p) - offset; }
};

}  // namespace ragtop
