#pragma once

#include "ragtop/vehicle_def.h"
#include "slip_law.h"
#include "tire_axes.h"

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
///
/// A tire whose law is a function of slip (slip_law.h) has the same (1), with the speed of travel for V, so that u/σ is
/// the slip that the tire has come to: s/V where it stays, whichever way it goes, and at rest the law is a spring. For
/// (2) to (5) it has F = N f(u/σ + τ/σ du/dt) on the line from f without the slip of that direction to f, which is
/// never steeper than f is at its steepest, and with |u| ≤ σ.
namespace ragtop {

/// A symmetric matrix.
struct Sym2 {
    float xx = 0, xy = 0, yy = 0;
};

/// The brush that has the frictions and stiffnesses of a tire of another law under a load; a brush is what it is.
TireDef asBrush(const TireDef& def, float load);

/// What equations (1) to (5) need, for one tire on one ground under one load.
struct TireLaw {
    Vec2 friction;         ///< μ
    Vec2 stiffness;        ///< k, force over load per m of deflection
    float relaxation = 1;  ///< σ, m
    float damping = 0;     ///< τ, s, faded
    SlipLaw slips{};       ///< where it is no brush; friction is then the largest, and bounds what is tried
    bool isBrush() const { return std::holds_alternative<std::monostate>(slips); }
};

/// F/N = offset + stiffness (u + τ du/dt), of a law near a deflection.
struct TireLine {
    Vec2 offset, stiffness;
};

/// Constants that do not change while driving.
struct TireSpec {
    TireDef def;
    Vec2 stiffness;
    float standingDamping = 0;  ///< τ at V = 0, s
    float swaySpeed = 1;        ///< V at which half of the damping is left, m/s
    float slowest = 1;          ///< m/s, least speed over which slip is reckoned: what sways at rest does not travel
    float staticLoad = 0;       ///< N
    Vec2 friction;              ///< largest, at the static load
};
TireSpec makeTireSpec(const TireDef& def, float staticLoad, float gravity);

/// The ground as a tire sees it.
struct TireGround {
    float grip = 1, stiffness = 1, drag = 0;  ///< as TireSurface
    float inclination = 0;                    ///< rad, of the wheel over it, its top to the right
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

/// Forces over load of a law at deflections u; none of a brush, whose line tells all.
SlipForces forcesAt(const TireLaw& law, const Vec2& u);
/// Of a law there.
TireLine tireLine(const TireLaw& law, const Vec2& u, const SlipForces& forces);
inline TireLine tireLine(const TireLaw& law, const Vec2& u) { return tireLine(law, u, forcesAt(law, u)); }

/// The deflections scaled back to where all bristles slide, |x| = 1, when they are beyond; |u| = σ where it is no
/// brush.
Vec2 withinPatch(const TireLaw& law, const Vec2& u);

/// Deflections from which treads come back where the slip turns round. A law of slip has a peak beyond which it falls,
/// and a locked wheel |u| = σ: no spring is bent so far. What is beyond the peak comes back from where it had the same
/// force before it.
Vec2 beforePeak(const TireLaw& law, const Vec2& u);

/// Tread under a load, N: what of it bears `coreLoad` is bent by `core`, all of it by `mean` in the mean. What more
/// load presses on the ground enters unbent; with less of it what came last leaves first, and takes its bend along. So
/// loads that sway give nothing to a car, and do not let one creep that stands.
struct Tread {
    Vec2 mean, core;
    float load = 0, coreLoad = 0;
};
/// Its mean under another load.
Vec2 meanUnder(const Tread& tread, float load);
/// The same tread there.
Tread underLoad(const Tread& tread, float load);

/// (1) over h by backward Euler.
Vec2 rolledDeflection(const TireLaw& law, const Vec2& u, const Vec2& slip, float transport, float h);

/// One implicit visit to a tire: the impulse λ that satisfies (1) to (4) over a substep of h seconds, when
/// the slip is free + K λ. `load` is the normal impulse, N h.
struct TireVisit {
    Vec2 impulse;
    bool sliding = false;  ///< (4) holds with equality
    float grip = 0;        ///< N s along the wheel by a m/s of slip, of a tread that nothing else moves
    Vec2 end{1, 1};        ///< θ, see solveTire
};
TireVisit solveTire(const TireLaw& law, const TireLine& line, const Vec2& u, float transport, float load, float h,
                    const Sym2& K, const Vec2& free);

/// The deflections at the end of a substep with that outcome, from u at its beginning; the slip is that at its end.
/// What slides has those of its force.
Vec2 deflectionAfter(const TireLaw& law, const TireLine& line, const Vec2& u, const TireVisit& visit, const Vec2& slip,
                     float transport, float load, float h);

/// The line for the next visit, after one with such deflections at its end, in which the tire slid or did not.
TireLine lineAfter(const TireLaw& law, const Vec2& bent, bool sliding);

/// J/N that treads bent by u give back on their way to straight at rest, ∫ F(t u)·u dt over the load.
double bentEnergy(const TireLaw& law, const Vec2& u);

/// N m about the ground's normal, to the left, by which a tire turns its wheel at deflections u, with the forces there;
/// 0 of a brush. `forward` is the speed of travel along the wheel, m/s.
float aligningMoment(const TireLaw& law, const Vec2& u, const SlipForces& forces, float load, float forward);

}  // namespace ragtop
