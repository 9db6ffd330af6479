#pragma once

#include <cstdint>
#include <span>

#include "constraints/rows.h"
#include "model/bodies.h"
#include "model/joints.h"
#include "ragtop/math.h"

/// Momenta and energies of a group of bodies where a step leaves them: velocities of its end, places moved by dp and
/// dq.
namespace ragtop {

/// J, of a body that is turned so.
double kineticEnergy(const Bodies& bodies, std::uint32_t body, const Quat& rotation);
/// Principal axes to world, moved by dq.
Quat rotationNow(const Bodies& bodies, std::uint32_t body);

/// kg m²/s, about the centre of mass of the group, where and as its bodies were when the step began.
Vec3 angularMomentumAtStart(const Bodies& bodies, std::span<const std::uint32_t> group);

/// The motion that a group would have as one rigid body, and the energies of that and of the rest.
struct CommonMotion {
    DVec3 center;                 ///< m, of mass
    Vec3 v, w;                    ///< m/s of the centre, rad/s
    Vec3 momentum;                ///< kg m²/s, about the centre
    Factor3 inertia{};            ///< kg m², the same
    double rigid = 0, inner = 0;  ///< J
};
CommonMotion commonMotion(const Bodies& bodies, std::span<const std::uint32_t> group);

/// Turns a group, as one body, to the angular momentum given.
void turnToMomentum(Bodies& bodies, std::span<const std::uint32_t> group, const Vec3& momentum);
/// Takes so much energy (J) from the motion of the bodies against each other, which keeps both momenta; where those
/// need not be kept, from all their motion. Tells how much there was to take.
double takeEnergy(Bodies& bodies, Joints& joints, std::span<const std::uint32_t> group, double energy,
                  bool keepsMomenta);

}  // namespace ragtop
