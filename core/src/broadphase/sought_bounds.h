#pragma once

#include <limits>

#include "base/four_floats.h"
#include "ragtop/math.h"

namespace ragtop {

/// Bounds that many others are asked about: the same as overlaps(), without branches. The six numbers of bounds are two
/// groups of four, in each of which one is compared with infinity.
class SoughtBounds {
public:
    explicit SoughtBounds(const Bounds& bounds)
        : upper_{bounds.upper.x, bounds.upper.y, bounds.upper.z, kInfinity},
          lower_{-kInfinity, bounds.lower.x, bounds.lower.y, bounds.lower.z} {}
    bool overlaps(const Bounds& other) const {
        const auto* numbers = reinterpret_cast<const float*>(&other);
        return holdsInAll((loadFour(numbers) <= upper_) & (loadFour(numbers + 2) >= lower_));
    }

private:
    static_assert(sizeof(Bounds) == 6 * sizeof(float));
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();

    FourFloats upper_, lower_;
};

}  // namespace ragtop
