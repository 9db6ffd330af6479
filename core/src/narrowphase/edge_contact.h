#pragma once

#include <cstdint>

#include "ragtop/math.h"

namespace ragtop::surface {

/// A convex edge of a surface and the directions in which it is outermost: from the normal of one face beside it to
/// that of the other.
struct SharpEdge {
    Vec3 from, along;
    Vec3 normals[2];     ///< of both faces
    Vec3 outward[2];     ///< in each face, at right angles to the edge and away from the face
    bool round = false;  ///< the core of a capsule: all directions
    std::uint32_t name = 0;

    bool isOutermost(const Vec3& direction) const;
    /// A direction out of the surface.
    Vec3 middle() const;
};

/// Are two segments, each from a point along a vector, nearest to each other inside both? What is not cannot meet.
inline bool passEachOther(const Vec3& from, const Vec3& along, const Vec3& otherFrom, const Vec3& otherAlong) {
    const Vec3 r = from - otherFrom;
    const float aa = lengthSquared(along), bb = lengthSquared(otherAlong), ab = dot(along, otherAlong);
    const float ar = dot(along, r), br = dot(otherAlong, r), square = aa * bb - ab * ab;
    const float s = ab * br - ar * bb, t = aa * br - ab * ar, slack = 1e-3f * aa * bb;
    return s >= -slack && s <= square + slack && t >= -slack && t <= square + slack;
}

struct EdgeMeeting {
    bool found = false;
    Vec3 normal;  ///< from A to B
    Vec3 onA, onB;
    float separation = 0;
};

/// Where the insides of two edges are nearest to each other, or cross by at most `deepest` (m, positive), along a
/// direction in which both are outermost.
EdgeMeeting meet(const SharpEdge& a, const SharpEdge& b, float deepest);

}  // namespace ragtop::surface
