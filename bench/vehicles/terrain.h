#pragma once

#include <string>
#include <vector>

#include "ragtop/math.h"

namespace ragtop::fleet {

/// What cars drive on, the same for every engine. Squares of heights, and boxes that stand on them.
struct Terrain {
    static constexpr float kSpacing = 2;  ///< m between heights

    struct Block {
        DVec3 center;
        Vec3 halfExtents;
    };
    int columns = 0;             ///< and as many rows; the middle is the origin
    std::vector<float> heights;  ///< m; empty: the plane y = 0
    bool triangles = false;      ///< is it a mesh of triangles?
    std::vector<Block> blocks;   ///< fixed

    float extent() const { return 0.5f * kSpacing * static_cast<float>(columns - 1); }
    float heightAt(double x, double z) const;
    /// Two triangles per square, counter-clockwise seen from above.
    std::vector<Vec3> vertices() const;
    std::vector<int> indices() const;
};

/// `name` is flat, hills (a height field), mesh (the same hills as triangles) or city (kerbs and houses on a plane),
/// for a fleet that takes up `reach` m from the origin in x and z.
Terrain makeTerrain(const std::string& name, float reach);

}  // namespace ragtop::fleet
