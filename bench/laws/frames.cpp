#include "frames.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ragtop::laws {
namespace {

JointBodies& bodiesOf(SceneJoint& joint) {
    return std::visit([](auto& def) -> JointBodies& { return def.bodies; }, joint.def);
}

/// What joints hold to the world, held to a body instead: one that nothing touches, at the origin. Where none does, a
/// body more would be one that is left behind by those that it is compared with.
void giveTheWorldABody(Scene& scene) {
    const auto isHeld = [](const SceneJoint& joint) {
        return !joint.holdsPart() && (joint.bodyA == stability::kWorld || joint.bodyB == stability::kWorld);
    };
    if (std::ranges::none_of(scene.joints, isHeld)) return;
    BodyDef def = stability::fixedBody(Sphere{0.01f}, {}, {});
    def.shapes[0].filter.mask = 0;
    const int world = stability::add(scene, std::move(def));
    for (SceneJoint& joint : scene.joints) {
        if (joint.bodyA == stability::kWorld) joint.bodyA = world;
        if (joint.bodyB == stability::kWorld) joint.bodyB = world;
    }
}

template <int kSpeed>
Drawn moving(Drawn drawn) {
    giveTheWorldABody(drawn.scene);
    for (SceneBody& body : drawn.scene.bodies) {
        if (body.def.type == BodyType::fixed) body.def.type = BodyType::kinematic;
        body.def.linearVelocity += Vec3{0, 0, 0.1f * kSpeed};
    }
    for (Ride& ride : drawn.rides) ride.start += Vec3{0, 0, 0.1f * kSpeed};
    return drawn;
}

Drawn turned(Drawn drawn) {
    giveTheWorldABody(drawn.scene);
    const Quat turn = normalized(Quat{0, 0.5f, 0, 1});
    for (SceneBody& body : drawn.scene.bodies) {
        body.def.pose = {DVec3{rotate(turn, toVec3(body.def.pose.position))}, turn * body.def.pose.rotation};
        body.def.linearVelocity = rotate(turn, body.def.linearVelocity);
        body.def.angularVelocity = rotate(turn, body.def.angularVelocity);
    }
    for (SceneVehicle& car : drawn.scene.vehicles) {
        car.placement.position = DVec3{rotate(turn, toVec3(car.placement.position))};
        car.placement.heading += 0.9272952f;  // 2 atan(½)
    }
    for (LaidCar& car : drawn.laid) {
        car.pose = {DVec3{rotate(turn, toVec3(car.pose.position))}, turn * car.pose.rotation};
        car.v = rotate(turn, car.v), car.w = rotate(turn, car.w);
    }
    for (Ride& ride : drawn.rides)
        ride.start = rotate(turn, ride.start), ride.acceleration = rotate(turn, ride.acceleration);
    return drawn;
}

Drawn distant(Drawn drawn) {
    giveTheWorldABody(drawn.scene);
    for (SceneBody& body : drawn.scene.bodies) body.def.pose.position = body.def.pose.position + DVec3{8192, 0, -4096};
    for (SceneVehicle& car : drawn.scene.vehicles)
        car.placement.position = car.placement.position + DVec3{8192, 0, -4096};
    for (LaidCar& car : drawn.laid) car.pose.position = car.pose.position + DVec3{8192, 0, -4096};
    return drawn;
}

Shape scaled(const Shape& shape, float s) {
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return Sphere{s * sphere->radius};
    if (const auto* box = std::get_if<Box>(&shape)) return Box{s * box->halfExtents};
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return Capsule{s * capsule->radius, s * capsule->halfHeight};
    if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
        std::vector<Vec3> points(hull->vertices().begin(), hull->vertices().end());
        for (Vec3& point : points) point *= s;
        return ConvexHull{points};
    }
    return shape;
}

/// Gravity and densities as they are: lengths times 4 and times times 2; torques then times 4⁴.
constexpr float kLength = 4, kTime = 2, kTorque = 256;
Drawn larger(Drawn drawn) {
    for (SceneBody& body : drawn.scene.bodies) {
        for (ShapeDef& shape : body.def.shapes) shape.geometry = scaled(shape.geometry, kLength);
        body.def.pose.position = static_cast<double>(kLength) * body.def.pose.position;
        body.def.linearVelocity *= kLength / kTime;
        body.def.angularVelocity *= 1 / kTime;
    }
    for (SceneJoint& joint : drawn.scene.joints) {
        JointBodies& bodies = bodiesOf(joint);
        bodies.frameA.position *= kLength, bodies.frameB.position *= kLength;
        if (auto* ball = std::get_if<BallDef>(&joint.def)) {
            ball->friction *= kTorque;
            if (ball->spring) ball->spring->stiffness *= kTorque;
        }
    }
    for (Shaker& shaker : drawn.shakers) shaker.amplitude *= kLength, shaker.frequency /= kTime;
    for (Ride& ride : drawn.rides) ride.start *= kLength / kTime, ride.phase *= static_cast<double>(kTime);
    drawn.scene.step *= static_cast<double>(kTime);
    drawn.seconds *= static_cast<double>(kTime);
    return drawn;
}

/// Body 0, which others are compared with, stays the first.
Drawn reversed(Drawn drawn) {
    Scene& scene = drawn.scene;
    std::reverse(scene.bodies.begin() + 1, scene.bodies.end());
    const auto renamed = [count = static_cast<int>(scene.bodies.size())](int body) {
        return body <= 0 ? body : count - body;
    };
    for (SceneJoint& joint : scene.joints) joint.bodyA = renamed(joint.bodyA), joint.bodyB = renamed(joint.bodyB);
    std::ranges::reverse(scene.joints);
    std::ranges::reverse(scene.vehicles);
    std::ranges::reverse(drawn.laid);
    for (SceneJoint& joint : scene.joints)
        for (ScenePart* part : {&joint.partA, &joint.partB})
            if (*part) part->index = static_cast<int>(scene.vehicles.size()) - 1 - part->index;
    for (Shaker& shaker : drawn.shakers) shaker.body = renamed(shaker.body);
    for (Ride& ride : drawn.rides) ride.body = renamed(ride.body);
    return drawn;
}

}  // namespace

std::span<const Seen> allViews() {
    static const Seen kViews[] = {{"at 0.1 m/s", moving<1>, 1, false},
                                  {"at 10 m/s", moving<100>, 1, false},
                                  {"at 100 m/s", moving<1000>, 1, false},
                                  {"turned", turned},
                                  {"9 km away", distant},
                                  {"four times as large", larger, static_cast<double>(kLength), false},
                                  {"in reverse order", reversed}};
    return kViews;
}

}  // namespace ragtop::laws
