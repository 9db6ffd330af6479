#include "direct/rotation.h"

namespace ragtop::direct {

namespace {

/// The body turns by t α pᵢ about its axis i, so that its momentum p, seen from the body, turns back.
void turnAboutAxis(int i, double t, double alpha, double p[3], DQuat& q) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double x = 0.5 * (t * p[i] * alpha), x2 = x * x;
    const double s = x * sineRatio(x2), c = cosine(x2);
    const double sine = 2 * (s * c), versine = 2 * (s * s), pj = p[j], pk = p[k];
    p[j] = pj + (sine * pk - versine * pj);
    p[k] = pk - (sine * pj + versine * pk);
    double axis[3] = {0, 0, 0};
    axis[i] = s;
    q = q * DQuat{axis[0], axis[1], axis[2], c};
}

}  // namespace

/// Σ pᵢ²/2Iᵢ = |p|²/2Iₘ + α₁ p₁²/2 + α₃ p₃²/2 with αᵢ = 1/Iᵢ − 1/Iₘ and Iₘ the middle moment [Dullweber, Leimkuhler,
/// McLachlan 1997].
DQuat turnFreely(const DQuat& q, const DVec3& momentum, const DVec3& inverse, double h) {
    const double inv[3] = {inverse.x, inverse.y, inverse.z};
    const auto isMiddle = [&](int a, int b, int c) {
        return (inv[b] <= inv[a] && inv[a] <= inv[c]) || (inv[c] <= inv[a] && inv[a] <= inv[b]);
    };
    const int m = isMiddle(0, 1, 2) ? 0 : isMiddle(1, 2, 0) ? 1 : 2;
    const int first = (m + 2) % 3, third = (m + 1) % 3;
    const DVec3 body = inverseRotate(q, momentum);
    double p[3] = {body.x, body.y, body.z};
    DQuat turned = q;
    turnAboutAxis(first, 0.5 * h, inv[first] - inv[m], p, turned);
    turnAboutAxis(third, h, inv[third] - inv[m], p, turned);
    turnAboutAxis(first, 0.5 * h, inv[first] - inv[m], p, turned);
    return normalized(turnBy((h * inv[m]) * momentum) * turned);
}

}  // namespace ragtop::direct
