#pragma once

#include <cmath>

#include "ragtop/math.h"

namespace ragtop::demos {

constexpr double dot(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr DVec3 cross(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const DVec3& a) { return std::sqrt(dot(a, a)); }

}  // namespace ragtop::demos
