#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../stability/engine.h"
#include "point.h"

namespace ragtop::chart {

/// How many points a sweep has.
enum class Effort { quick, normal, longer };

/// A way of an engine to solve, and the settings that a chart sweeps.
struct Variant {
    std::string engine;  ///< "bullet"
    std::string name;    ///< "bullet-nncg"
    std::string version;
    std::string what;  ///< one line for the documentation
    Setting standard;  ///< the engine's own, or what its makers recommend
    std::vector<int> substeps{1};
    std::vector<int> iterations{0};
    bool quick = true;  ///< swept by --quick too
    std::function<std::unique_ptr<stability::Engine>(const Scene& scene, const Setting& setting)> make;
    std::string engineCommand{};  ///< of a program that is no part of this one
    bool timed = true;            ///< its times can be compared with those of others
};

/// All that this program was built with.
const std::vector<Variant>& allVariants();

/// The standard setting and those of the sweep, each once.
std::vector<Setting> settingsOf(const Variant& variant, Effort effort);

}  // namespace ragtop::chart
