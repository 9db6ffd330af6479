#include "rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace ragtop::speed {

using Json = nlohmann::ordered_json;

std::optional<double> Row::ratio() const {
    if (!ms || !bulletMs) return {};
    return *bulletMs / *ms;
}

std::string tableHead() {
    return fmt::format("{:<20} {:>7} {:>5} {:>10} {:>10} {:>7} {:>9} {:>9} {:>9} {:>9} {:>7} {:>6}\n", "scene",
                       "threads", "lanes", "ms", "Bullet ms", "ratio", "p99 m", "max m", "gap m", "moved m", "swept",
                       "heap");
}

std::string tableLine(const Row& row) {
    const auto number = [](const std::optional<double>& value, int digits) {
        return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
    };
    const auto swept = row.work.solverMix.find("swept");
    return fmt::format(
        "{:<20} {:>7} {:>5} {:>10} {:>10} {:>7} {:>9.2g} {:>9.2g} {:>9.2g} {:>9.2g} {:>7} {:>6}\n", row.scene,
        row.threads, row.lanes, number(row.ms, 3), number(row.bulletMs, 3), number(row.ratio(), 2),
        row.quality.overlapP99, row.quality.overlapMax, row.quality.gapMax, row.quality.movedMax,
        swept == row.work.solverMix.end() ? "-" : fmt::format("{:.2f}", swept->second), row.work.allocations);
}

namespace {

Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json object(const Row& row) {
    Json stages = Json::object(), mix = Json::object();
    for (const auto& [name, ms] : row.work.stages) stages[name] = ms;
    for (const auto& [name, share] : row.work.solverMix) mix[name] = share;
    return {{"scene", row.scene},
            {"threads", row.threads},
            {"lanes", row.lanes},
            {"ms", optional(row.ms)},
            {"bullet_ms", optional(row.bulletMs)},
            {"ratio", optional(row.ratio())},
            {"stages", stages},
            {"pen_p99_m", row.quality.overlapP99},
            {"pen_max_m", row.quality.overlapMax},
            {"joint_gap_max_m", row.quality.gapMax},
            {"moved_max_m", row.quality.movedMax},
            {"solver_mix", mix},
            {"residual", optional(row.work.residual)},
            {"bytes", row.work.peakBytes},
            {"allocations", row.work.allocations}};
}

struct KeptResult {
    std::string name;
    std::map<std::pair<std::string, int>, std::string> ratios;  ///< by scene and threads
};

KeptResult readKept(const std::filesystem::path& path) {
    KeptResult kept;
    kept.name = path.stem().string();
    try {
        std::ifstream file(path);
        for (const Json& row : Json::parse(file)) {
            const Json& ratio = row.at("ratio");
            kept.ratios[{row.at("scene"), row.at("threads")}] =
                ratio.is_null() ? "–" : fmt::format("{:.2f}", ratio.get<double>());
        }
    } catch (const Json::exception& error) {
        throw std::runtime_error(path.string() + " is no list of rows: " + error.what());
    }
    return kept;
}

}  // namespace

std::string toJson(const std::vector<Row>& rows) {
    Json list = Json::array();
    for (const Row& row : rows) list.push_back(object(row));
    return list.dump(2) + "\n";
}

std::string historyTable(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<KeptResult> results;
    for (const auto& file : files) results.push_back(readKept(file));

    std::string head = "| scene | threads |", line = "|---|---|", body;
    for (const KeptResult& result : results) {
        head += " " + result.name + " |";
        line += "---|";
    }
    for (const CourseKind& kind : courseKinds())
        for (const std::string& scene : kind.rows)
            for (const int threads : {1, 2}) {
                std::string cells;
                bool any = false;
                for (const KeptResult& result : results) {
                    const auto found = result.ratios.find({scene, threads});
                    any = any || found != result.ratios.end();
                    cells += fmt::format(" {} |", found == result.ratios.end() ? "" : found->second);
                }
                if (any) body += fmt::format("| {} | {} |{}\n", scene, threads, cells);
            }
    return head + "\n" + line + "\n" + body;
}

}  // namespace ragtop::speed
