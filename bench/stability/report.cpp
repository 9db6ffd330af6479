#include "report.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace ragtop::stability {

std::string tableHead() {
    return fmt::format("{:<14} {:<46} {:<12} {:>11} {:>11} {:>10} {:<8} {:<6} {:>9}\n", "family", "case", "engine",
                       "value", "reference", "bound", "unit", "", "ms/s");
}

std::string tableLine(const Row& row) {
    return fmt::format("{:<14} {:<46} {:<12} {:>11.5g} {:>11.5g} {:>10.3g} {:<8} {:<6} {:>9.3f}{}{}\n", row.family,
                       row.name, row.engine, row.value, row.reference, row.bound, row.unit, row.pass ? "ok" : "FAILS",
                       row.ms, row.note.empty() ? "" : "  ", row.note);
}

std::string toJson(const std::vector<Row>& rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : rows)
        list.push_back({{"family", row.family},
                        {"case", row.name},
                        {"engine", row.engine},
                        {"value", row.value},
                        {"reference", row.reference},
                        {"bound", row.bound},
                        {"unit", row.unit},
                        {"pass", row.pass},
                        {"ms", row.ms},
                        {"note", row.note}});
    return list.dump(2) + "\n";
}

std::vector<Row> rowsFromJson(const std::string& text) {
    const auto number = [](const nlohmann::json& j) {
        return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
    };
    std::vector<Row> rows;
    for (const auto& j : nlohmann::json::parse(text))
        rows.push_back({j["family"], j["case"], j["engine"], number(j["value"]), number(j["reference"]),
                        number(j["bound"]), j["unit"], j["pass"], number(j["ms"]), j["note"]});
    return rows;
}

}  // namespace ragtop::stability
