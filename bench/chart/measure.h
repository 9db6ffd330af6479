#pragma once

#include "point.h"
#include "scenes.h"
#include "variants.h"

namespace ragtop::chart {

struct MeasureOptions {
    std::uint64_t seed = 1;
    /// Runs, of which all but the first begin with a gravity that is up to a millionth off, so that what a scene owes
    /// to its bits shows as an interval.
    int repeats = 3;
};

/// What is to be measured, with nothing measured yet.
Point pointOf(const ChartScene& scene, const Variant& variant, const Setting& setting, const MeasureOptions& options);

/// Runs the scene, which is this case of the suite, in this process, on the processor that it is on. Failures are told
/// in the point.
Point measure(const ChartScene& scene, const stability::Case& test, const Variant& variant, Point point,
              const MeasureOptions& options);

}  // namespace ragtop::chart
