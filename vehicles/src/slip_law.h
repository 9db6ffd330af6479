#pragma once

#include <variant>

#include "ragtop/tire_laws.h"
#include "tire_axes.h"

/// Laws of tires that give force over load by slip: s over the speed of travel, against the slip velocity s, as a
/// vector in the plane of the ground. A locked wheel has one of length 1, whichever way it slides.
namespace ragtop {

/// The ground under a tire, and how it stands on it.
struct TireStand {
    float grip = 1, stiffness = 1;  ///< over those of the law
    float load = 0;                 ///< N
    float inclination = 0;          ///< rad, the top of the wheel to the right
};

/// D sin(C atan(B x − E (B x − atan(B x)))), x = slip + shift, and `lift` more.
struct MagicCurve {
    float B = 0, C = 0, D = 0, E = 0, bend = 0;  ///< E (1 − bend sgn x)
    float shift = 0, lift = 0;
};

/// The weight of combined slip: cos of the same over its value at no slip; B falls by cos(atan(fall (y − from))).
struct MagicWeight {
    float B = 0, C = 0, E = 0, shift = 0, fall = 0, from = 0;
    float restB = 0, restWhole = 1;  ///< B, and the cosine that it is over, where nothing slips in its direction
};

/// A Magic Formula for one load, camber and ground; forces and moments over load.
struct MagicFactors {
    MagicCurve along, across;
    MagicWeight alongWeight, acrossWeight;
    float alongRest = 0, acrossRest = 0;                         ///< of the curves, without slip
    float slipStiffness = 0, corneringStiffness = 0;             ///< K over load; the second as in .tir files, below 0
    float drift = 0, driftFall = 0, driftShape = 0, driftB = 0;  ///< RVY1 to RVY6
    float trailB = 0, trailC = 0, trailD = 0, trailE = 0, trailBend = 0, trailShift = 0;  ///< pneumatic trail, m
    float residualB = 0, residualD = 0, residualShift = 0;
    float arm = 0, armPerForce = 0;  ///< m of Fx; m per force over load
};

struct SlipCurves {
    SlipCurve along, across;
    float grip = 1;
};

/// Nothing: the tire is a brush (tire.h).
using SlipLaw = std::variant<std::monostate, MagicFactors, SlipCurves>;

MagicFactors magicFactors(const MagicFormulaDef& def, const TireStand& stand);
SlipCurves slipCurves(const SlipCurvesDef& def, const TireStand& stand);

/// Forces over load on the wheel, forward and left.
struct SlipForces {
    Vec2 force;
    Vec2 withoutOwn;   ///< of each direction without its own slip, from that of the other and the shifts of the law
    float across = 0;  ///< of a Magic Formula, of the slip angle alone, without drift
};

/// `slip` is against the slip velocity: forward where it drives.
SlipForces forcesOverLoad(const SlipLaw& law, const Vec2& slip);
inline Vec2 forceOverLoad(const SlipLaw& law, const Vec2& slip) { return forcesOverLoad(law, slip).force; }

/// Moment over load about the ground's normal, m, to the left, with the forces at that slip. `forward` is 1 where the
/// wheel travels forward, -1 backwards.
float alignmentOverLoad(const SlipLaw& law, const Vec2& slip, const SlipForces& forces, float forward);

/// Largest forces over load, and their slopes without slip.
Vec2 peakFriction(const SlipLaw& law);
Vec2 slopeAtRest(const SlipLaw& law);

/// e^x with the same bits on every platform.
float exponential(float x);

}  // namespace ragtop
