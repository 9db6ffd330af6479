#pragma once

#include <vector>

#include "ragtop/math.h"
#include "ragtop/vehicle_def.h"

/// Struts: how they share the car's weight, and their spring, damper and stops, with the tire that stands below.
namespace ragtop {

/// From a speed on, of a damper: force + slope (|ẋ| − speed).
struct DamperLine {
    float speed = 0;  ///< m/s
    float force = 0;  ///< N
    float slope = 0;  ///< N s/m
};

/// A stop that begins to yield at a place of the strut and is met s farther, over a length L: k s (1 + p s/(2 L)).
struct StopSpec {
    float stiffness = 0;    ///< k, N/m
    float progression = 0;  ///< p/L, 1/m
};

/// A strut in numbers: the force along its axis at compression x (m above its place) is
///
///     F = load + k x + D(ẋ) + B(x − travelUp) + [x > travelUp] c_b ẋ + 20 k_b (x − travelMost)₊ − E(−travelDown − x),
///
/// with B and E the rubber of the stops (StopSpec) and D the damper, on lines through (0, 0); F ≥ 0 and x ≥
/// travelLeast. The tire, in series with it, presses the ground with N = k_t (δ + 10 (δ − δ_r)₊), δ ≥ 0 (m along the
/// ground's normal) the squash, which is δ₀ where it bears the standing car and has its radius, and δ_r where the rim
/// is on the ground.
struct StrutSpec {
    float load = 0;  ///< N, of the spring with the wheel at its place
    float stiffness = 0;
    std::vector<DamperLine> compression, rebound;  ///< from 0 m/s on
    float travelUp = 0, travelDown = 0;
    StopSpec bump, droop;
    float bumpDamping = 0;
    float travelMost = 0, solidStiffness = 0;  ///< m and N/m more, where the rubber of the bump stop is squashed
    float travelLeast = 0;                     ///< m, where the droop stop gives way no more
    float tireStiffness = 0, tireSquash = 0, rimSquash = 0;  ///< k_t, δ₀, δ_r
    float wheelWeight = 0;                                   ///< N, with which a wheel in the air falls
};
StrutSpec makeStrut(const WheelDef& wheel, float staticLoad, float gravity);

/// N of spring and stops at a compression.
float springForce(const StrutSpec& strut, float compression);

/// N of the damper at a speed of compression.
float damperForce(const StrutSpec& strut, float speed);

/// m by which a tire is squashed under a load.
float squashUnder(const StrutSpec& strut, float load);

/// J that spring and stops hold at a compression, more than the spring does where it bears nothing.
double springEnergy(const StrutSpec& strut, float compression);

/// J that a tire holds that is squashed by so many m.
double squashEnergy(const StrutSpec& strut, float squash);

/// Loads of wheels at `positions` (relative to the centre of mass) that carry `weight` in balance on level ground,
/// the smallest such in the sense of least squares. Empty when there is no such set: wheels in a line.
std::vector<float> staticLoads(const std::vector<Vec3>& positions, float weight);

/// What a strut and its tire do in a substep.
struct StrutVisit {
    float impulse = 0;    ///< N s, λ ≥ 0 along the ground's normal
    float way = 0;        ///< m that the strut is compressed more at its end
    float stiffness = 0;  ///< N/m, by which its force rises with that way
};

/// What else presses a wheel down along its strut: an anti-roll bar, by force + stiffness w.
struct BarPull {
    float force = 0, stiffness = 0;  ///< N, N/m
};

/// A substep of h, when the car's side of the contact moves apart from the ground at free + K λ, and the tire is
/// squashed by δ at its beginning. `slant` is the cosine s between strut and normal: of the way W = −h (free + K λ)/s
/// along the strut it takes w, and the tire W − w,
///
///     F = F_strut(x + w, w/h) + bar,   F = s N(δ + s (W − w)) + R,   λ = h (F − R)/s
///
/// where R is what the tire's grip pushes along the strut, N. Both rise with their ways, piece by piece on a line or,
/// where a stop is progressive, by Newton's method on its tangents, so that there is one solution.
StrutVisit solveStrut(const StrutSpec& strut, float compression, float squash, float slant, float h, float K,
                      float free, float rub = 0, const BarPull& bar = {});

/// m that a strut whose wheel is in the air is compressed more at the end of a substep: it falls as its damper lets it.
float fallOfWheel(const StrutSpec& strut, float compression, float h, const BarPull& bar = {});

/// The same where what the wheel weighs is part of `bar`, and nothing else moves it.
float swingOfWheel(const StrutSpec& strut, float compression, float h, const BarPull& bar);

}  // namespace ragtop
