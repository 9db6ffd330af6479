#include "vehicle_sim.h"

/// What presses wheels along their struts besides springs, dampers and tires: bars, pads, the other wheel of a beam.
namespace ragtop {

/// By where the wheel at its other end has come in this visit.
BarPull VehicleSim::barOf(std::size_t i) const {
    const float stiffness = specs[i].barStiffness;
    const std::size_t other = specs[i].barPartner;
    return {stiffness * (wheels[i].compression - wheels[other].compression - patches[other].way), stiffness};
}

/// And by what its brake does to what carries the wheel, and what grips at the other end of its beam.
BarPull VehicleSim::pullOn(std::size_t i, const PointBody& body, float h) const {
    BarPull pull = barOf(i);
    if (hasCarriers()) addInertia(i, body, h, pull);
    if (specs[i].linkage < 0) return pull;
    pull.force += lines[i].spinRate * drivetrain.padImpulse(i) / h;
    addHeldSpin(i, h, pull);
    const std::size_t other = specs[i].beamPartner;
    if (other == i) return pull;
    const WheelPatch& patch = patches[other];
    pull.force += lines[i].spinRate * drivetrain.padImpulse(other) / h;
    pull.force -= (patch.cross.x * patch.tire.x + patch.cross.y * patch.tire.y + patch.crossSlant * patch.load) / h;
    return pull;
}

/// Where pads hold wheels, these turn with what carries them: I (σ p)² against u̇.
void VehicleSim::addHeldSpin(std::size_t i, float h, BarPull& pull) const {
    const auto add = [&](std::size_t wheel) {
        if (!patches[wheel].held) return;
        const float turn = lines[i].spinRate * drivetrain.padShare(wheel);
        const float inertia = drivetrain.inertia()[wheel] * turn * turn / (h * h);
        pull.force -= inertia * patches[i].way;
        pull.stiffness += inertia;
    };
    add(i);
    if (specs[i].beamPartner != i) add(specs[i].beamPartner);
}

/// What carries the pads of a wheel turns as its spring goes, and as that of its beam's other wheel does.
void VehicleSim::carryPads(std::size_t i, float h) {
    if (specs[i].linkage < 0) return;
    const auto turning = [&](std::size_t wheel) { return lines[wheel].spinRate * patches[wheel].way / h; };
    const std::size_t other = specs[i].beamPartner;
    drivetrain.carryPads(i, other == i ? turning(i) : turning(i) + turning(other));
}

/// Has the brake hold the wheel on its pads, its tire having taken so much more, N m s.
bool VehicleSim::holdOnPads(std::size_t i, float h, float taken) {
    carryPads(i, h);
    return drivetrain.mayHold(i) && drivetrain.hold(i, taken);
}

/// How the contact goes as the other wheel of its beam rises.
void VehicleSim::takeCross(std::size_t i, const Pose& pose) {
    WheelPatch& patch = patches[i];
    const Vec3 down = *lowestPoint(patch.normal, patch.axle, specs[i].radius);
    const Vec3 way =
        rotate(pose.rotation, lines[i].crossAxis) + cross(rotate(pose.rotation, lines[i].crossTilting), down);
    patch.cross = {dot(patch.forward, way), dot(patch.side, way)};
    patch.crossSlant = dot(patch.normal, way);
}

}  // namespace ragtop
