#pragma once

#include <cmath>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "ragdoll_trial.h"

namespace ragtop::demos {

/// The largest of values and where it was; what is no number is larger than any.
class Worst {
public:
    void add(double value, const std::string& where) {
        if (std::isnan(value_) || value <= value_) return;
        value_ = value;
        where_ = where;
    }
    /// Zero where nothing was added.
    double value() const { return value_ == -std::numeric_limits<double>::infinity() ? 0 : value_; }
    const std::string& where() const { return where_; }

private:
    double value_ = -std::numeric_limits<double>::infinity();
    std::string where_;
};

/// How whole a ragdoll stays in all runs of a test, at the end of each step.
class WholenessWatch {
public:
    void observe(const RagdollStage& stage, const std::string& run);
    /// Adds the two figures.
    void tell(std::string_view test, std::vector<RagdollFigure>& figures) const;

private:
    Worst gap_, passed_;
};

/// How deep parts of a ragdoll that are apart at rest reach into each other, at the end of each step.
class OverlapWatch {
public:
    explicit OverlapWatch(const RagdollSubject& subject);
    void observe(const RagdollStage& stage, const std::string& run);
    /// Adds a figure where there are such parts.
    void tell(std::string_view test, std::vector<RagdollFigure>& figures) const;

private:
    std::vector<RagdollPair> apart_;
    std::vector<double> radii_;  ///< m, of parts about the middle of their shapes
    Worst depth_;
};

/// The root mean square of the speeds of all parts over the last quarter of a second.
class RestWatch {
public:
    explicit RestWatch(double hz);
    void observe(const RagdollStage& stage);
    double speed() const;  ///< m/s

private:
    std::size_t most_;
    std::deque<double> squares_;
};

}  // namespace ragtop::demos
