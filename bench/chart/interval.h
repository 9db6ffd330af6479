#pragma once

#include <vector>

namespace ragtop::chart {

/// Where the middle of as many times would fall if they were measured again.
struct TimeInterval {
    double low = 0, middle = 0, high = 0;
};

/// The median of times, each > 0 and of the same work, and the prediction interval of another such median with 95 %:
///   log t is normal, so that medians of n differ by s √(2 v/n) t₀.₉₇₅(n − 1),
/// with v = π/2 the variance of a median over that of a mean [Kenney, Keeping, 1962], which is less for few times. Of a
/// single time nothing is known: low and high are NaN. Throws std::invalid_argument where there is none.
TimeInterval intervalOf(std::vector<double> times);

}  // namespace ragtop::chart
