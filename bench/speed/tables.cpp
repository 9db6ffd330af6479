#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "rows.h"

namespace ragtop::speed {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::filesystem::path> keptFiles(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

template <class Visit>
void forRows(const std::filesystem::path& path, Visit&& visit) {
    try {
        std::ifstream file(path);
        for (const Json& row : Json::parse(file)) visit(row);
    } catch (const Json::exception& error) {
        throw std::runtime_error(path.string() + " is no list of rows: " + error.what());
    }
}

/// A number of a row; a dash where it was not measured, as in files of before it was.
std::string cell(const Json& row, const std::string& key, int digits) {
    const auto found = row.find(key);
    if (found == row.end() || found->is_null()) return "–";
    if (found->is_string()) return found->get<std::string>();
    return fmt::format("{:.{}f}", found->get<double>(), digits);
}

/// A length in mm of both engines.
std::string lengthCell(const Json& row, const std::string& key) {
    const auto one = [&](const std::string& name) {
        const auto found = row.find(name);
        if (found == row.end() || !found->is_number()) return cell(row, name, 0);
        return fmt::format("{:.3g}", 1e3 * found->get<double>());
    };
    return one(key) + " / " + one("bullet_" + key);
}

struct KeptResult {
    std::string name;
    std::map<std::pair<std::string, int>, std::string> ratios;  ///< by scene and threads
};

KeptResult readKept(const std::filesystem::path& path) {
    KeptResult kept;
    kept.name = path.stem().string();
    forRows(path, [&](const Json& row) { kept.ratios[{row.at("scene"), row.at("threads")}] = cell(row, "ratio", 2); });
    return kept;
}

}  // namespace

std::string historyTable(const std::filesystem::path& folder) {
    std::vector<KeptResult> results;
    for (const auto& file : keptFiles(folder)) results.push_back(readKept(file));

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

std::string newestTable(const std::filesystem::path& folder) {
    const std::vector<std::filesystem::path> files = keptFiles(folder);
    if (files.empty()) throw std::runtime_error(folder.string() + " has no kept results");
    std::string table = fmt::format(
        "`{}`\n\n| scene | threads | ms | Bullet | worst | Bullet's | ratio | interval | p99 | max | below | gap | "
        "moved |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        files.back().stem().string());
    forRows(files.back(), [&](const Json& row) {
        table += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} to {} | {} | {} | {} | {} | {} |\n",
                             row.at("scene").get<std::string>(), row.at("threads").get<int>(), cell(row, "ms", 3),
                             cell(row, "bullet_ms", 3), cell(row, "worst_ms", 3), cell(row, "bullet_worst_ms", 3),
                             cell(row, "ratio", 2), cell(row, "ratio_lower", 2), cell(row, "ratio_upper", 2),
                             lengthCell(row, "pen_p99_m"), lengthCell(row, "pen_max_m"),
                             lengthCell(row, "below_mesh_m"), lengthCell(row, "joint_gap_max_m"),
                             lengthCell(row, "moved_max_m"));
    });
    return table;
}

}  // namespace ragtop::speed
