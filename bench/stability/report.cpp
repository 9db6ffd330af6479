#include "report.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace ragtop::stability {

namespace {

const char* verdictOf(const Row& row) {
    switch (row.verdict) {
        case Verdict::holds:
            return "ok";
        case Verdict::fails:
            return "FAILS";
        case Verdict::skipped:
            break;
    }
    return "skipped";
}

/// true, false, or null where nothing was measured.
nlohmann::json passOf(const Row& row) {
    if (row.verdict == Verdict::skipped) return nullptr;
    return row.verdict == Verdict::holds;
}
Verdict verdictOf(const nlohmann::json& pass) {
    if (pass.is_null()) return Verdict::skipped;
    return pass.get<bool>() ? Verdict::holds : Verdict::fails;
}

}  // namespace

std::string tableHead() {
    return fmt::format("{:<14} {:<46} {:<12} {:>11} {:>11} {:>10} {:<8} {:<7} {:>9}\n", "family", "case", "engine",
                       "value", "reference", "bound", "unit", "", "ms/s");
}

std::string tableLine(const Row& row) {
    return fmt::format("{:<14} {:<46} {:<12} {:>11.5g} {:>11.5g} {:>10.3g} {:<8} {:<7} {:>9.3f}{}{}\n", row.family,
                       row.name, row.engine, row.value, row.reference, row.bound, row.unit, verdictOf(row), row.ms,
                       row.note.empty() ? "" : "  ", row.note);
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
                        {"pass", passOf(row)},
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
                        number(j["bound"]), j["unit"], verdictOf(j["pass"]), number(j["ms"]), j["note"]});
    return rows;
}

}  // namespace ragtop::stability
