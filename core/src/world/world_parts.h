#pragma once

#include "narrowphase/four_capsules.h"
#include "ragtop/math.h"

/// What the world's stages share beside its state.
namespace ragtop {

/// Lengths relative to the size of what touches, and other numbers of the method.
namespace tuning {
inline constexpr float kSpeculative = 0.02f;      ///< contact margin at rest, in sizes of the smaller shape
inline constexpr float kReuse = 0.05f;            ///< motion of a pair within which its manifolds are kept, in sizes
inline constexpr float kFatMargin = 0.1f;         ///< enlargement of bounds, in sizes
inline constexpr float kContinuousMotion = 0.5f;  ///< motion per step beyond which a body is swept, in sizes
inline constexpr float kSlideSpeed = 0.05f;       ///< slowest slide or roll reported, in √(gravity · size)
}  // namespace tuning

/// Where a pair is that is asked for its contacts.
struct PairPlace {
    Frame bInA;           ///< of shape B in the axes of shape A
    float margin = 0;     ///< m, up to which points are found: all that the step may bring into touch
    float moved = 0;      ///< m, against each other, since manifolds were found
    float perTravel = 1;  ///< of such motion, at most, for what both bodies travel
    CapsuleTouch touch{};  ///< single where both are capsules that touch in a point, if anywhere
};

}  // namespace ragtop
