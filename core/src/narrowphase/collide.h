#pragma once

#include <span>

#include "narrowphase/approach.h"
#include "narrowphase/manifold.h"
#include "narrowphase/near_triangles.h"
#include "ragtop/math.h"
#include "shapes/geometry.h"

/// Contact points of shape pairs. `bInA` is B's frame in A's. Points up to `margin` apart are reported (speculative
/// contacts); all other tolerances follow from the sizes of the shapes. Pure functions: thread safe, no allocation.
namespace ragtop {

/// Two convex shapes; pointCount 0 when farther apart than margin, and by how much at least then in `gap`.
void collide(const ConvexView& a, const ConvexView& b, const Frame& bInA, float margin, SeparationCache& cache,
             Manifold& out);

/// A mesh or height field (A) and a convex shape (B), internal edges filtered. Writes at most kMaxManifolds and returns
/// how many, in an order that is the same while the same triangles touch. Each triangle is looked at where the shape
/// first meets the surface, if not near it; points are then where the shape has them now.
int collide(const MeshData& a, const ConvexView& b, const Frame& bInA, float margin, std::span<Manifold> out,
            const Approach& approach = {});
/// The same with what is remembered of the triangles around this pair.
int collide(const MeshData& a, const ConvexView& b, const Frame& bInA, float margin, NearTriangles& near,
            std::span<Manifold> out, const Approach& approach = {});
int collide(const HeightFieldData& a, const ConvexView& b, const Frame& bInA, float margin, std::span<Manifold> out,
            const Approach& approach = {});

}  // namespace ragtop
