#pragma once

#include <cmath>

/// Coulomb's cone as a convex potential. A contact point gives way by the resistance R (velocity per impulse) about a
/// load λ̂:
///   y = λ̂ − (u − û)/R,   λ = P_K(y),   φ(u) = ½ R |λ|²,   ∂φ/∂u = −λ,   ∂²φ/∂u² = P_K'(y)/R,
/// with K = {|λ_t| ≤ μ λ_n}; components are (normal, tangent, tangent) [Castro et al., SAP, 2022].
namespace ragtop::direct {

enum class ConeRegion : unsigned char { apart, stick, slide };

struct ConePoint {
    double impulse[3];
    ConeRegion region;
};

/// The nearest point of the cone.
inline ConePoint project(const double y[3], double friction) {
    const double tangent = std::sqrt(y[1] * y[1] + y[2] * y[2]);
    if (tangent <= friction * y[0]) return {{y[0], y[1], y[2]}, ConeRegion::stick};
    const double along = y[0] + friction * tangent;
    if (along <= 0) return {{0, 0, 0}, ConeRegion::apart};
    const double normal = along / (1 + friction * friction);
    const double share = friction * normal / tangent;
    return {{normal, share * y[1], share * y[2]}, ConeRegion::slide};
}

/// ∂P_K/∂y, symmetric and positive semidefinite, packed as nn n1 n2 11 12 22.
inline void projectionSlope(const double y[3], double friction, ConeRegion region, double slope[6]) {
    for (int i = 0; i < 6; ++i) slope[i] = 0;
    if (region == ConeRegion::stick) slope[0] = slope[3] = slope[5] = 1;
    if (region != ConeRegion::slide) return;
    const double tangent = std::sqrt(y[1] * y[1] + y[2] * y[2]);
    const double s = 1 / (1 + friction * friction), d1 = y[1] / tangent, d2 = y[2] / tangent;
    const double turn = friction * s * (y[0] + friction * tangent) / tangent;
    const double along = s * friction * friction - turn;
    slope[0] = s;
    slope[1] = s * friction * d1;
    slope[2] = s * friction * d2;
    slope[3] = turn + along * d1 * d1;
    slope[4] = along * d1 * d2;
    slope[5] = turn + along * d2 * d2;
}

}  // namespace ragtop::direct
