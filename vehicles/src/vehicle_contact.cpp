#include <algorithm>
#include <cmath>

#include "vehicle_sim.h"

/// Where a wheel meets what is under it, and how deep its tire is in it.
namespace ragtop {

/// Where the wheel meets its plane, on a tire that has its radius: with the hub at p at a compression x₀, and the
/// lowest point of the rim below it, (p + (x − x₀) a + lowest − point)·n = 0. a is how that point goes with x: as the
/// hub, and by what the axle tilts, but not turned about it, as the wheel rolls.
bool VehicleSim::placePatch(std::size_t i, const Pose& pose, const DVec3& center) {
    WheelPatch& patch = patches[i];
    const WheelState& wheel = wheels[i];
    const WheelSpec& spec = specs[i];
    if (wheel.ground.found == 0) return false;

    DVec3 point = wheel.ground.point;
    patch.normal = wheel.ground.normal;
    if (wheel.ground.moves != 0) movePlane(wheel.ground, world->pose(wheel.ground.body), point, patch.normal);
    const WheelLine& line = lines[i];
    const std::optional<Vec3> lowest = lowestPoint(patch.normal, patch.axle, spec.radius);
    if (!lowest) return false;
    patch.axis = rotate(pose.rotation, line.axis);
    Vec3 down = *lowest;
    if (spec.linkage >= 0) {
        const Vec3 tilted = cross(rotate(pose.rotation, line.tilting), *lowest);
        patch.axis += tilted;
        down -= wheel.compression * tilted;
    }
    patch.slant = dot(patch.axis, patch.normal);
    if (!(patch.slant > kSteepest)) return false;
    const DVec3 below = transformPoint(pose, line.base) + down;
    patch.rise = -dot(relative(below, point), patch.normal) / patch.slant;
    patch.point = below + patch.rise * patch.axis;
    patch.arm = relative(patch.point, center);
    patch.forward = normalized(cross(patch.axle, patch.normal));
    patch.side = cross(patch.normal, patch.forward);
    return true;
}

/// The tire is squashed by what the strut does not yield. Only motion may squash it, because the spring is at nothing's
/// cost otherwise: what of it is more than at the beginning of the last substep and than the wheel has come since,
/// along the ground's normal or on to where that may rise by as much, counts as lower ground, and the wheel is lifted
/// out of it slowly. It happens where a wheel turns to ground that it could not touch, as of a car that rolls off its
/// side, where it leaves one body for another that it is deep in already, and where ground comes up by itself.
bool VehicleSim::sinkGround(std::size_t i, const PointBody& body, float h) {
    WheelPatch& patch = patches[i];
    WheelState& wheel = wheels[i];
    const StrutSpec& strut = specs[i].strut;
    takeGround(i, body);
    if (wheel.isPut() && !hasCarriers()) wheel.compression = clampTo(patch.rise, strut.travelLeast, strut.travelUp);
    patch.squash = patch.slant * (patch.rise - wheel.compression) + strut.tireSquash;
    const float deepest = std::max(patch.squash, 0.0f);
    if (wheel.isPut()) {
        wheel.sunk = std::max(deepest - strut.tireSquash, 0.0f);
    } else {
        const float lifted = std::max(wheel.sunk - h * kLiftSpeed, 0.0f);
        // A course over what stays sees to that itself, as steep edges are climbed.
        const bool led = wheel.touching != 0 && wheel.ground.moves == 0 && def.level >= VehicleLevel::full;
        const float beyond = led ? 0 : deepest - wheel.squash - comeDown(i, body, h);
        wheel.sunk = std::min(std::max(lifted, beyond), deepest);
    }
    patch.squash -= wheel.sunk;
    // One that comes to the ground within h is met there: found in it afterwards it would have fallen for nothing.
    return patch.squash > 0 || (wheel.ground.moves == 0 && patch.squash > -closing(i, body, h));
}

/// m by which a wheel comes to its ground in h, as it goes.
float VehicleSim::closing(std::size_t i, const PointBody& body, float h) const {
    const WheelPatch& patch = patches[i];
    const WheelState& wheel = wheels[i];
    const bool swings = hasCarriers() || wheel.touching != 0;
    const float way = swings ? h * wheel.hubSpeed : fallOfWheel(specs[i].strut, wheel.compression, h);
    return std::max(-patch.slant * way - h * speedAlong(patch.normalRow, body, *patch.ground), 0.0f);
}

/// m by which a wheel may have come deeper into its ground in h.
float VehicleSim::comeDown(std::size_t i, const PointBody& body, float h) const {
    const WheelPatch& patch = patches[i];
    const float come = closing(i, body, h);
    if (wheels[i].touching == 0) return come;
    const Vec2 along{speedAlong(patch.forwardRow, body, *patch.ground), speedAlong(patch.sideRow, body, *patch.ground)};
    return come + h * std::sqrt(along.x * along.x + along.y * along.y) + kThrown * specs[i].strut.tireSquash;
}

void VehicleSim::takeGround(std::size_t i, const PointBody& body) {
    WheelPatch& patch = patches[i];
    const GroundPlane& plane = wheels[i].ground;
    GroundBody& ground = grounds[groundOfWheel[i]];
    patch.ground = &ground.body;
    const auto take = [&](const auto& rowAlong) {
        patch.normalRow = rowAlong(patch.normal);
        patch.forwardRow = rowAlong(patch.forward);
        patch.sideRow = rowAlong(patch.side);
    };
    if (plane.moves == 0)
        return take([&](const Vec3& along) { return rowOf(along, body, patch.arm, plane.surfaceVelocity); });
    const Vec3 groundArm = relative(patch.point, ground.center);
    take([&](const Vec3& along) {
        return rowOf(along, body, patch.arm, ground.body, groundArm, plane.surfaceVelocity);
    });
}

}  // namespace ragtop
