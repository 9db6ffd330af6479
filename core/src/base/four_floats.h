#pragma once

#include <cstdint>

/// Four floats side by side, as every processor that Ragtop runs on has them: for tests of many candidates by code that
/// is compiled once. Each lane computes what scalar code would.
namespace ragtop {

typedef float FourFloats __attribute__((vector_size(16)));
typedef std::int32_t FourInts __attribute__((vector_size(16)));

/// Memory of any alignment.
inline FourFloats loadFour(const float* from) {
    typedef float Unaligned __attribute__((vector_size(16), aligned(4)));
    return *reinterpret_cast<const Unaligned*>(from);
}

/// Does a comparison hold in all lanes?
inline bool holdsInAll(FourInts holds) {
    typedef std::int64_t Halves __attribute__((vector_size(16)));
    const Halves halves = reinterpret_cast<Halves>(holds);
    return (halves[0] & halves[1]) == -1;
}

/// Bit i for each lane i of a comparison that holds.
inline unsigned lanesWhere(FourInts holds) {
    typedef std::int64_t Halves __attribute__((vector_size(16)));
    const Halves halves = reinterpret_cast<Halves>(holds & FourInts{1, 2, 4, 8});
    const auto both = static_cast<std::uint64_t>(halves[0] | halves[1]);
    return static_cast<unsigned>((both | both >> 32) & 15u);
}

}  // namespace ragtop
