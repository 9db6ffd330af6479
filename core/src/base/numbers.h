#pragma once

#include <cmath>

#include "ragtop/math.h"

/// A law that is written once, as templates over a number T: float for one thing alone, Lanes<N> (solve/lanes.h) for N
/// side by side. Both have the same operators, each exactly rounded, so that both give the same bits. What holds in
/// some lanes only is chosen by `select`; `any` asks whether a branch is taken at all, which alone is the condition
/// itself. Kernels of optional instruction sets must call nothing of floats: of such templates they make copies of
/// their own, since their Lanes have no linkage.
namespace ragtop {

#define RAGTOP_INLINE inline __attribute__((always_inline))

template <class T>
struct NumberTypes;
template <>
struct NumberTypes<float> {
    using Vector = Vec3;
    using Rotation = Quat;
    using Matrix = Mat3;
    using Test = bool;
};
template <class T>
using VectorOf = typename NumberTypes<T>::Vector;
template <class T>
using RotationOf = typename NumberTypes<T>::Rotation;
template <class T>
using MatrixOf = typename NumberTypes<T>::Matrix;
template <class T>
using TestOf = typename NumberTypes<T>::Test;

constexpr bool any(bool where) { return where; }
constexpr float select(bool where, float a, float b) { return where ? a : b; }
constexpr Vec3 select(bool where, const Vec3& a, const Vec3& b) { return where ? a : b; }
constexpr float max(float a, float b) { return a > b ? a : b; }
constexpr float min(float a, float b) { return a < b ? a : b; }
/// a / b where b is above zero, else zero.
constexpr float divideOrZero(float a, float b) { return b > 0 ? a / b : 0.0f; }

template <class T>
RAGTOP_INLINE T clamp(const T& value, const T& lower, const T& upper) {
    return select(value < lower, lower, select(value > upper, upper, value));
}

}  // namespace ragtop
