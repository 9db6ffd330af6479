#pragma once

#include <cstdint>

/// Four floats side by side, and functions of angles of them: each lane has the bits of quick_angles.h.
namespace ragtop {

typedef float FourFloats __attribute__((vector_size(16)));
typedef std::int32_t FourInts __attribute__((vector_size(16)));

FourFloats quickArcTan(FourFloats x);
/// The cosine in lanes where `cosines` is −1, the sine where it is 0.
FourFloats quickSinOrCos(FourFloats x, FourInts cosines);

}  // namespace ragtop
