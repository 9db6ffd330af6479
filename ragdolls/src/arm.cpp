#include "arm.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr float kLeastAbduction = -0.2f, kMostAbduction = 1.4f;  ///< rad

}  // namespace

/// (± sin a, −cos a cos f, cos a sin f) for abduction a and flexion f.
PartAngles pointing(BodySide side, const Vec3& along) {
    const float out = side == BodySide::left ? along.x : -along.x;
    const float across = std::sqrt(along.y * along.y + along.z * along.z);
    PartAngles arm{.role = BodyRole::upperArm, .side = side};
    arm.abduction = std::clamp(arcTan2(out, across), kLeastAbduction, kMostAbduction);
    arm.flexion = arcTan2(along.z, -along.y);
    return arm;
}

}  // namespace ragtop
