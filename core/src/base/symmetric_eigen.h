#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// The principal frame of a symmetric matrix: m = R diag(values) Rᵀ with R a rotation.
struct PrincipalAxes {
    Quat rotation;
    Vec3 values;
};

/// Cyclic Jacobi rotations in double [Golub, Van Loan, Matrix Computations, 8.5]. A matrix that is diagonal to rounding
/// keeps its axes and their order exactly, so that a box is not turned.
PrincipalAxes principalAxes(const Mat3& m);

}  // namespace ragtop
