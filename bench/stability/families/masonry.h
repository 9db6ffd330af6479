#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "../limit_analysis.h"
#include "../scenery.h"
#include "../suite.h"

/// Structures of dry blocks, each built twice from the same corners: as a scene for the engines, and as a linear program.
namespace ragtop::stability {

struct Masonry {
    explicit Masonry(float friction, int edges = 8) : material(surface(friction)), limit(edges) {}

    /// A stone of convex parts, each given by its corners in the world (m); returns its number among the stones.
    int addStone(const std::vector<std::vector<DVec3>>& parts, float density = 1);
    /// A convex stone between z = ± depth/2 with these corners in the x–y plane.
    int addSlab(const std::vector<DVec3>& corners, double depth);

    Material material;
    Scene scene;              ///< the stones' bodies follow the floor, which is the first
    LimitAnalysis limit;
    std::vector<int> stones;  ///< bodies of the scene
};

/// Corners of a joint between the slabs' edges from p to q.
std::vector<DVec3> edgeJoint(const DVec3& p, const DVec3& q, double depth);

struct Survival {
    double time = 0;  ///< s, until a stone had moved by `limit`
    double moved = 0;
};
Survival survive(Run& run, const std::vector<int>& stones, double seconds, double limit);

void addArchCases(Family& family);
void addDomeCases(Family& family);
void addCardCases(Family& family);

}  // namespace ragtop::stability
