#pragma once

#include "narrowphase/distance.h"

namespace ragtop {

/// A mesh and what it may meet, both on their way: their centres along a line, turning about them at constant rates. In
/// the frame of the obstacle where it begins.
struct MeshPath {
    const MeshData* mesh = nullptr;
    Frame start;        ///< of the mesh
    Vec3 center;        ///< about which it turns, in its own frame
    Vec3 way, turn;     ///< m beside the obstacle; rad
    Vec3 axisCenter;    ///< about which the obstacle turns
    Vec3 axisTurn;      ///< rad, of the obstacle
    float target = 0;   ///< m, distance that counts as met
    float allowed = 0;  ///< m, that what touches at the beginning may go deeper

    /// Of the mesh in the obstacle at a share of the way.
    Frame at(float share) const;
};

struct MeshSweepHit : SweepHit {
    std::uint32_t triangle = 0;  ///< of the obstacle, as TriangleView has it
};

/// The first place where a surface is met, from its front, by conservative advancement of the triangles near the path.
/// What touches from the beginning is met at once if it would go deeper, else never.
MeshSweepHit timeOfImpact(const MeshData& obstacle, const MeshPath& path);
MeshSweepHit timeOfImpact(const HeightFieldData& obstacle, const MeshPath& path);
/// A ball or capsule.
MeshSweepHit timeOfImpact(const ConvexView& obstacle, const MeshPath& path);

}  // namespace ragtop
