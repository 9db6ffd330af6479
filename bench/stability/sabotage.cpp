#include "sabotage.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "adapters/saboteurs.h"

namespace ragtop::stability {
namespace {

/// What happens to the rows of a case.
class Catches {
public:
    Catches(const Case& test, Trial::Setting setting) : test_(test), setting_(std::move(setting)) {}

    void tryWith(const EngineKind& saboteur) {
        Trial::Setting setting = setting_;
        setting.engine = &saboteur;
        Trial trial(setting);
        bool broke = false;
        try {
            test_.run(trial);
        } catch (const Missing&) {
            throw;
        } catch (const std::exception&) {
            broke = true;
        }
        ranEngine_ |= trial.simulated() > 0;
        for (const Row& row : trial.rows()) {
            const std::string name = row.name;
            auto at = std::ranges::find(rows_, name, [](const Caught& each) { return each.row.name; });
            if (at == rows_.end()) at = rows_.insert(at, {row, {}});
            if (row.verdict == Verdict::fails && !broke) at->by.push_back(saboteur.name);
        }
        if (!broke) return;
        for (Caught& each : rows_) each.by.push_back(saboteur.name);
    }
    bool ranEngine() const { return ranEngine_; }
    bool haveAllFailed() const {
        return std::ranges::none_of(rows_, [](const Caught& each) { return each.by.empty(); });
    }
    std::vector<Row> told() const {
        std::vector<Row> result;
        for (const Caught& each : rows_) {
            Row row = each.row;
            row.engine = setting_.engine->name;
            row.value = static_cast<double>(each.by.size());
            row.reference = 1;
            row.bound = 0;
            row.unit = "engines";
            row.verdict = each.by.empty() ? Verdict::fails : Verdict::holds;
            row.note = fmt::format("{}", fmt::join(each.by, ", "));
            if (!ranEngine_) {
                row.value = std::numeric_limits<double>::quiet_NaN();
                row.verdict = Verdict::skipped;
                row.note = "runs nothing behind an engine's interface";
            }
            result.push_back(row);
        }
        return result;
    }

private:
    struct Caught {
        Row row;
        std::vector<std::string> by;
    };
    const Case& test_;
    Trial::Setting setting_;
    std::vector<Caught> rows_;
    bool ranEngine_ = false;
};

}  // namespace

std::vector<Row> sabotage(const Case& test, Trial::Setting setting) {
    Catches catches(test, std::move(setting));
    const auto kinds = saboteurKinds();
    for (const EngineKind& kind : kinds.first(kinds.size() - 1)) {
        catches.tryWith(kind);
        if (!catches.ranEngine()) return catches.told();
        if (catches.haveAllFailed()) break;
    }
    catches.tryWith(kinds.back());
    return catches.told();
}

std::string saboteurTable(const std::vector<Row>& rows) {
    struct Count {
        int rows = 0, apart = 0;
        std::map<std::string, int> first;
    };
    std::vector<std::pair<std::string, Count>> families;
    for (const Row& row : rows) {
        if (families.empty() || families.back().first != row.family) families.push_back({row.family, {}});
        Count& count = families.back().second;
        if (row.verdict == Verdict::skipped) {
            ++count.apart;
            continue;
        }
        ++count.rows;
        ++count.first[row.note.substr(0, row.note.find(','))];
    }
    std::string text = "| Family | Rows | First failing for | Without an engine |\n|---|---|---|---|\n";
    for (const auto& [family, count] : families) {
        std::string caught;
        for (const EngineKind& kind : saboteurKinds())
            if (const auto at = count.first.find(kind.name); at != count.first.end())
                caught += fmt::format("{}{} {}", caught.empty() ? "" : ", ", at->first, at->second);
        text += fmt::format("| `{}` | {} | {} | {} |\n", family, count.rows, caught.empty() ? "–" : caught,
                            count.apart > 0 ? std::to_string(count.apart) : "–");
    }
    return text;
}

}  // namespace ragtop::stability
