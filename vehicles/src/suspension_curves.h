#pragma once

#include <array>

#include "linkage_solver.h"
#include "ragtop/math.h"

namespace ragtop {

/// A range of a coordinate, m.
struct CurveRange {
    double lower = 0, upper = 0;
};

/// Where a suspension holds its wheel, and how that changes with its own coordinate u, per m.
struct WheelGuide {
    Vec3 hub, hubRate;    ///< m from where it stands, in the chassis
    Vec3 axle, axleRate;  ///< unit, to the left
    float spinRate = 0;   ///< rad/m by which the carrier turns forward about the axle
};

/// Of one coordinate, as a Chebyshev series.
struct WheelCurve {
    static constexpr int kParts = 7;  ///< hub, axle, spinRate
    static constexpr int kTerms = 9;  ///< which leaves less than 1e-5 m and rad of suspensions within their travel
    std::array<std::array<float, kTerms>, kParts> terms{};
    float middle = 0, half = 1;
    /// Beyond the range as at its end, hub and axle going on straight.
    WheelGuide at(float u) const;
    /// Three of its parts, from the first of them on, within the range.
    Vec3 values(float u, std::size_t first) const;
};

/// Of two: the own coordinate, and what else moves the wheel: the rack of one that steers, the other wheel's coordinate
/// of a solid axle.
class SuspensionCurves {
public:
    /// Of the left wheel or the right one. The range of `other` is that of the rack for the left wheel. Every place in
    /// the ranges must be within reach.
    SuspensionCurves(const LinkageSolver& solver, bool right, const CurveRange& own, const CurveRange& other);
    WheelCurve with(float other) const;
    /// How the curve changes with the other coordinate, per m; constant beyond its range.
    WheelCurve changeWith(float other) const;

private:
    static constexpr int kTerms = WheelCurve::kTerms;
    template <class Weights>
    WheelCurve folded(const Weights& weights) const;
    std::array<std::array<std::array<float, kTerms>, kTerms>, WheelCurve::kParts> terms_{};  ///< part, other, own
    float middle_ = 0, half_ = 1, otherMiddle_ = 0, otherHalf_ = 0;  ///< half 0: there is no other
};

}  // namespace ragtop
