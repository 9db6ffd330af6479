#pragma once

#include "ragtop/math.h"
#include "shapes/geometry.h"

/// GJK distance, sweeps and rays against single shapes, all in the frame of shape A.
namespace ragtop {

struct Distance {
    float distance = 0;  ///< between surfaces (radii taken off), 0 or negative when the cores or skins overlap
    Vec3 pointA, pointB; ///< on the surfaces, in A's frame
    Vec3 normal;         ///< unit, from A to B; {0,1,0} when the cores overlap
    bool coresOverlap = false;
};

/// [Gilbert, Johnson, Keerthi, 1988] with [Ericson 2005, ch. 9] sub-simplices.
Distance distance(const ConvexView& a, const ConvexView& b, const Frame& bInA);
/// Triangle as shape A.
Distance distance(const TriangleView& a, const ConvexView& b, const Frame& bInA);

struct SweepHit {
    bool hit = false;
    float fraction = 1;
    Vec3 point, normal;    ///< on A; normal from A towards B
    bool overlap = false;  ///< the cores overlap from the beginning: there is no normal
    bool onFace = false;   ///< of a triangle, as in Hit
};

/// B translates by `translation` from bInA without turning (conservative advancement). Fraction 0 when it starts in
/// touch. `closer` is the largest fraction of interest.
SweepHit sweep(const ConvexView& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer = 1);
SweepHit sweep(const TriangleView& a, const ConvexView& b, const Frame& bInA, const Vec3& translation,
               float closer = 1);

/// B moves from `start` to `end` (both in A's frame), linearly and turning at constant rate; the earliest fraction at
/// which the distance falls to `target`. Conservative advancement with the bound of the rotation about B's origin.
SweepHit timeOfImpact(const ConvexView& a, const ConvexView& b, const Frame& start, const Frame& end, float target);
SweepHit timeOfImpact(const TriangleView& a, const ConvexView& b, const Frame& start, const Frame& end, float target);

/// A ray from `origin` along `translation`; hits the front of triangles only; fraction 0 and normal against the ray when
/// it starts inside a solid.
SweepHit castRay(const ConvexView& shape, const Vec3& origin, const Vec3& translation, float closer = 1);
SweepHit castRay(const TriangleView& triangle, const Vec3& origin, const Vec3& translation, float closer = 1);

}  // namespace ragtop
