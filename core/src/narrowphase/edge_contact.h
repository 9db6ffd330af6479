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
