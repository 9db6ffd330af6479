#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "ragtop/cloth.h"

/// What follows from a definition alone: masses, links with their stiffness, and the lines that these and the shear of
/// quads are solved along.
namespace ragtop::cloth {

inline constexpr int kNoPoint = -1;  ///< no index

struct Link {
    int a = 0, b = 0;
    float rest = 0;       ///< m
    float stiffness = 0;  ///< N/m
};

/// Points in a row, each linked to the next.
struct Chain {
    std::vector<int> points;
    std::vector<int> links;  ///< one fewer
};

/// Chains that share no point, so that all of them are solved at once.
struct Layer {
    std::vector<Chain> chains;  ///< longest first
};

/// Quads in a row, each with one side in common with the next: the ends of sides across it, one more than quads.
struct Strip {
    std::vector<std::pair<int, int>> rungs;
};

/// Strips that share no point.
struct StripLayer {
    std::vector<Strip> strips;  ///< longest first
};

struct Plan {
    std::vector<float> masses;      ///< kg, of each point
    std::vector<float> areas;       ///< m², of faces about each point
    std::vector<Link> links;
    std::vector<Layer> layers;      ///< in the order in which they are solved
    std::vector<StripLayer> strips;  ///< where the cloth resists shear
    std::vector<int> anchors;       ///< of each point the nearest attached one; kNoPoint: none
    std::vector<float> tethers;     ///< m, along links to it
};

Plan makePlan(const ClothDef& def);

/// Covers the quads of a cloth with layers of strips.
std::vector<StripLayer> makeStrips(const ClothDef& def);

/// kNoPoint where a point is not attached; else the index of its attachment.
std::vector<int> attachmentOfPoints(const ClothDef& def);

}  // namespace ragtop::cloth
