#pragma once

#include <span>

#include "narrowphase/manifold.h"
#include "ragtop/math.h"
#include "shapes/geometry.h"

/// Contact points of meshes that move. `bInA` is B's frame in A's. Pure functions: thread safe, no allocation.
namespace ragtop {

/// How far apart points are reported.
struct ContactReach {
    float margin = 0;  ///< m, in every direction
    Vec3 way;          ///< m, by which B moves beside A in the coming step, in A's axes
    float size = 0;    ///< m, of the smaller shape: tolerances are relative to it
};

/// Two meshes (boxes and hulls count as such), a height field and a mesh, a mesh and a ball or capsule. Writes at most
/// kMaxManifolds and returns how many.
int collideSurfaces(const MeshData& a, const MeshData& b, const Frame& bInA, const ContactReach& reach,
                    std::span<Manifold> out);
int collideSurfaces(const HeightFieldData& a, const MeshData& b, const Frame& bInA, const ContactReach& reach,
                    std::span<Manifold> out);
int collideSurfaces(const MeshData& a, const ConvexView& round, const Frame& bInA, const ContactReach& reach,
                    std::span<Manifold> out);

}  // namespace ragtop
