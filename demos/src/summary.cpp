#include "summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "json_text.h"

namespace ragtop::demos {

std::string toJson(const Summary& s) {
    std::string times, warnings;
    for (const auto& [name, ms] : s.msPerStep) {
        times += fmt::format("{}\n    {}: {}", times.empty() ? "" : ",", jsonString(name), jsonNumber(ms));
    }
    for (const std::string& warning : s.warnings)
        warnings += (warnings.empty() ? "\n    " : ",\n    ") + jsonString(warning);
    std::string out = "{\n";
    out += fmt::format("  \"hash\": \"{:016x}\",\n  \"steps\": {},\n  \"finite\": {},\n", s.hash, s.steps, s.finite);
    out += fmt::format("  \"real_time_factor\": {},\n  \"real_time_factor_min\": {},\n", jsonNumber(s.realTimeFactor),
                       jsonNumber(s.realTimeFactorMin));
    out += fmt::format("  \"ms_per_step\": {{{}\n  }},\n  \"contacts\": {},\n", times, s.contacts);
    out += fmt::format("  \"penetration_max_m\": {},\n  \"penetration_p99_m\": {},\n  \"joint_gap_max_m\": {},\n",
                       jsonNumber(s.penetrationMax), jsonNumber(s.penetrationP99), jsonNumber(s.jointGapMax));
    out += fmt::format("  \"moved_max_m\": {},\n  \"max_speed_m_s\": {},\n  \"energy_j\": {},\n",
                       jsonNumber(s.movedMax), jsonNumber(s.maxSpeed), jsonNumber(s.energy));
    out += fmt::format("  \"warnings\": [{}]\n}}\n", warnings.empty() ? "" : warnings + "\n  ");
    return out;
}

double StepTimes::meanMs() const {
    return ms_.empty() ? 0 : std::accumulate(ms_.begin(), ms_.end(), 0.0) / static_cast<double>(ms_.size());
}

double StepTimes::realTimeFactor() const { return meanMs() > 0 ? 1000 * step_ / meanMs() : 0; }

double StepTimes::worstSecond() const {
    const std::size_t window = std::min(ms_.size(), static_cast<std::size_t>(std::max(1.0, std::round(1 / step_))));
    if (window == 0) return 0;
    double sum = std::accumulate(ms_.begin(), ms_.begin() + static_cast<std::ptrdiff_t>(window), 0.0);
    double worst = sum;
    for (std::size_t i = window; i < ms_.size(); ++i) {
        sum += ms_[i] - ms_[i - window];
        worst = std::max(worst, sum);
    }
    return worst > 0 ? 1000 * step_ * static_cast<double>(window) / worst : 0;
}

}  // namespace ragtop::demos
