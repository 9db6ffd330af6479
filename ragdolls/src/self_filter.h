#pragma once

#include <cstdint>

#include "ragtop/id.h"

namespace ragtop {

/// The group of shapes of a ragdoll that do not meet each other. It is named after the body of the first part, far
/// below what callers would use.
inline std::int32_t groupOfSelf(BodyId first) { return -0x40000000 + static_cast<std::int32_t>(first.index); }

}  // namespace ragtop
