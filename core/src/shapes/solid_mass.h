#pragma once

#include "shapes/geometry.h"

namespace ragtop {

/// Mass, centre and inertia about it in double precision, for load-time sums.
struct SolidMass {
    double mass = 0;
    DVec3 center;
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// Of the polyhedron at the given density.
SolidMass massOfHull(const HullData& hull, double density);
/// Of what a closed surface encloses; negative where its triangles face inwards.
SolidMass massOfMesh(const MeshData& mesh, double density);

}  // namespace ragtop
