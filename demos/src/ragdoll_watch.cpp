#include "ragdoll_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

#include "convex_depth.h"

namespace ragtop::demos {
namespace {

constexpr double kGap = 0.002;      ///< m
constexpr double kPassed = 2;       ///< degrees
constexpr double kRestTime = 0.25;  ///< s
constexpr double kOverlap = 0.01;   ///< m

double degrees(double angle) { return angle * 180 / M_PI; }

/// Is the margin of its limits an angle?
bool turns(const JointDef& def) {
    return std::holds_alternative<BallDef>(def) || std::holds_alternative<HingeDef>(def) ||
           std::holds_alternative<UniversalDef>(def);
}

}  // namespace

void WholenessWatch::observe(const RagdollStage& stage, const std::string& run) {
    for (std::size_t i = 0; i < stage.joints.size(); ++i) {
        const JointState state = stage.world.state(stage.joints[i]);
        const double gap = static_cast<double>(state.gap);
        const double passed =
            turns(stage.world.def(stage.joints[i])) ? degrees(-static_cast<double>(state.limitMargin)) : 0;
        const bool worse = !(gap <= gap_.value()) || !(passed <= passed_.value());
        if (!worse) continue;
        const std::string where = fmt::format("{}, {} at {:.2f} s", run, stage.jointNames[i], stage.world.time());
        gap_.add(gap, where);
        passed_.add(std::max(passed, 0.0), where);
    }
}

void WholenessWatch::tell(std::string_view test, std::vector<RagdollFigure>& figures) const {
    figures.push_back({std::string(test), "joint_gap_max_m", gap_.value(), kGap, false, gap_.where()});
    figures.push_back({std::string(test), "limit_passed_max_deg", passed_.value(), kPassed, false, passed_.where()});
}

OverlapWatch::OverlapWatch(const RagdollSubject& subject) {
    const auto* def = std::get_if<RagdollDef>(&subject.def);
    if (!def) return;
    std::vector<ConvexSolid> solids;
    for (const RagdollPart& part : def->parts) {
        const Frame at = part.bind * part.frame;
        solids.push_back(solidOf(part.shape, {DVec3(at.position), at.rotation}));
        const Box3 box = boundsOf(solidOf(part.shape, {}));
        radii_.push_back(0);
        for (const double x : {box.lower.x, box.upper.x})
            for (const double y : {box.lower.y, box.upper.y})
                for (const double z : {box.lower.z, box.upper.z})
                    radii_.back() = std::max(radii_.back(), std::sqrt(x * x + y * y + z * z));
    }
    const auto isJoined = [&](int a, int b) {
        return std::any_of(def->joints.begin(), def->joints.end(), [&](const RagdollJoint& joint) {
            return (joint.parent == a && joint.child == b) || (joint.parent == b && joint.child == a);
        });
    };
    for (int i = 0; i < static_cast<int>(solids.size()); ++i)
        for (int j = i + 1; j < static_cast<int>(solids.size()); ++j)
            if (!isJoined(i, j) &&
                !(overlapDepth(solids[static_cast<std::size_t>(i)], solids[static_cast<std::size_t>(j)]) > 0))
                apart_.push_back({i, j});
}

void OverlapWatch::observe(const RagdollStage& stage, const std::string& run) {
    for (const RagdollPair& pair : apart_) {
        const auto first = static_cast<std::size_t>(pair.first), second = static_cast<std::size_t>(pair.second);
        const RagdollPart &a = stage.ragdoll->def().parts[first], &b = stage.ragdoll->def().parts[second];
        const Pose atA = stage.world.pose(stage.bodies[first]) * a.frame,
                   atB = stage.world.pose(stage.bodies[second]) * b.frame;
        if (static_cast<double>(length(relative(atA.position, atB.position))) > radii_[first] + radii_[second])
            continue;
        const double depth = overlapDepth(solidOf(a.shape, atA), solidOf(b.shape, atB));
        if (depth > depth_.value())
            depth_.add(depth, fmt::format("{}, {} in {} at {:.2f} s", run, a.name, b.name, stage.world.time()));
    }
}

void OverlapWatch::tell(std::string_view test, std::vector<RagdollFigure>& figures) const {
    if (apart_.empty()) return;
    figures.push_back({std::string(test), "self_overlap_max_m", depth_.value(), kOverlap, false, depth_.where()});
}

RestWatch::RestWatch(double hz) : most_(static_cast<std::size_t>(std::max(1.0, std::round(kRestTime * hz)))) {}

void RestWatch::observe(const RagdollStage& stage) {
    squares_.push_back(stage.meanSquareSpeed());
    if (squares_.size() > most_) squares_.pop_front();
}

double RestWatch::speed() const {
    if (squares_.empty()) return 0;
    return std::sqrt(std::accumulate(squares_.begin(), squares_.end(), 0.0) / static_cast<double>(squares_.size()));
}

}  // namespace ragtop::demos
