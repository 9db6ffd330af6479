#pragma once

#include <memory>

#include "narrowphase/manifold.h"
#include "shapes/hull.h"

/// Separating axes of polyhedra given in one frame.
namespace ragtop {

/// A polyhedron moved into another frame.
class PlacedHull {
public:
    PlacedHull(const HullView& hull, const Frame& frame);
    PlacedHull(const PlacedHull&) = delete;
    PlacedHull& operator=(const PlacedHull&) = delete;
    const HullView& view() const { return view_; }

private:
    static constexpr std::size_t kMaxVertices = 128, kMaxFaces = 2 * kMaxVertices - 4;  ///< Euler: 2 V − 4 triangles
    // Not filled with zeros first: most hulls are small.
    union {
        Vec3 vertices_[kMaxVertices];
    };
    union {
        Plane planes_[kMaxFaces];
    };
    HullView view_;
};

/// An axis and what it is made of; the normal points from A to B.
struct SeparatingAxis {
    int kind = 0;  ///< as in SeparationCache
    int indexA = 0, indexB = 0;
    float separation = 0;
    Vec3 normal;
};

/// The separation along one axis, from all corners, so that a positive one proves it whatever the axis.
SeparatingAxis alongAxis(const HullView& a, const HullView& b, int kind, int indexA, int indexB);

struct AxisChoice {
    SeparatingAxis best;
    SeparatingAxis face;  ///< where the best is an edge pair: the best of the faces
};
/// The axis of least overlap, with hysteresis in favour of faces and of `before` (kind 0: nothing before); an axis that
/// separates by more than margin when there is one. Only faces listed in `faces` are tried, edges use the planes on
/// both sides: a triangle lists its front alone.
AxisChoice chooseAxis(const HullView& a, const HullView& b, float margin, float size, const SeparatingAxis& before);

SeparationCache toCache(const SeparatingAxis& axis);
/// Edge indices need nine bits: the highest are in `pad`.
inline int indexA(const SeparationCache& cache) { return cache.indexA | (cache.pad & 1) << 8; }
inline int indexB(const SeparationCache& cache) { return cache.indexB | (cache.pad & 2) << 7; }

}  // namespace ragtop
