#include "sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "../stability/isolation.h"
#include "base/hash.h"
#include "csv.h"
#include "journal.h"

namespace ragtop::chart {
namespace {

/// Tells sweeps apart: what is measured, and how.
std::string digestOf(const std::vector<Task>& tasks, const SweepOptions& options) {
    StateHash hash;
    hash.add(options.measure.seed);
    hash.add(options.measure.repeats);
    for (const Task& task : tasks) {
        const std::string key = task.point.key() + task.point.version;
        hash.add(std::as_bytes(std::span(key)));
    }
    return fmt::format("{:016x}", hash.value());
}

std::string groupOf(const Task& task) { return task.scene->name + "/" + task.variant->name; }

class Sweep {
public:
    Sweep(const std::vector<Task>& tasks, const SweepOptions& options, const std::function<void(const Point&)>& report)
        : tasks_(tasks), options_(options), report_(report) {
        if (options.journal)
            journal_.emplace(*options.journal, digestOf(tasks, options), options.resume, options.again);
        for (const Task& task : tasks) points_.push_back(task.point);
        findGroups();
    }

    Points run() {
        for (const Group& group : groups_) {
            if (options_.ranks) break;
            measureAll({group.begin});
            measureAll(othersOf(group));
        }
        if (options_.ranks) runOnRanks();
        return std::move(points_);
    }

private:
    /// A scene in one variant. Its first point, the standard one, tells whether it can be represented.
    struct Group {
        std::size_t begin, end;
    };

    void findGroups() {
        for (std::size_t begin = 0, end = 0; begin < tasks_.size(); begin = end) {
            while (end < tasks_.size() && groupOf(tasks_[end]) == groupOf(tasks_[begin])) ++end;
            groups_.push_back({begin, end});
        }
    }

    void runOnRanks() {
        std::vector<std::size_t> standard, others;
        std::vector<double> estimates(tasks_.size());
        for (const Group& group : groups_) standard.push_back(group.begin);
        measureAll(standard);
        for (const Group& group : groups_)
            for (const std::size_t i : othersOf(group)) {
                others.push_back(i);
                estimates[i] = estimateOf(points_[i], points_[group.begin]);
            }
        std::ranges::sort(others, {}, [&](std::size_t i) { return std::pair{-estimates[i], i}; });
        measureAll(others);
    }

    /// What is to be measured of a group beside its standard point: nothing where that is unsupported.
    std::vector<std::size_t> othersOf(const Group& group) {
        std::vector<std::size_t> others;
        const Point& standard = points_[group.begin];
        for (std::size_t i = group.begin + 1; i < group.end; ++i) {
            if (standard.outcome != Outcome::unsupported) {
                others.push_back(i);
                continue;
            }
            points_[i].outcome = Outcome::unsupported;
            points_[i].reason = standard.reason;
        }
        return others;
    }

    /// ms that a point should take, by what the standard one took; 0 where that failed.
    static double estimateOf(const Point& point, const Point& standard) {
        const double took = standard.cpuMs * standard.simulated;
        if (!std::isfinite(took)) return 0;
        const auto sizeOf = [](const Setting& setting) {
            return setting.substeps * std::max(setting.iterations, 1) / setting.step;
        };
        return took * sizeOf(point.setting) / sizeOf(standard.setting);
    }

    void measureAll(const std::vector<std::size_t>& asked) {
        std::vector<std::size_t> open;
        for (const std::size_t i : asked) {
            const Point* known = journal_ ? journal_->find(tasks_[i].point.key()) : nullptr;
            if (known)
                points_[i] = *known;
            else
                open.push_back(i);
        }
        const auto done = [&](std::size_t i, const stability::Outcome& outcome) {
            Point& point = points_[i];
            take(point, outcome);
            // Cores that others measure on share their caches and memory.
            if (options_.jobs > 1 || (options_.ranks && options_.ranks->count() > 2)) point.alone = false;
            if (journal_) journal_->add(point);
            report_(point);
        };
        if (options_.ranks) return options_.ranks->handOut(open, done);
        std::vector<std::function<std::string()>> works;
        for (const std::size_t i : open)
            works.push_back([this, i] { return measureTask(tasks_[i], options_.measure); });
        stability::runIsolated(
            works, options_.jobs,
            [&](std::size_t work, const stability::Outcome& outcome) { done(open[work], outcome); }, options_.limit,
            options_.patience);
    }

    static void take(Point& point, const stability::Outcome& outcome) {
        point.outcome = Outcome::failed;
        point.reason = outcome.death;
        if (!outcome.death.empty()) return;
        try {
            const std::string_view line(outcome.text);
            point = parseCsvLine(line.substr(0, line.find('\n')), point.key()).point;
        } catch (const CsvError& error) {
            point.reason = error.what();
        }
    }

    const std::vector<Task>& tasks_;
    const SweepOptions& options_;
    const std::function<void(const Point&)>& report_;
    std::optional<Journal> journal_;
    Points points_;
    std::vector<Group> groups_;
};

auto fineness(const Point& point) {
    return std::tuple(-point.setting.step, point.setting.substeps, point.setting.iterations);
}

}  // namespace

Points sweep(const std::vector<Task>& tasks, const SweepOptions& options,
             const std::function<void(const Point&)>& report) {
    return Sweep(tasks, options, report).run();
}

std::string measureTask(const Task& task, const MeasureOptions& options) {
    return csvLine(measure(*task.scene, *task.test, *task.variant, task.point, options), 0, 0);
}

void addSelfConsistency(Points& points) {
    std::map<std::pair<std::string, std::string>, const Point*> finest;
    for (const Point& point : points) {
        if (point.outcome != Outcome::measured) continue;
        const Point*& best = finest[{point.scene, point.variant}];
        if (!best || fineness(point) > fineness(*best)) best = &point;
    }
    for (Point& point : points) {
        point.selfConsistency = kNone;
        if (point.outcome != Outcome::measured) continue;
        const Point& best = *finest[{point.scene, point.variant}];
        if (&best == &point || best.quantity != point.quantity) continue;
        // Errors are values over a scale, which is the scene's.
        const Point& known = point.error > 0 ? point : best;
        const double scale = known.error > 0 ? std::abs(known.value - known.reference) / known.error : 1;
        point.selfConsistency = std::abs(point.value - best.value) / scale;
    }
}

}  // namespace ragtop::chart
