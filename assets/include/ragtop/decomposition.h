#pragma once

#include <string>
#include <vector>

#include "ragtop/shape.h"
#include "ragtop/tasks.h"
#include "ragtop/tunables.h"

namespace ragtop {

/// When a decomposition is good enough, and what it may take.
struct DecompositionOptions {
    int maxPieces = 16;       ///< hulls
    int maxVertices = 128;    ///< of each hull; half as many where these do
    float maxError = 0.005f;  ///< m, from the solid to the farthest air in a hull
    float maxVolume = 1.1f;   ///< of the hulls together, over that of the solid
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DecompositionOptions*) {
    visit(Tunable{"maxPieces", "", 1, 256, "most hulls"}, self.maxPieces);
    visit(Tunable{"maxVertices", "", 8, 128, "most vertices of each hull; half as many where these do"},
          self.maxVertices);
    visit(Tunable{"maxError", "m", 1e-6, 1e5, "from the solid to the farthest air in a hull"}, self.maxError);
    visit(Tunable{"maxVolume", "1", 1.001, 1e6, "of the hulls together, over that of the solid"}, self.maxVolume);
}

/// Convex pieces that together hold a solid. They meet in planes, and may overlap a little.
struct Decomposition {
    std::vector<ConvexHull> pieces;
    float error = 0;        ///< m, from the solid to the farthest air in a piece, of 3,000 rays from the solid
    float volume = 0;       ///< m³, of the pieces together
    float solidVolume = 0;  ///< m³
    int fewestPieces = 1;   ///< no fewer keep to `maxError`, whatever their shape; counted to one above `maxPieces`
    bool isWithin(const DecompositionOptions& options) const {
        return error <= options.maxError && volume <= options.maxVolume * solidVolume;
    }
};

/// Few convex pieces that hold a closed mesh and little air: those that keep to the error and the volume where
/// `maxPieces` suffice, else as many. The mesh itself is cut by planes, along its faces where it is concave there, and
/// the pieces are joined again where that costs little [Wei, Liu, Ling, Su, Approximate Convex Decomposition for 3D
/// Meshes with Collision-Aware Concavity and Tree Search, 2022; Mamou, Volumetric Hierarchical Approximate Convex
/// Decomposition, 2016]. Pieces hold all vertices of the mesh, to within 5e-5 of its size. The same bits with any
/// tasks. Throws std::invalid_argument: an option out of range, a mesh that is open, inside out or flat.
Decomposition decompose(const TriangleMesh& mesh, const DecompositionOptions& options = {},
                        const TaskRunner& tasks = serialTasks());

/// The pieces as one shape.
Compound compoundOf(const Decomposition& decomposition);

std::string whyInvalid(const DecompositionOptions& options);

}  // namespace ragtop
