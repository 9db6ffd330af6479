#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ragtop {

/// Calls visit(i) for each byte that is not zero, in their order; where few are, eight zeros are passed over at once.
template <class Visit>
void forEachNonzero(const std::uint8_t* bytes, std::size_t count, Visit&& visit) {
    std::size_t i = 0;
    while (i < count) {
        std::uint64_t eight = 1;
        if (i + sizeof eight <= count) std::memcpy(&eight, bytes + i, sizeof eight);
        const std::size_t end = eight == 0 ? i : (i + sizeof eight < count ? i + sizeof eight : count);
        for (std::size_t k = i; k < end; ++k)
            if (bytes[k] != 0) visit(k);
        i += sizeof eight;
    }
}

}  // namespace ragtop
