#pragma once

#include "constraints/joint_geometry.h"
#include "constraints/rows.h"

/// A hinge: B turns about the x axis of both joint frames. With p the anchors, x the axes in the world and E two
/// directions across xB,
///   C₁ = pB − pA                          Ċ₁ = vB + ωB × rB − vA − ωA × rA        three linear rows
///   C₂ = Eᵀ 2 sin(θ/2) xA × xB/|xA × xB|   Ċ₂ ≈ Eᵀ (ωB − ωA)                       two angular rows
/// θ being the angle between the axes. All five are one block (rows.h). Free is ωrel · xB, the rate of the angle about
/// x, along which limits, spring, friction and motor act (axis_rows.h).
namespace ragtop {

/// Directions and errors of the frames a and b, whose anchors are `gap` apart.
template <class T>
RAGTOP_INLINE void alignHinge(RigidBlockOf<T>& block, const RotationOf<T>& a, const RotationOf<T>& b,
                              const VectorOf<T>& gap) {
    const VectorOf<T> yA = axisY(a), xB = axisX(b), across = yA - dot(yA, xB) * xB;
    const T size = length(across);
    VectorOf<T> y = (1 / size) * across;
    if (any(!(size > 0.0f))) y = select(size > 0.0f, y, perpendicular(xB));
    block.basis = {y, cross(xB, y), xB};
    block.errorFirst = gap;
    block.errorSecond = transposeTimes(block.basis, axisError(axisX(a), xB));
    block.impulseSecond = block.impulseSecond - dot(block.impulseSecond, xB) * xB;
}
/// The same with masses.
template <class T>
RAGTOP_INLINE void placeHinge(RigidBlockOf<T>& block, const RotationOf<T>& a, const RotationOf<T>& b,
                              const VectorOf<T>& gap, const PairMassOf<T>& mass) {
    alignHinge<T>(block, a, b, gap);
    refreshMass(block, mass, BlockMass::whole);
}
/// Speed per impulse along the free direction; 0 where it cannot move.
template <class T>
RAGTOP_INLINE T freeMass(const RigidBlockOf<T>& block) {
    return divideOrZero(T(1.0f), block.second.inverse[2]);
}

}  // namespace ragtop
