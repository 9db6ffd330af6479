#pragma once

#include "ragtop/balance.h"

namespace ragtop {

constexpr float kSoleShare = 0.85f;  ///< of the soles, that pressure is kept within so that they stay flat

/// Without its height.
inline Vec3 level(const Vec3& v) { return {v.x, 0, v.z}; }

/// Where the body stands and how it moves, relative to the middle of its feet.
struct Balance::Stand {
    DVec3 center;       ///< m, of the feet
    Vec3 mass, speed;   ///< m and m/s, of the centre of mass
    Vec3 capture;       ///< m
    Vec3 ahead;         ///< m, a/ω²: where the centre of mass is in balance over its pressure on ground that quickens
    Vec3 pressure;      ///< m, of the weight
    float rate = 0;     ///< 1/s, √(g/z)
    float height = 0;   ///< m, z
    float gravity = 0;  ///< m/s²
    bool both = false;
};

}  // namespace ragtop
