#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

/// What a chart is made of: points, each one scene in one variant of an engine with one setting.
namespace ragtop::chart {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Setting {
    double step = 1.0 / 60;  ///< s
    int substeps = 1;
    int iterations = 0;  ///< of the solver; 0 where the variant has none
};

enum class Outcome {
    measured,
    failed,       ///< fell, came apart, died, took too long, or erred beyond what counts
    unsupported,  ///< the engine cannot represent the scene
};

/// How the value that a scene should have is known, the surest first.
enum class ReferenceKind {
    closedForm,  ///< an equation
    published,   ///< a solution to 1e-10 or better that others have published
    invariant,   ///< a law: energy, momentum, a joint that is closed
    threshold,   ///< on this side of a limit nothing moves
};
const char* nameOf(ReferenceKind kind);

/// One point with what was measured of it: a line of the CSV (docs/chart.md has the columns). What is unknown is NaN.
struct Point {
    std::string scene, quantity, unit, referenceKind;
    std::string engine, version, variant;
    Setting setting;
    bool isDefault = false;  ///< the engine's own setting
    std::uint64_t seed = 1;
    std::uint64_t digest = 0;

    Outcome outcome = Outcome::failed;
    double failedAt = kNone;  ///< s
    double value = kNone, reference = kNone;
    double error = kNone, errorLow = kNone, errorHigh = kNone;
    double selfConsistency = kNone;
    double contacts = kNone, passes = kNone;  ///< means per step
    double simulated = kNone;                 ///< s
    int repeats = 0;
    std::string reason;
    std::string command;  ///< that repeats the point

    bool alone =
        true;  ///< the times count: no other process shared the processor, and the engine is compiled like others
    double cpuMs = kNone, cpuMsLow = kNone, cpuMsHigh = kNone;  ///< per simulated second

    /// "scene/variant@rate x substeps i iterations", by which --point finds it.
    std::string key() const;
};

using Points = std::vector<Point>;

}  // namespace ragtop::chart
