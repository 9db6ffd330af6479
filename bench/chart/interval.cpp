#include "interval.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace ragtop::chart {

namespace {

/// Student's t in double throughout: tables of long double end a program that Valgrind runs, which has no such numbers.
using StudentsT =
    boost::math::students_t_distribution<double,
                                         boost::math::policies::policy<boost::math::policies::promote_double<false>>>;

}  // namespace

TimeInterval intervalOf(std::vector<double> times) {
    if (times.empty()) throw std::invalid_argument("an interval of no times");
    std::ranges::sort(times);
    const double middle = times[times.size() / 2];
    if (times.size() == 1) {
        constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
        return {kUnknown, middle, kUnknown};
    }
    const auto n = static_cast<double>(times.size());
    double mean = 0, squares = 0;
    for (const double t : times) mean += std::log(t) / n;
    for (const double t : times) squares += (std::log(t) - mean) * (std::log(t) - mean);
    const double deviation = std::sqrt(squares / (n - 1));
    constexpr double kCoverage = 0.95;
    const double quantile = boost::math::quantile(StudentsT(n - 1), (1 + kCoverage) / 2);
    const double half = quantile * deviation * std::sqrt(2 * std::numbers::pi / 2 / n);
    return {middle * std::exp(-half), middle, middle * std::exp(half)};
}

}  // namespace ragtop::chart
