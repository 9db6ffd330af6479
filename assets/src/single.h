#pragma once

namespace ragtop {

/// What files say in double, as the core has it.
inline float single(double value) { return static_cast<float>(value); }

}  // namespace ragtop
