#pragma once

#include <vector>

#include "ragtop/math.h"
#include "ragtop/vehicle_def.h"

/// Struts: how they share the car's weight, and their spring, damper and stops.
namespace ragtop {

/// A strut in numbers: the force along its axis at compression x (m above its place) is
///
///     F = load + k x + c ẋ + [x > travelUp] (k_b (x − travelUp) + c_b ẋ),   F ≥ 0
struct StrutSpec {
    float load = 0;  ///< N, of the spring with the wheel at its place
    float stiffness = 0, compressionDamping = 0, reboundDamping = 0;
    float travelUp = 0, travelDown = 0;
    float bumpStiffness = 0, bumpDamping = 0;
};
StrutSpec makeStrut(const SuspensionDef& def, float staticLoad, float gravity);

/// N of spring and bump stop at a compression.
float springForce(const StrutSpec& strut, float compression);

/// Loads of wheels at `positions` (relative to the centre of mass) that carry `weight` in balance on level ground,
/// the smallest such in the sense of least squares. Empty when there is no such set: wheels in a line.
std::vector<float> staticLoads(const std::vector<Vec3>& positions, float weight);

/// The impulse λ ≥ 0 along the ground's normal that the strut gives in a substep of h, when the point of contact
/// moves apart from the ground at free + K λ. `slant` is the cosine between axis and normal: ẋ = −(free + K λ)/slant,
/// λ = h F(x + h ẋ, ẋ)/slant, solved exactly (F rises with x and ẋ, so that there is one solution).
float solveStrut(const StrutSpec& strut, float compression, float slant, float h, float K, float free);

}  // namespace ragtop
