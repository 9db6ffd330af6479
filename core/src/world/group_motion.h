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

/// Where a body is and how fast.
struct MovingPose {
    DVec3 center;   ///< m, of mass
    Quat rotation;  ///< principal axes to world
    Vec3 v, w;      ///< m/s, rad/s
};
/// kg m²/s, about the centre of mass of the group; motionOf(body) tells of each.
template <class MotionOf>
Vec3 angularMomentum(const Bodies& bodies, std::span<const std::uint32_t> group, MotionOf&& motionOf) {
    // About the first body: float arms are short.
    const DVec3 origin = motionOf(group.front()).center;
    float mass = 0;
    Vec3 moment, momentum, angular;
    for (const std::uint32_t b : group) {
        const BodyRecord& body = bodies[b];
        const MovingPose motion = motionOf(b);
        const Vec3 r = toVec3(motion.center - origin), p = body.mass * motion.v;
        const Vec3 spin = scale(body.inertia, inverseRotate(motion.rotation, motion.w));
        mass += body.mass;
        moment += body.mass * r;
        momentum += p;
        angular += cross(r, p) + rotate(motion.rotation, spin);
    }
    return angular - (1 / mass) * cross(moment, momentum);
}

/// The motion that a group would have as one rigid body, and the energies of that and of the rest.
struct CommonMotion {
    DVec3 center;                 ///< m, of mass
    Vec3 v, w;                    ///< m/s of the centre, rad/s
    Vec3 momentum;                ///< kg m²/s, about the centre
    Factor3 inertia{};            ///< kg m², the same
    double rigid = 0, inner = 0;  ///< J
    double spinning = 0;          ///< J, of the first, about the centre
};
CommonMotion commonMotion(const Bodies& bodies, std::span<const std::uint32_t> group);

/// As far as its locks let it.
void setVelocity(Bodies& bodies, std::uint32_t body, const Vec3& v, const Vec3& w);
/// What springs lead the speeds of their bodies by is part of these; of those joints that are counted with a body.
void scaleLeads(const Bodies& bodies, Joints& joints, std::uint32_t body, float share);

/// Turns a group, as one body, to the angular momentum given.
void turnToMomentum(Bodies& bodies, std::span<const std::uint32_t> group, const Vec3& momentum);
/// What of a group stays as it is: both momenta, but the motion of the bodies against each other; how fast its centre
/// goes; nothing.
enum class Keeps : std::uint8_t { momenta, linearMomentum, nothing };
/// Takes so much energy (J) from all motion but what is kept. Tells how much there was to take.
double takeEnergy(Bodies& bodies, Joints& joints, std::span<const std::uint32_t> group, double energy, Keeps keeps);

}  // namespace ragtop
