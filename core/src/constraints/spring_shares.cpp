#include <cmath>

#include "constraints/axis_rows.h"
#include "constraints/joint_constants.h"
#include "constraints/oscillator.h"
#include "ragtop/math.h"

namespace ragtop {
namespace {

using oscillator::fading;
using oscillator::shortSine;

struct Shares {
    double moving, resting;
};

/// z = (ωh)² up to 1 and x = 2ζωh.
Shares exactShares(double z, double x) {
    if (!(z > 1e-12)) return {x > 1e-6 ? fading(x) / x : 1 - 0.5 * x, 1 - fading(x)};
    const double a = 0.5 * x, under = z - a * a;
    if (under > 0) {
        const double lost = fading(a), left = 1 - lost;
        const double sine = shortSine(0.5 * std::sqrt(under));
        return {(lost * lost + 4 * left * sine * sine) / z, left * left};
    }
    // Two real rates; the slow one without cancellation. The fast one may be a brake.
    const double lost = fading(z / (a + std::sqrt(-under)));
    const double most = 1 - fading(x), resting = most > kLeastShare ? most : kLeastShare;
    return {lost * (1 - resting / (1 - lost)) / z, resting};
}

}  // namespace

SpringShares springShares(float stiffness, float damping, float inverseMass, float h) {
    const double w = inverseMass, step = h;
    const double z = step * step * static_cast<double>(stiffness) * w, x = step * static_cast<double>(damping) * w;
    if (z <= 1) {
        const Shares s = exactShares(z, x);
        return {static_cast<float>(s.moving), static_cast<float>(s.resting > kLeastShare ? s.resting : kLeastShare)};
    }
    const double clipped = x / std::sqrt(z);
    const Shares s = exactShares(1, clipped);
    const double excess = (z - 1) + (x - clipped);
    return {static_cast<float>(1 / (1 / s.moving + excess)),
            static_cast<float>(1 / (1 / (s.resting > kLeastShare ? s.resting : kLeastShare) + excess))};
}

}  // namespace ragtop
