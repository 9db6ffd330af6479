#include "bicycle.h"

#include "ragtop/math.h"
#include "slip_law.h"

namespace ragtop {

/// With t half of the trace of A, D = A − t and q² = −det D,
///
///     e^(A h) = e^(t h) (cosh(q h) + sinh(q h)/q D)
LateralMotion<float> lateralAfter(const LateralLaw<float>& law, const LateralMotion<float>& from, float h) {
    const float determinant = law.sideBySide * law.yawByYaw - law.sideByYaw * law.yawBySide;
    if (determinant == 0) {
        const LateralMotion<float> rate = law.rate(from);
        return {from.side + h * rate.side, from.yaw + h * rate.yaw};
    }
    const LateralMotion<float> stays{(law.sideByYaw * law.yaw - law.yawByYaw * law.side) / determinant,
                                     (law.yawBySide * law.side - law.sideBySide * law.yaw) / determinant};
    const float trace = 0.5f * (law.sideBySide + law.yawByYaw), apart = 0.5f * (law.sideBySide - law.yawByYaw);
    const float squared = apart * apart + law.sideByYaw * law.yawBySide;
    const float q = std::sqrt(std::abs(squared));
    constexpr float kAlike = 1e-3f;  // rad, below which sinh(q h)/q is h in single precision
    float even = 0, odd = 0;
    if (q * h < kAlike) {
        even = exponential(trace * h);
        odd = h * even;
    } else if (squared > 0) {
        const float slow = exponential((trace + q) * h), fast = exponential((trace - q) * h);
        even = 0.5f * (slow + fast);
        odd = 0.5f * (slow - fast) / q;
    } else {
        const SinCos turned = sinCos(q * h);
        const float size = exponential(trace * h);
        even = size * turned.cos;
        odd = size * turned.sin / q;
    }
    const float side = from.side - stays.side, yaw = from.yaw - stays.yaw;
    return {stays.side + even * side + odd * (apart * side + law.sideByYaw * yaw),
            stays.yaw + even * yaw + odd * (law.yawBySide * side - apart * yaw)};
}

}  // namespace ragtop
