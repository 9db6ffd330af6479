#pragma once

#include <algorithm>
#include <cstdint>

#include "ragtop/math.h"

namespace ragtop {

/// What the solver reads and writes of a body in every pass: one cache line, gathered by transposes. Displacements
/// are since the beginning of the step, so that single precision suffices anywhere in the world. Entry 0 is the
/// static body: it has no mass, never moves, and is never written.
struct alignas(64) BodyState {
    Vec3 v;             ///< m/s, of the centre of mass
    float invMass = 0;  ///< 1/kg, 0 for static and kinematic bodies, which no impulse moves
    Vec3 w;             ///< rad/s
    std::uint32_t locks = 0;  ///< bits 0..2: translation along x, y, z is locked (rotation locks are in the inertia)
    Vec3 dp;            ///< m, displacement of the centre of mass during this step
    float pull = 0;     ///< Σ h F · r / I of its joints in this substep, see TautBody
    Quat dq;            ///< rotation during this step: q = dq · q₀
};
static_assert(sizeof(BodyState) == 64);

/// Inverse inertia about the centre of mass in world axes, of the current substep.
struct alignas(32) BodyInertia {
    float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    float excess = 0;  ///< J, see excessOfSpin; belongs to the momentum in the body's history
    float taut = 0;    ///< h² Σ F · r / I beyond what an explicit step follows, in the substeps before; see TautBody
};
static_assert(sizeof(BodyInertia) == 32);

constexpr Vec3 operator*(const BodyInertia& m, const Vec3& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

/// J: 2E − |L|²/I₂ for the momentum p in principal axes, with I₂ the middle moment: what a free body keeps beside its
/// momentum. Its sign says about which axis, that of the least or of the greatest moment, the body turns; 0 is the
/// separatrix between both.
constexpr float excessOfSpin(const Vec3& p, const Vec3& inverse) {
    const float low = std::min(inverse.x, inverse.y), high = std::max(inverse.x, inverse.y);
    const float middle = std::max(low, std::min(high, inverse.z));
    return (inverse.x - middle) * p.x * p.x + (inverse.y - middle) * p.y * p.y + (inverse.z - middle) * p.z * p.z;
}

/// A force F on an arm r turns with neither of the bodies, so it resists their turning with the stiffness F · r. All
/// joints of a body add up: K = Σ F · r. An explicit step of h follows the oscillation ω² = K/I while ω h < 2, that is
/// h² K / I < 4, which a light link under a heavy load soon exceeds. Adding the stiffness to the inertia makes the step
/// implicit in it to first order [Tournier et al., Stable Constrained Dynamics, 2015]. It conserves no angular momentum
/// and is therefore left out where the plain step is stable.
struct TautBody {
    static constexpr float kExplicit = 4;  ///< of h² K/I: ω h = 2, the bound of stability above
    /// Of the inverse inertia, that is left by a stiffness of so much more.
    static constexpr float share(float taut) { return taut > 0 ? 1 / (1 + taut) : 1.0f; }
};

/// A soft row [Catto, Soft Constraints, GDC 2011]: ω = 2πf, a₁ = 2ζ + hω, a₂ = hω a₁.
///   Δλ = −m_eff · massScale · (u + biasRate · C) − impulseScale · λ
struct Softness {
    float biasRate = 0, massScale = 1, impulseScale = 0;
};
constexpr Softness kRigid{0, 1, 0};

/// `frequency` in Hz, `damping` ratio, h in s; rigid for frequency 0.
constexpr Softness makeSoftness(float frequency, float damping, float h) {
    if (frequency <= 0) return kRigid;
    const float omega = 2 * kPi * frequency;
    const float a1 = 2 * damping + h * omega;
    const float a2 = h * omega * a1;
    const float a3 = 1 / (1 + a2);
    return {omega / a1, a2 * a3, a3};
}

}  // namespace ragtop
