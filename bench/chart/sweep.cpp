#include "sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

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
        if (options.journal) journal_.emplace(*options.journal, digestOf(tasks, options), options.resume);
    }

    Points run() {
        Points points;
        // A group is a scene in one variant. Its first point, the standard one, tells whether it can be represented.
        for (std::size_t begin = 0, end = 0; begin < tasks_.size(); begin = end) {
            while (end < tasks_.size() && groupOf(tasks_[end]) == groupOf(tasks_[begin])) ++end;
            runGroup(begin, end, points);
        }
        return points;
    }

private:
    void runGroup(std::size_t begin, std::size_t end, Points& points) {
        measureAll(begin, begin + 1, points);
        if (points.back().outcome != Outcome::unsupported) return measureAll(begin + 1, end, points);
        for (std::size_t i = begin + 1; i < end; ++i) {
            Point point = tasks_[i].point;
            point.outcome = Outcome::unsupported;
            point.reason = points[begin].reason;
            points.push_back(std::move(point));
        }
    }

    void measureAll(std::size_t begin, std::size_t end, Points& points) {
        std::vector<std::function<std::string()>> works;
        std::vector<std::size_t> open;
        const std::size_t first = points.size();
        for (std::size_t i = begin; i < end; ++i) {
            const Point* known = journal_ ? journal_->find(tasks_[i].point.key()) : nullptr;
            points.push_back(known ? *known : tasks_[i].point);
            if (known) continue;
            open.push_back(i);
            works.push_back([this, &task = tasks_[i]] {
                return csvLine(measure(*task.scene, *task.test, *task.variant, task.point, options_.measure), 0, 0);
            });
        }
        const auto done = [&](std::size_t work, const stability::Outcome& outcome) {
            Point& point = points[first + open[work] - begin];
            take(point, outcome);
            if (options_.jobs > 1) point.alone = false;
            if (journal_) journal_->add(point);
            report_(point);
        };
        stability::runIsolated(works, options_.jobs, done, options_.limit);
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
};

auto fineness(const Point& point) {
    return std::tuple(-point.setting.step, point.setting.substeps, point.setting.iterations);
}

}  // namespace

Points sweep(const std::vector<Task>& tasks, const SweepOptions& options,
             const std::function<void(const Point&)>& report) {
    return Sweep(tasks, options, report).run();
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
