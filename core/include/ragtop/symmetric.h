#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// The inverse of a symmetric positive matrix; zero when it has none. In doubles, whose range holds the products of
/// three numbers of single precision.
inline Mat3 inverseSymmetric(const Mat3& m) {
    const double xx = m.cx.x, yy = m.cy.y, zz = m.cz.z, xy = m.cy.x, xz = m.cz.x, yz = m.cz.y;
    const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const double determinant = xx * a + xy * b + xz * c;
    if (!(determinant > 0)) return {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    const double s = 1 / determinant;
    const auto part = [s](double minor) { return static_cast<float>(s * minor); };
    const float ixy = part(b), ixz = part(c), iyz = part(xy * xz - xx * yz);
    return {{part(a), ixy, ixz}, {ixy, part(xx * zz - xz * xz), iyz}, {ixz, iyz, part(xx * yy - xy * xy)}};
}

}  // namespace ragtop
