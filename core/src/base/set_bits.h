#pragma once

#include <bit>
#include <cstdint>

namespace ragtop {

/// Calls visit(bit) for those that are set, lowest first.
template <class Visit>
void forEachBit(std::uint32_t bits, Visit&& visit) {
    for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

}  // namespace ragtop
