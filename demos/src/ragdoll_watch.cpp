#include "ragdoll_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

namespace ragtop::demos {
namespace {

constexpr double kGap = 0.002;      ///< m
constexpr double kPassed = 2;       ///< degrees
constexpr double kRestTime = 0.25;  ///< s

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
