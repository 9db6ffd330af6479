#pragma once

#include <cmath>
#include <concepts>

namespace ragtop::stability {

/// The larger of two numbers, and NaN where one is NaN: std::max drops it, so that the worst of a run whose bodies are
/// nowhere would be what it was before.
template <std::floating_point T>
T larger(T a, T b) {
    return a > b || std::isnan(a) ? a : b;
}

/// The smaller of two numbers, and NaN where one is NaN.
template <std::floating_point T>
T smaller(T a, T b) {
    return a < b || std::isnan(a) ? a : b;
}

}  // namespace ragtop::stability
