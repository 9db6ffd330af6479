#pragma once

#include "narrowphase/clip.h"
#include "narrowphase/collide.h"
#include "narrowphase/gjk.h"
#include "narrowphase/separating_axis.h"

/// Pair tests behind collide(): each in one order of the shapes, in the frame of the first.
namespace ragtop::pairs {

/// Size to which the tolerances of a pair are relative: the smaller inner radius.
float sizeOf(const ConvexView& shape);

void boxes(const Vec3& halfExtentsA, const Vec3& halfExtentsB, const Frame& bInA, float margin, SeparationCache& cache,
           Manifold& out);
void hulls(const HullView& a, const HullView& b, const Frame& bInA, float margin, SeparationCache& cache,
           Manifold& out);
void spheres(float radiusA, float radiusB, const Vec3& centerB, float margin, Manifold& out);
void capsules(const ConvexView& a, const ConvexView& b, const Frame& bInA, float margin, Manifold& out);
void capsuleSphere(const ConvexView& a, float radiusB, const Vec3& centerB, float margin, Manifold& out);
void boxSphere(const Vec3& halfExtents, float radius, const Vec3& center, float margin, Manifold& out);
void hullSphere(const HullView& a, float radius, const Vec3& center, float margin, Manifold& out);
/// Contact of two polyhedra in one frame along a chosen axis.
void hullContact(const HullView& a, const HullView& b, const SeparatingAxis& axis, float margin, float size,
                 Manifold& out);
/// Contact of two polyhedra, given by their corners, where faces and edges along the axis give none. `apart`: from B to A.
void cornerContact(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& apart, const SeparatingAxis& axis,
                   float margin, Manifold& out);
/// The core of a capsule.
struct Rod {
    Vec3 p, q;
    float radius;
    float margin;
    float size;  ///< to which tolerances are relative
};
/// Writes the one or two points where the core, cut to the sides of the face, ends; 0 when it is not over the face.
int segmentOnFace(const HullView& a, int face, const Rod& rod, ManifoldPoint* out);
/// The segment from p to q, thickened by `radius`.
void hullCapsule(const HullView& a, const Vec3& p, const Vec3& q, float radius, float margin, Manifold& out);

/// One point from the closest points of two shapes apart; none when they overlap or are farther apart than margin.
void closestPoint(const gjk::Closest& cores, float radiusA, float radiusB, float margin, std::uint32_t feature,
                  Manifold& out);
/// One point at a place of both shapes, of an overlap along an axis whose faces and edges are not where they overlap.
/// The deepest corner would be one of many, and may be as far away as the shape is large.
void commonPoint(const Vec3& normal, float separation, const Vec3& position, Manifold& out);
/// The manifold of the pair in the other order, seen from the other shape, whose frame is `otherInThis`.
void flip(Manifold& manifold, const Frame& otherInThis);

}  // namespace ragtop::pairs
