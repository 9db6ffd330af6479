#pragma once

#include "ragtop/shape.h"

namespace ragtop {

/// No shape and no query meets what has such a filter: it has no place in the broad phase.
inline bool meetsNothing(const Filter& filter) { return filter.category == 0 && filter.mask == 0 && filter.group <= 0; }

}  // namespace ragtop
