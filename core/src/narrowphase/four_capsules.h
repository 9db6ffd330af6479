#pragma once

#include "base/four_floats.h"
#include "narrowphase/manifold.h"

namespace ragtop {

/// Four pairs of capsules, B in the frame of A. What is no capsule has zeros, and touches nowhere in particular.
struct FourCapsules {
    FourVectors position;
    FourQuats rotation;
    FourFloats halfHeightA, halfHeightB, radiusA, radiusB;
};

/// The one point in which two capsules are nearest.
struct CapsuleTouch {
    Vec3 normal, point;   ///< as of a Manifold
    float separation = 0;
    bool single = false;  ///< false: the pair is too nearly parallel, or its cores meet, and collide() has to look at it
};

/// Each gives the bits of collide().
void touchFour(const FourCapsules& pairs, CapsuleTouch (&out)[4]);

/// The manifold of a touch that is single; returns its points.
int takeTouch(const CapsuleTouch& touch, float margin, Manifold& out);

}  // namespace ragtop
