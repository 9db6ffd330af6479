#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "masonry.h"

namespace ragtop::stability {
namespace {
namespace arches_cases {

constexpr double kSeconds = 60;
constexpr double kRadius = 10;  ///< m, of the middle line
constexpr double kDepth = 1;    ///< m

/// Stones between successive joints, each a line from the inside to the outside; the first and the last on the floor.
Masonry archOf(const std::vector<std::pair<DVec3, DVec3>>& joints, float friction) {
    Masonry arch(friction);
    for (std::size_t i = 0; i + 1 < joints.size(); ++i)
        arch.addSlab({joints[i].first, joints[i].second, joints[i + 1].second, joints[i + 1].first}, kDepth);
    const int last = static_cast<int>(arch.stones.size()) - 1;
    for (int i = 0; i <= last + 1; ++i) {
        const auto& [inner, outer] = joints[static_cast<std::size_t>(i)];
        const DVec3 along = outer - inner;
        const DVec3 tangent = (1 / std::hypot(along.x, along.y)) * along;
        // From the stone before, or the floor, to the one after; the arch runs anticlockwise.
        arch.limit.addJoint(
            {i - 1, i > last ? kGround : i, edgeJoint(inner, outer, kDepth), {-tangent.y, tangent.x, 0}, tangent});
    }
    return arch;
}

/// Semicircle of 15 equal voussoirs with a thickness in radii.
Masonry semicircle(double thickness) {
    constexpr int kStones = 15;
    std::vector<std::pair<DVec3, DVec3>> joints;
    for (int i = 0; i <= kStones; ++i) {
        const double angle = std::numbers::pi * i / kStones;
        const DVec3 outward{std::cos(angle), i == kStones ? 0 : std::sin(angle), 0};
        joints.emplace_back(kRadius * (1 - thickness / 2) * outward, kRadius * (1 + thickness / 2) * outward);
    }
    return archOf(joints, 0.6f);
}

bool standsByLimitAnalysis(double thickness) { return semicircle(thickness).limit.stands(0.6); }

double limitThickness() { return bisect(0.13, 0.08, 1e-3, standsByLimitAnalysis); }

Survival simulate(Trial& trial, double thickness) {
    const Masonry arch = semicircle(thickness);
    Run run = trial.start(arch.scene, fmt::format("{:.4f}", thickness));
    return survive(run, arch.stones, kSeconds, thickness * kRadius / 2);
}

void thick(Trial& trial) {
    constexpr double kThickness = 0.13;
    const Survival result = simulate(trial, kThickness);
    trial.expectAtLeast("stands", result.time, kSeconds, "s");
    trial.expectAtMost("largest move", result.moved, kThickness * kRadius / 10, "m");
}

void thin(Trial& trial) { trial.expectAtMost("stands no longer than", simulate(trial, 0.08).time, kSeconds / 2, "s"); }

void critical(Trial& trial) {
    const double exact = limitThickness();
    const double measured = bisect(0.13, 0.08, 5e-3, [&](double t) { return simulate(trial, t).time >= kSeconds; });
    trial.expectNear("critical t/R", measured, exact, 0.02 * exact, "1");
}

/// A pointed arch of 17 stones along a hanging chain turned upside down, 10 m wide and high, its stones from 2 m thick
/// at the foot to 1.3 m at the top; four slabs lie on the keystone. [After Catto's arch in the samples of Box2D]
void pointed(Trial& trial) {
    constexpr int kStones = 17;
    constexpr double kHalfSpan = 5, kScale = 1.66, kFoot = 2, kTop = 1.3;
    std::vector<std::pair<DVec3, DVec3>> joints;
    const double height = kScale * std::cosh(kHalfSpan / kScale);
    const double halfLength = kScale * std::sinh(kHalfSpan / kScale);
    for (int i = 0; i <= kStones; ++i) {
        // Arc length from the top, the catenary's natural parameter.
        const double s = halfLength * (1 - 2.0 * i / kStones);
        const double x = kScale * std::asinh(s / kScale), y = height - std::hypot(kScale, s);
        const double half = (kTop + (kFoot - kTop) * std::abs(s) / halfLength) / 2;
        const bool foot = i == 0 || i == kStones;
        const DVec3 up = foot ? DVec3{s > 0 ? 1.0 : -1.0, 0, 0} : DVec3{s, kScale, 0};
        const DVec3 outward = (half / std::hypot(up.x, up.y)) * up;
        joints.emplace_back(DVec3{x, y, 0} - outward, DVec3{x, y, 0} + outward);
    }
    Masonry arch = archOf(joints, 0.6f);
    const double top = joints[kStones / 2].second.y;
    for (int i = 0; i < 4; ++i) {
        const double y = top + 0.5 * i;
        arch.addSlab({{-1, y, 0}, {1, y, 0}, {1, y + 0.5, 0}, {-1, y + 0.5, 0}}, kDepth);
    }
    Run run = trial.start(arch.scene);
    const Survival result = survive(run, arch.stones, kSeconds, 0.5);
    trial.expectAtLeast("stands", result.time, kSeconds, "s");
    trial.expectAtMost("largest move", result.moved, kTop / 10, "m");
}

}  // namespace arches_cases
}  // namespace

void addArchCases(Family& family) {
    using namespace arches_cases;
    family.cases.push_back(
        {"limit analysis of the arch",
         [](Trial& trial) { trial.expectNear("critical t/R", limitThickness(), 0.106, 0.0005, "1"); },
         Kind::ragtopOnly});
    family.cases.push_back({"arch, t/R=0.13", thick});
    family.cases.push_back({"arch, t/R=0.08", thin});
    family.cases.push_back({"arch", critical, Kind::oneStep});
    family.cases.push_back({"pointed arch of 17 stones", pointed});
}

}  // namespace ragtop::stability
