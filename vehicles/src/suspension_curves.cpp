#include "suspension_curves.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr int kTerms = WheelCurve::kTerms;
constexpr int kNodes = kTerms - 1;  ///< less one: the series is exact at the extrema of its last polynomial

using Values = std::array<double, WheelCurve::kParts>;
using Column = std::array<Values, kTerms>;

/// cos(k π/8)
double nodeCosine(int k) {
    const double half = std::sqrt(0.5), wide = std::sqrt(0.5 + 0.5 * half), narrow = std::sqrt(0.5 - 0.5 * half);
    const double quarter[] = {1, wide, half, narrow, 0};
    k %= 2 * kNodes;
    if (k > kNodes) k = 2 * kNodes - k;
    return k > kNodes / 2 ? -quarter[kNodes - k] : quarter[k];
}
static_assert(kNodes == 8);

/// From values at the nodes, the first of which is the upper end [Trefethen, Approximation Theory and Approximation
/// Practice, 2013, ch. 3].
Column seriesOf(const Column& values) {
    Column terms{};
    for (int j = 0; j <= kNodes; ++j) {
        for (int k = 0; k <= kNodes; ++k) {
            const double ends = (k == 0 || k == kNodes ? 0.5 : 1) * (j == 0 || j == kNodes ? 0.5 : 1);
            const double weight = 2.0 / kNodes * ends * nodeCosine(j * k);
            for (std::size_t p = 0; p < values[0].size(); ++p)
                terms[static_cast<std::size_t>(j)][p] += weight * values[static_cast<std::size_t>(k)][p];
        }
    }
    return terms;
}

double nodeAt(const CurveRange& range, int k) {
    return 0.5 * (range.upper + range.lower) + 0.5 * (range.upper - range.lower) * nodeCosine(k);
}

/// Polynomials and their slopes at s in [−1, 1].
struct Chebyshev {
    std::array<float, kTerms> values{1}, slopes{};
    explicit Chebyshev(float s) {
        values[1] = s;
        slopes[1] = 1;
        for (std::size_t j = 2; j < values.size(); ++j) {
            values[j] = 2 * s * values[j - 1] - values[j - 2];
            slopes[j] = 2 * values[j - 1] + 2 * s * slopes[j - 1] - slopes[j - 2];
        }
    }
};

Values valuesOf(const LinkageSolver& solver, bool right, double own, double other) {
    const bool mirrored = right && !solver.isSolid();
    LinkageCoordinates at{own, own, 0};
    if (solver.isSolid())
        (right ? at.left : at.right) = other;
    else
        at.rack = mirrored ? -other : other;
    const std::optional<CarrierPlace> place = solver.reach(LinkageDrive::spring, at);
    if (!place) return {};
    const CarrierRate rate = solver.rates(LinkageDrive::spring, *place, at)[solver.isSolid() && right ? 1 : 0];
    const bool isRight = right && solver.isSolid();
    const DVec3 gone = solver.hub(*place, isRight) - solver.hub(solver.atRest(), isRight);
    const DVec3 axle = solver.axle(*place, isRight);
    const double side = mirrored ? -1 : 1;
    // A mirrored wheel has its axle to the left too.
    return {side * gone.x, gone.y, gone.z, axle.x, side * axle.y, side * axle.z, dot(rate.spin, axle)};
}

WheelGuide guideOf(const std::array<float, WheelCurve::kParts>& value,
                   const std::array<float, WheelCurve::kParts>& slope) {
    WheelGuide guide;
    guide.hub = {value[0], value[1], value[2]};
    guide.hubRate = {slope[0], slope[1], slope[2]};
    guide.axle = {value[3], value[4], value[5]};
    guide.axleRate = {slope[3], slope[4], slope[5]};
    guide.spinRate = value[6];
    return guide;
}

}  // namespace

WheelGuide WheelCurve::at(float u) const {
    const float s = (u - middle) / half, inside = std::clamp(s, -1.0f, 1.0f);
    const Chebyshev by(inside);
    std::array<float, kParts> value{}, slope{};
    for (std::size_t p = 0; p < terms.size(); ++p) {
        for (std::size_t j = 0; j < by.values.size(); ++j) {
            value[p] += terms[p][j] * by.values[j];
            slope[p] += terms[p][j] * by.slopes[j];
        }
        slope[p] /= half;
    }
    WheelGuide guide = guideOf(value, slope);
    const float beyond = half * (s - inside);
    guide.hub += beyond * guide.hubRate;
    guide.axle = normalized(guide.axle + beyond * guide.axleRate);
    return guide;
}

Vec3 WheelCurve::values(float u, std::size_t first) const {
    const Chebyshev by(std::clamp((u - middle) / half, -1.0f, 1.0f));
    Vec3 sum;
    for (int k = 0; k < 3; ++k)
        for (std::size_t j = 0; j < by.values.size(); ++j)
            sum[k] += terms[first + static_cast<std::size_t>(k)][j] * by.values[j];
    return sum;
}

SuspensionCurves::SuspensionCurves(const LinkageSolver& solver, bool right, const CurveRange& own,
                                   const CurveRange& other)
    : middle_(static_cast<float>(0.5 * (own.upper + own.lower))),
      half_(static_cast<float>(0.5 * (own.upper - own.lower))),
      otherMiddle_(static_cast<float>(0.5 * (other.upper + other.lower))),
      otherHalf_(static_cast<float>(0.5 * (other.upper - other.lower))) {
    std::array<Column, kTerms> byOther{};
    for (int k = 0; k <= kNodes; ++k) {
        Column values{};
        for (int j = 0; j <= kNodes; ++j)
            values[static_cast<std::size_t>(j)] = valuesOf(solver, right, nodeAt(own, j), nodeAt(other, k));
        byOther[static_cast<std::size_t>(k)] = seriesOf(values);
        if (!(otherHalf_ > 0)) break;
    }
    for (std::size_t j = 0; j < byOther.size(); ++j) {
        Column across{};
        for (std::size_t k = 0; k < byOther.size(); ++k) across[k] = byOther[k][j];
        if (otherHalf_ > 0) across = seriesOf(across);
        for (std::size_t p = 0; p < terms_.size(); ++p)
            for (std::size_t k = 0; k < across.size(); ++k) terms_[p][k][j] = static_cast<float>(across[k][p]);
    }
}

template <class Weights>
WheelCurve SuspensionCurves::folded(const Weights& weights) const {
    WheelCurve curve;
    curve.middle = middle_;
    curve.half = half_;
    for (std::size_t p = 0; p < terms_.size(); ++p)
        for (std::size_t k = 0; k < weights.size(); ++k)
            for (std::size_t j = 0; j < weights.size(); ++j) curve.terms[p][j] += weights[k] * terms_[p][k][j];
    return curve;
}

WheelCurve SuspensionCurves::with(float other) const {
    if (!(otherHalf_ > 0)) return folded(std::array<float, kTerms>{1});
    return folded(Chebyshev(std::clamp((other - otherMiddle_) / otherHalf_, -1.0f, 1.0f)).values);
}

WheelCurve SuspensionCurves::changeWith(float other) const {
    if (!(otherHalf_ > 0)) return folded(std::array<float, kTerms>{});
    auto slopes = Chebyshev(std::clamp((other - otherMiddle_) / otherHalf_, -1.0f, 1.0f)).slopes;
    for (float& slope : slopes) slope /= otherHalf_;
    return folded(slopes);
}

}  // namespace ragtop
