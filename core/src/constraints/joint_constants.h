#pragma once

/// Numbers of the joints' method that its scalar and its wide form share.
namespace ragtop {

/// Elimination in single precision leaves a few ulps (6e-8) of the diagonal where the exact pivot is zero.
inline constexpr float kZeroPivot = 1e-6f;
/// Errors of a free tree's joint that its velocities bring back: up to so many times h² (|rA| ωA² + |rB| ωB²), twice
/// what arms leave their tangents by in a substep. Moving the bodies by what their turning leaves open would cost
/// angular momentum: with 4 a tumbling ragdoll loses 1e-3 of it in ten seconds, with 16 as much as if nothing were
/// moved.
inline constexpr float kBending = 16;
/// Rebounds of less than so many times the speed gained in a substep are rest.
inline constexpr float kRestingRebound = 4;
/// Within this of its bound, an impulse has reached it.
inline constexpr float kAtBound = 0.9999f;
/// rad
inline constexpr double kTurn = 6.283185307179586;
/// The least share that a spring or damper leaves of a speed: beyond it a damper is a brake, and any will do.
inline constexpr double kLeastShare = 1e-3;
/// Sines below this have no direction in single precision.
inline constexpr float kNoDirection = 1e-6f;
/// Below this cosine of half the swing, within 0.1° of a half turn, the twist has no axis.
inline constexpr float kNoTwist = 1e-3f;
/// 1 + cos of the angle between two axes below which they are opposite.
inline constexpr float kOpposite = 1e-6f;

}  // namespace ragtop
