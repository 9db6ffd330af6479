#pragma once

#include <cstdint>
#include <span>

#include "base/aligned_array.h"
#include "ragtop/math.h"

/// What moves on its own, whatever it meets, gives energy: kinematic bodies, belts, motors and targets of springs. By
/// contacts it is no more than impulse times speed, by a motor with a bound no more than that times the way that it
/// goes ahead. By joints it is, seen from what moves evenly, with v and ω about a place, none at all, so that in the
/// world it is what it hands on, ΔE = v · J + ω · H, with the impulses J = Δp − m a dt and H = ΔL − τ dt, at most
///   ΔE ≤ Σ (|v| + |ω| |r|) m (|v₀| + |v₁| + |a| dt) + |ω| (|I ω₀| + |I ω₁| + |τ| dt)
/// over the bodies that hang together, with r from that place and the speeds before and after. What a caller has put
/// apart counts as if it were drawn together by a drive, in one step.
namespace ragtop {

struct ContactRecord;
struct GuardView;
struct JointSim;

/// What drives by joints.
struct EnergyDriver {
    DVec3 center;     ///< m, about which it turns
    float speed = 0;  ///< m/s
    float turn = 0;   ///< rad/s
};

/// May a joint give energy of its own: has it a motor, a spring, an end that a caller put apart or a kinematic body?
bool mayDrive(const GuardView& view, std::uint32_t joint);
/// Lists what drives a body in a group by its joints; J, that motors with a bound give it in this step at most.
double addDrivers(const GuardView& view, std::uint32_t body, AlignedArray<EnergyDriver>& drivers);
/// J, of surfaces that move on their own.
double workOfContact(const GuardView& view, const ContactRecord& contact, std::uint32_t body, std::uint32_t other);
/// Has a hinge or slider a motor with a bound? Those of joints of more axes are allowed it times their target speed.
bool hasBoundedMotor(const JointSim& sim);
/// J, the most that motors with a bound, of hinges and sliders, can have given a group, or a body alone, in this step.
double workOfMotors(const GuardView& view, std::span<const std::uint32_t> group);
/// J, the most that drivers can have given such bodies in this step.
double drivenEnergy(const GuardView& view, std::span<const std::uint32_t> bodies,
                    std::span<const EnergyDriver> drivers);

/// J, that forces give in a step to bodies at rest which nothing holds.
double givenAtOnce(const GuardView& view, std::span<const std::uint32_t> bodies);

}  // namespace ragtop
