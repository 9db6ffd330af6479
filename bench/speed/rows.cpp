#include "rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace ragtop::speed {

using Json = nlohmann::ordered_json;

std::optional<Median> medianOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::ranges::sort(values);
    const std::size_t n = values.size();
    // Probability that the median of all lies within the k-th values from both ends: 1 − 2 Σ C(n, i)/2ⁿ over i < k.
    double outside = 0, term = std::ldexp(1.0, -static_cast<int>(n));
    Median median{0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back(), 1 - 2 * term};
    for (std::size_t k = 1; 2 * k <= n; ++k) {
        outside += term;
        term *= static_cast<double>(n - k + 1) / static_cast<double>(k);
        if (k > 1 && 1 - 2 * outside < 0.95) break;
        median.lower = values[k - 1];
        median.upper = values[n - k];
        median.confidence = 1 - 2 * outside;
    }
    return median;
}

std::optional<Median> Row::ratio() const {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(own.ms.size(), bullet.ms.size()); ++i)
        ratios.push_back(bullet.ms[i] / own.ms[i]);
    return medianOf(std::move(ratios));
}

namespace {

std::optional<double> middle(const std::vector<double>& values) {
    const auto median = medianOf(values);
    return median ? std::optional(median->value) : std::nullopt;
}

std::string cell(const std::optional<double>& value, int digits) {
    return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
}

/// "ours/Bullet's"
template <class Member>
std::string qualityCell(const Row& row, Member member) {
    const auto one = [&](const std::optional<Quality>& quality) {
        const std::optional<double> value = quality ? *quality.*member : std::nullopt;
        return value ? fmt::format("{:.2g}", *value) : std::string("-");
    };
    return one(row.own.quality) + "/" + one(row.bullet.quality);
}

}  // namespace

std::string tableHead() {
    return fmt::format("{:<20} {:>7} {:>5} {:>10} {:>10} {:>9} {:>9} {:>7} {:>15} {:>17} {:>17} {:>17} {:>17} {:>6}\n",
                       "scene", "threads", "lanes", "ms", "Bullet ms", "worst", "Bullet's", "ratio", "interval",
                       "p99 m", "max m", "below m", "gap m", "heap");
}

std::string tableLine(const Row& row) {
    const auto ratio = row.ratio();
    return fmt::format("{:<20} {:>7} {:>5} {:>10} {:>10} {:>9} {:>9} {:>7} {:>15} {:>17} {:>17} {:>17} {:>17} {:>6}\n",
                       row.scene, row.threads, row.lanes ? std::to_string(*row.lanes) : "-",
                       cell(middle(row.own.ms), 3), cell(middle(row.bullet.ms), 3), cell(middle(row.own.worstMs), 3),
                       cell(middle(row.bullet.worstMs), 3), cell(ratio ? std::optional(ratio->value) : std::nullopt, 2),
                       ratio ? fmt::format("{:.2f}–{:.2f}", ratio->lower, ratio->upper) : "-",
                       qualityCell(row, &Quality::overlapP99), qualityCell(row, &Quality::overlapMax),
                       qualityCell(row, &Quality::below), qualityCell(row, &Quality::gap),
                       row.own.work ? std::to_string(row.own.work->allocations) : "-");
}

namespace {

/// JSON has no word for what is no number.
Json number(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

void addQuality(Json& into, const std::string& prefix, const std::optional<Quality>& measured) {
    const Quality quality = measured.value_or(Quality{});
    into[prefix + "pen_p99_m"] = number(quality.overlapP99);
    into[prefix + "pen_max_m"] = number(quality.overlapMax);
    into[prefix + "below_mesh_m"] = number(quality.below);
    into[prefix + "joint_gap_max_m"] = number(quality.gap);
    into[prefix + "moved_max_m"] = number(quality.moved);
}

void addWork(Json& into, const std::optional<Work>& work) {
    for (const char* key : {"stages", "solver_mix", "residual", "bytes", "allocations"}) into[key] = nullptr;
    if (!work) return;
    for (const auto& [name, ms] : work->stages) into["stages"][name] = ms;
    for (const auto& [name, share] : work->solverMix) into["solver_mix"][name] = share;
    into["residual"] = number(work->residual);
    into["bytes"] = work->peakBytes;
    into["allocations"] = work->allocations;
}

Json object(const Row& row) {
    const auto ratio = row.ratio();
    const auto ofRatio = [&](double Median::*part) { return ratio ? number((*ratio).*part) : Json(nullptr); };
    Json json{{"scene", row.scene},
              {"threads", row.threads},
              {"lanes", row.lanes ? Json(*row.lanes) : Json(nullptr)},
              {"runs", std::max(row.own.ms.size(), row.bullet.ms.size())},
              {"ms", number(middle(row.own.ms))},
              {"bullet_ms", number(middle(row.bullet.ms))},
              {"worst_ms", number(middle(row.own.worstMs))},
              {"bullet_worst_ms", number(middle(row.bullet.worstMs))},
              {"ratio", ofRatio(&Median::value)},
              {"ratio_lower", ofRatio(&Median::lower)},
              {"ratio_upper", ofRatio(&Median::upper)},
              {"ratio_confidence", ofRatio(&Median::confidence)}};
    addQuality(json, "", row.own.quality);
    addQuality(json, "bullet_", row.bullet.quality);
    addWork(json, row.own.work);
    return json;
}

}  // namespace

std::string toJson(const std::vector<Row>& rows) {
    Json list = Json::array();
    for (const Row& row : rows) list.push_back(object(row));
    return list.dump(2) + "\n";
}

}  // namespace ragtop::speed
