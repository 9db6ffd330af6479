#include "base/symmetric_eigen.h"

#include <cmath>

namespace ragtop {

PrincipalAxes principalAxes(const Mat3& m) {
    double a[3][3] = {{m.cx.x, m.cy.x, m.cz.x}, {m.cy.x, m.cy.y, m.cz.y}, {m.cz.x, m.cz.y, m.cz.z}};
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double scale = std::abs(a[0][0]) + std::abs(a[1][1]) + std::abs(a[2][2]);
    const double small = 1e-6 * scale;  // single-precision input: anything below is rounding
    bool turned = false;
    for (int iteration = 0; iteration < 20; ++iteration) {
        double largest = 0;
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                const double limit = turned ? 1e-15 * scale : small;
                if (std::abs(a[p][q]) <= limit) continue;
                largest = std::abs(a[p][q]) > largest ? std::abs(a[p][q]) : largest;
                turned = true;
                // t = tan φ of the rotation that zeroes a_pq
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - s * kq;
                    a[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < 3; ++k) {
                    const double pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - s * qk;
                    a[q][k] = s * pk + c * qk;
                }
                for (int k = 0; k < 3; ++k) {
                    const double kp = v[k][p], kq = v[k][q];
                    v[k][p] = c * kp - s * kq;
                    v[k][q] = s * kp + c * kq;
                }
            }
        if (largest == 0) break;
    }
    PrincipalAxes result;
    result.values = {static_cast<float>(a[0][0]), static_cast<float>(a[1][1]), static_cast<float>(a[2][2])};
    if (!turned) return result;
    const auto column = [&](int i) {
        return Vec3{static_cast<float>(v[0][i]), static_cast<float>(v[1][i]), static_cast<float>(v[2][i])};
    };
    // Jacobi rotations keep the determinant at one: the columns are right-handed.
    result.rotation = rotationFromAxes(column(0), column(1), column(2));
    return result;
}

}  // namespace ragtop
