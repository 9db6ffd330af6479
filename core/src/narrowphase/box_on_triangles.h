#pragma once

#include <span>

#include "narrowphase/four_triangles.h"
#include "narrowphase/manifold.h"

/// A box on triangles: separating axes of four of them side by side, and the contacts along those.
namespace ragtop {

/// A box about the origin of a frame, which is that of the triangles.
struct TurnedBox {
    Vec3 axes[3];
    Vec3 half;
    float size = 0;  ///< m, the smallest half extent

    TurnedBox(const Vec3& halfExtents, const Quat& rotation);
    /// Half extents along the axes of the frame.
    Vec3 reach() const {
        return half.x * abs(axes[0]) + half.y * abs(axes[1]) + half.z * abs(axes[2]);
    }
    Vec3 corner(int i) const {
        return (i & 4 ? half.x : -half.x) * axes[0] + (i & 2 ? half.y : -half.y) * axes[1] +
               (i & 1 ? half.z : -half.z) * axes[2];
    }
};

/// Axes of least overlap, with hysteresis in favour of the triangle's own normal, then of faces of the box.
struct BoxAxes {
    /// What an axis is made of: the normal of the triangle, a face of the box, or an edge of each.
    enum Kind { kTriangle, kBoxFace, kEdges };
    static constexpr int kFirstEdges = 7;  ///< after the triangle and six faces

    FourFloats separation;
    FourInts axis;         ///< 0 triangle; 1 + 2 i + (1: positive side) face; kFirstEdges + 3 k + i edges
    unsigned touches = 0;  ///< bit per lane: no axis separates it by more than the margin

    Kind kind(int lane) const { return axis[lane] == 0 ? kTriangle : axis[lane] < kFirstEdges ? kBoxFace : kEdges; }
};

/// Triangles whose plane the middle of the box is more than `behind` (m) behind are left out.
BoxAxes findBoxAxes(const TurnedBox& box, const FourTriangles& triangles, float margin, float behind);

/// A triangle in the frame of the box.
struct CornersAndNormal {
    const Vec3 (&v)[3];
    const Vec3& normal;
};

inline constexpr int kMostBoxPoints = 16;  ///< a face of four corners cut by three sides has 7

/// The face of the box that opposes the triangle, cut to it, as clipToFace does; returns how many points.
int boxFaceOnTriangle(const TurnedBox& box, const CornersAndNormal& t, float margin, ManifoldPoint (&out)[kMostBoxPoints]);
/// The triangle cut to a face of the box, given as BoxAxes does. `normal` is from the triangle to the box.
int triangleOnBoxFace(const TurnedBox& box, const CornersAndNormal& t, int axis, float margin, Vec3& normal,
                      ManifoldPoint (&out)[kMostBoxPoints]);
/// Where an edge of each is nearest to the other; none when that is farther than the margin.
int edgesOfBoxAndTriangle(const TurnedBox& box, const CornersAndNormal& t, int axis, float separation, float margin,
                          Vec3& normal, ManifoldPoint (&out)[kMostBoxPoints]);

}  // namespace ragtop
