#pragma once

#include <cstdint>

#include "narrowphase/distance.h"
#include "ragtop/query.h"
#include "ragtop/shape.h"

/// Queries against one shape (no Compound) at a pose in the world. Everything is computed in the target's frame, and
/// the points and normals of hits are in it: transformPoint(pose, hit.point) and rotate(pose.rotation, hit.normal)
/// bring them into the world. `closer` is the largest fraction of interest. `triangle` is set when a triangle of a mesh
/// or height field is hit, to its index in the caller's list or to 2 · cell + half. Rays meet triangles from the front
/// only.
namespace ragtop {

SweepHit castRayAtShape(const Shape& target, const Pose& pose, const Ray& ray, float closer, std::uint32_t& triangle);

/// The moving shape is convex (std::invalid_argument otherwise) and starts at {path.origin, rotation}.
SweepHit sweepShapeAtShape(const Shape& moving, const Quat& rotation, const Ray& path, const Shape& target,
                           const Pose& targetPose, float closer, std::uint32_t& triangle);

/// Does the convex query shape (std::invalid_argument otherwise) touch the surface or the inside of the target? Meshes
/// and height fields are surfaces without an inside.
bool overlapsShape(const Shape& query, const Pose& queryPose, const Shape& target, const Pose& targetPose);

}  // namespace ragtop
