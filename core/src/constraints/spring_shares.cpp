#include <cmath>

#include "constraints/axis_rows.h"
#include "constraints/joint_constants.h"
#include "constraints/oscillator.h"
#include "constraints/spring_drags.h"
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

/// w times the drag that a spring of a radian per substep, ωh = 1, has in the pass that moves: 1/(4 sin² ½) − 1.
static constexpr double kRadianDrag = 0.08767132483501072;

SpringDrags springDrags(float stiffness, float damping, float inverseMass, float h) {
    const double w = inverseMass, step = h;
    const double z = step * step * static_cast<double>(stiffness) * w, x = step * static_cast<double>(damping) * w;
    if (!(w > 0)) return {};
    double moving = x > 1e-6 ? x / fading(x) - 1 : 0.5 * x, given = x, resting = 0;
    if (z > 1) {
        resting = z - 1;
        moving += kRadianDrag + resting;
    } else if (z > 1e-12) {
        const Shares s = exactShares(z, x);
        moving = 1 / s.moving - 1;
        given = (1 - s.resting) / s.moving;
    }
    return {moving / w, resting / w, given > 0 && moving > 0 ? given / moving : 0};
}

SpringDrags separateDrags(float stiffness, float damping, float inverseMass, float h) {
    const SpringShares shares = springShares(stiffness, damping, inverseMass, h);
    return {dragOf(shares.moving, inverseMass), dragOf(shares.resting, inverseMass), 0};
}

}  // namespace ragtop
