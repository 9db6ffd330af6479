#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "measure.h"
#include "ranks.h"

namespace ragtop::chart {

/// A point that is to be measured, with where it comes from.
struct Task {
    const ChartScene* scene;
    const stability::Case* test;
    const Variant* variant;
    Point point;
};

struct SweepOptions {
    MeasureOptions measure;
    double limit = 60;     ///< s of processor time for a point; it has failed when it takes longer
    double patience = 10;  ///< s by the clock, beyond four times that limit, for one that sleeps
    int jobs = 1;          ///< points measured at once
    /// Where each point is kept as soon as it is measured.
    std::optional<std::filesystem::path> journal;
    bool resume = false;  ///< takes what the journal has
    bool again = false;   ///< but for points that other processes disturbed
    /// Others that measure; null: this process does.
    const Ranks* ranks = nullptr;
};

/// Measures each task in a process of its own, so that an engine that hangs, dies or loses itself is a failed point and
/// no more; `report` is told of each in the order of the tasks, or, where ranks measure, as they come: the
/// longest are handed out first. Once a variant cannot represent a scene, it is not
/// asked again. Throws std::runtime_error where the journal cannot be written or is of another sweep.
Points sweep(const std::vector<Task>& tasks, const SweepOptions& options,
             const std::function<void(const Point&)>& report);

/// The line of the journal, without its numbers, that a task comes to.
std::string measureTask(const Task& task, const MeasureOptions& options);

/// Fills in how far each point is from what the same variant gives at its finest setting: the shortest step, then most
/// substeps, then most iterations of those that were measured. The finest has none, nor has one that errs most in
/// another quantity.
void addSelfConsistency(Points& points);

}  // namespace ragtop::chart
