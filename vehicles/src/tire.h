#pragma once

#include "ragtop/vehicle_def.h"

/// The tire as an implicit constraint. Tread bristles at the patch carry two deflections u (m): x along the wheel, y
/// across. With s the slip velocity of the wheel's side of the patch over the ground, V the speed at which tread rolls
/// through the patch, N the load and σ the relaxation length,
///
///     du/dt = −s − V u/σ                                             (bristles enter unbent)      (1)
///     F_i   = N k_i q(|x|) (u_i + τ du_i/dt),   x_i = k_i u_i / (3 μ_i)                           (2)
///     q(x)  = 1 − x + x²/3                                           (brush, parabolic pressure)  (3)
///     (F_x/(N μ_x))² + (F_y/(N μ_y))² ≤ 1                                                         (4)
///
/// k = C/σ is the stiffness of bristles that reproduces the slip stiffness C when rolling: then u = −σ s/V and F = −N C
/// s/V. At V = 0 the same law is a spring, so that a braked wheel holds, and there is no speed at which one rule
/// replaces another. Once (4) is met, what the bristles slip is normal to the ellipse: friction takes the most power it
/// can [Simo, Hughes, Computational Inelasticity, 1998, ch. 2]. Brush and (3): [Pacejka, Tire and Vehicle Dynamics,
/// 2012, ch. 3]; first-order relaxation: ch. 7. τ, the damping of the carcass, matters at rest and fades with V.
///
/// Sliding lowers friction: with ς = s over the faster of travel and tread, z = |C_i ς_i/(3 μ_i)| all bristles slide
/// from z = 1 on, and of what a locked wheel (|ς| = 1) lacks there is the share
///
///     (z − 1)/(z/|ς| − 1)   in [0, 1]                                                                (5)
///
/// so that friction is largest where the brush has just begun to slide, and falls on a line from there.
namespace ragtop {

struct Vec2 {
    float x = 0, y = 0;
    bool operator==(const Vec2&) const = default;
};

/// A symmetric matrix.
struct Sym2 {
    float xx = 0, xy = 0, yy = 0;
};

/// What equations (1) to (5) need, for one tire on one ground under one load.
struct TireLaw {
    Vec2 friction;         ///< μ
    Vec2 stiffness;        ///< k, force over load per m of deflection
    float relaxation = 1;  ///< σ, m
    float damping = 0;     ///< τ, s, faded
};

/// Constants that do not change while driving.
struct TireSpec {
    TireDef def;
    Vec2 stiffness;
    float standingDamping = 0;  ///< τ at V = 0, s
    float swaySpeed = 1;        ///< V at which half of the damping is left, m/s
    float slowest = 1;          ///< m/s, least speed over which slip is reckoned: what sways at rest does not travel
    float staticLoad = 0;       ///< N
};
TireSpec makeTireSpec(const TireDef& def, float staticLoad, float gravity);

/// The ground as a tire sees it.
struct TireGround {
    float grip = 1, stiffness = 1, drag = 0;  ///< as TireSurface
};
/// `friction` and `surface` of its material.
TireGround tireGround(const TireDef& def, float friction, std::uint32_t surface);

/// How the wheel moved in the last substep, m/s: its side of the patch over the ground, and its tread.
struct TireMotion {
    Vec2 travel;  ///< forward, left
    float tread = 0;
};

/// `transport` is the tread's speed through the patch.
TireLaw tireLaw(const TireSpec& spec, const TireGround& ground, const TireMotion& motion, float load, float transport);

/// Secant stiffness of the brush over its first one, q in (3), for deflections u.
float brushSecant(const TireLaw& law, const Vec2& u);

/// The deflections scaled back to where all bristles slide, |x| = 1, when they are beyond.
Vec2 withinPatch(const TireLaw& law, const Vec2& u);

/// (1) over h by backward Euler.
Vec2 rolledDeflection(const TireLaw& law, const Vec2& u, const Vec2& slip, float transport, float h);

/// The deflection that a force has, by (2): F = N k q (u + τ (u − u₀)/h).
Vec2 deflectionOf(const TireLaw& law, float secant, const Vec2& before, const Vec2& force, float load, float h);

/// One implicit visit to a tire: the impulse λ that satisfies (1) to (4) at the end of a substep of h seconds, when
/// the slip is free + K λ. `load` is the normal impulse, N h.
struct TireVisit {
    Vec2 impulse;
    bool sliding = false;  ///< (4) holds with equality
};
TireVisit solveTire(const TireLaw& law, float secant, const Vec2& u, float transport, float load, float h,
                    const Sym2& K, const Vec2& free);

}  // namespace ragtop
