#include "suspension.h"

#include <algorithm>
#include <cmath>

namespace ragtop {

StrutSpec makeStrut(const SuspensionDef& def, float staticLoad, float gravity) {
    const float mass = staticLoad / gravity;
    const float omega = 2 * kPi * def.frequency;
    StrutSpec strut;
    strut.stiffness = def.stiffness.value_or(mass * omega * omega);
    strut.load = def.springCompression ? strut.stiffness * *def.springCompression : staticLoad;
    const float damping = 2 * def.dampingRatio * std::sqrt(strut.stiffness * mass);
    strut.compressionDamping = def.compressionDamping.value_or(damping);
    strut.reboundDamping = def.reboundDamping.value_or(damping);
    strut.travelUp = def.travelUp;
    strut.travelDown = def.travelDown;
    strut.bumpStiffness = def.bumpStopStiffness * strut.stiffness;
    // Rubber gives back little: half of critical.
    strut.bumpDamping = std::sqrt(strut.bumpStiffness * mass);
    return strut;
}

/// Of all F with ΣF = W, ΣF x = 0, ΣF z = 0 the one with the least ΣF² is F = a + b x + c z; the three balances are
/// the normal equations of a, b, c.
std::vector<float> staticLoads(const std::vector<Vec3>& positions, float weight) {
    double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0, szz = 0;
    for (const Vec3& p : positions) {
        const double x = p.x, z = p.z;
        n += 1;
        sx += x;
        sz += z;
        sxx += x * x;
        sxz += x * z;
        szz += z * z;
    }
    const double ca = sxx * szz - sxz * sxz, cb = sxz * sz - sx * szz, cc = sx * sxz - sxx * sz;
    const double determinant = n * ca + sx * cb + sz * cc;
    if (!(determinant > 1e-9 * n * sxx * szz)) return {};
    const double s = static_cast<double>(weight) / determinant;
    std::vector<float> loads;
    for (const Vec3& p : positions) {
        loads.push_back(static_cast<float>(s * (ca + cb * static_cast<double>(p.x) + cc * static_cast<double>(p.z))));
    }
    return loads;
}

float springForce(const StrutSpec& strut, float compression) {
    const float bump = std::max(compression - strut.travelUp, 0.0f);
    return strut.load + strut.stiffness * compression + strut.bumpStiffness * bump;
}

float solveStrut(const StrutSpec& strut, float compression, float slant, float h, float K, float free) {
    float force = strut.load + strut.stiffness * compression;
    float stiffness = strut.stiffness, extraDamping = 0;
    if (compression > strut.travelUp) {
        force += strut.bumpStiffness * (compression - strut.travelUp);
        stiffness += strut.bumpStiffness;
        extraDamping = strut.bumpDamping;
    }
    const auto impulse = [&](float damping) {
        const float g = h * (h * stiffness + damping + extraDamping) / (slant * slant);
        return (h * force / slant - g * free) / (1 + g * K);
    };
    float result = impulse(strut.compressionDamping);
    if (free + K * result > 0) result = impulse(strut.reboundDamping);
    return std::max(result, 0.0f);
}

}  // namespace ragtop
