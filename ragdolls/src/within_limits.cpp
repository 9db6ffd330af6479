#include "within_limits.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

float inRange(float angle, const Range& range, float margin) {
    const float middle = 0.5f * (range.lower + range.upper);
    return std::clamp(angle, std::min(range.lower + margin, middle), std::max(range.upper - margin, middle));
}

/// Share of a swing (y, z), rad, that a ball's swing limit leaves.
float shareOfSwing(const BallDef& ball, float y, float z, float margin) {
    const float size = std::sqrt(y * y + z * z);
    if (!(size > 0)) return 1;
    float most = size;
    if (ball.swingLimit) most = *ball.swingLimit - margin;
    if (const auto& cone = ball.swingEllipse) {
        const float a = y / (cone->y * size), b = z / (cone->z * size);
        most = 1 / std::sqrt(a * a + b * b) - margin;
    }
    if (const auto& pyramid = ball.swingPyramid) {
        for (const auto& [angle, range] : {std::pair{y, pyramid->y}, std::pair{z, pyramid->z}}) {
            if (angle > range.upper - margin)
                most = std::min(most, size * std::max(range.upper - margin, 0.0f) / angle);
            if (angle < range.lower + margin)
                most = std::min(most, size * std::min(range.lower + margin, 0.0f) / angle);
        }
    }
    return std::clamp(most / size, 0.0f, 1.0f);
}

}  // namespace

/// A swing after a twist, q = s t with t about x and s across it.
Quat withinLimits(const JointDef& def, const Quat& turn, float margin) {
    const float twist = 2 * arcTan2(turn.w < 0 ? -turn.x : turn.x, std::abs(turn.w));
    if (const auto* hinge = std::get_if<HingeDef>(&def)) {
        if (!hinge->limit) return turn;
        return rotationAbout({1, 0, 0}, inRange(twist, *hinge->limit, margin));
    }
    const auto* ball = std::get_if<BallDef>(&def);
    if (!ball) return turn;
    const Vec3 swing = rotationVector(turn * conjugate(rotationAbout({1, 0, 0}, twist)));
    const float share = shareOfSwing(*ball, swing.y, swing.z, margin);
    const float left = ball->twistLimit ? inRange(twist, *ball->twistLimit, margin) : twist;
    if (share >= 1 && left == twist) return turn;
    const Vec3 kept = share * swing;
    return normalized(rotationAbout(kept, length(kept)) * rotationAbout({1, 0, 0}, left));
}

}  // namespace ragtop
