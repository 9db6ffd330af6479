#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "ragtop/shape.h"

namespace ragtop {

inline std::vector<Vec3> boxCorners(const Vec3& half) {
    std::vector<Vec3> corners;
    for (const float x : {-half.x, half.x}) {
        for (const float y : {-half.y, half.y}) {
            for (const float z : {-half.z, half.z}) corners.push_back({x, y, z});
        }
    }
    return corners;
}

/// 4 level² + 2 points of an octahedron cut into smaller triangles, moved out to a sphere.
inline std::vector<Vec3> spherePoints(int level, float radius) {
    std::vector<Vec3> points;
    for (int x = -level; x <= level; ++x) {
        for (int y = -level; y <= level; ++y) {
            const int z = level - std::abs(x) - std::abs(y);
            if (z < 0) continue;
            const Vec3 p{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
            points.push_back(radius * normalized(p));
            if (z > 0) points.push_back(radius * normalized(Vec3{p.x, p.y, -p.z}));
        }
    }
    return points;
}

template <class Action>
void expectThrow(Action&& action, const std::string& message) {
    try {
        action();
        ADD_FAILURE() << "nothing thrown, wanted: " << message;
    } catch (const std::invalid_argument& error) {
        EXPECT_EQ(error.what(), message);
    }
}

inline bool hullsCanBeBuilt() {
    try {
        ConvexHull{boxCorners({1, 1, 1})};
        return true;
    } catch (const std::invalid_argument&) {
        return false;
    }
}

}  // namespace ragtop

/// Builds without Qhull refuse hulls.
#define RAGTOP_NEEDS_HULLS() \
    if (!hullsCanBeBuilt()) GTEST_SKIP() << "this build has no Qhull"
