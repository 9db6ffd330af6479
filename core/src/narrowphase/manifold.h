#pragma once

#include <cstdint>
#include <span>

#include "ragtop/math.h"

namespace ragtop {

inline constexpr int kMaxManifoldPoints = 4;  ///< as contact::kMaxPoints
/// Directions in which one pair may touch (a box in a corner of a mesh); nearer ones are merged.
inline constexpr int kMaxManifolds = 8;

struct ManifoldPoint {
    Vec3 position;         ///< half way between the surfaces, in A's frame
    float separation = 0;  ///< m, negative when overlapping
    std::uint32_t feature = 0;  ///< names the vertex, edge or face pair; the same while the pair stays so
};

/// Where and along which direction two shapes touch, in the frame of shape A.
struct Manifold {
    Vec3 normal;  ///< unit, from A to B
    int pointCount = 0;
    float gap = 0;  ///< m; where there are no points, the shapes are at least so far apart
    ManifoldPoint points[kMaxManifoldPoints];
    std::uint32_t triangle = 0;  ///< of a mesh or height field, the deepest one

    std::span<ManifoldPoint> all() { return {points, static_cast<std::size_t>(pointCount)}; }
    std::span<const ManifoldPoint> all() const { return {points, static_cast<std::size_t>(pointCount)}; }
    void clear() { pointCount = 0; }
};

/// What a pair remembers between steps to find its separating axis at once.
struct SeparationCache {
    std::uint8_t kind = 0;  ///< 0 none, 1 face of A, 2 face of B, 3 edge pair
    std::uint8_t indexA = 0, indexB = 0;
    std::uint8_t pad = 0;
    float separation = 0;
};

}  // namespace ragtop
