#include "scenery.h"

#include <cmath>
#include <utility>

namespace ragtop::stability {

Material surface(float friction, float restitution) {
    Material material;
    material.friction = friction;
    material.restitution = restitution;
    return material;
}

int add(Scene& scene, BodyDef def) {
    SceneBody body;
    body.def = std::move(def);
    scene.bodies.push_back(std::move(body));
    return static_cast<int>(scene.bodies.size()) - 1;
}

BodyDef fixedBody(Shape shape, const DVec3& position, const Material& material) {
    BodyDef def;
    def.type = BodyType::fixed;
    def.shapes.push_back({.geometry = std::move(shape), .material = material});
    def.pose.position = position;
    return def;
}

BodyDef solidBody(Shape shape, const DVec3& position, float mass, const Material& material) {
    BodyDef def;
    const float density = mass / ragtop::massOf(shape, 1).mass;
    def.shapes.push_back({.geometry = std::move(shape), .density = density, .material = material});
    def.pose.position = position;
    return def;
}

BodyDef bodyWithMass(Shape shape, const DVec3& position, float mass, const Vec3& moments, const Material& material) {
    BodyDef def;
    def.shapes.push_back({.geometry = std::move(shape), .material = material});
    def.pose.position = position;
    def.mass = MassProperties{mass, {}, {{moments.x, 0, 0}, {0, moments.y, 0}, {0, 0, moments.z}}};
    return def;
}

int addFloor(Scene& scene, const Material& material, const DVec3& at) {
    return add(scene, fixedBody(Box{{100, 1, 100}}, at + DVec3{0, -1, 0}, material));
}

Pose Slope::pose() const {
    const DVec3 normal{std::sin(theta) * std::cos(heading), std::cos(theta), std::sin(theta) * std::sin(heading)};
    return {at, rotationBetween({0, 1, 0}, toVec3(normal))};
}

DVec3 Slope::down() const {
    return {std::cos(theta) * std::cos(heading), -std::sin(theta), std::cos(theta) * std::sin(heading)};
}

BodyDef onSlope(const Slope& slope, BodyDef def) {
    const Pose pose = slope.pose();
    def.pose = {transformPoint(pose, toVec3(def.pose.position)), pose.rotation * def.pose.rotation};
    return def;
}

int addSlope(Scene& scene, const Slope& slope, const Material& material) {
    return add(scene, onSlope(slope, fixedBody(Box{{100, 1, 100}}, {0, -1, 0}, material)));
}

JointBodies jointFrames(const Scene& scene, int a, int b, const DVec3& point, const Vec3& axis) {
    const Pose joint{point, rotationBetween({1, 0, 0}, normalized(axis))};
    const auto seenFrom = [&](int body) {
        const Pose pose = body == kWorld ? Pose{} : scene.bodies[static_cast<std::size_t>(body)].def.pose;
        return relative(pose, joint);
    };
    JointBodies bodies;
    bodies.frameA = seenFrom(a);
    bodies.frameB = seenFrom(b);
    return bodies;
}

namespace {

template <class Def>
Def& addJoint(Scene& scene, int a, int b, const JointBodies& frames) {
    Def def;
    def.bodies = frames;
    scene.joints.push_back({{}, a, b, def});
    return std::get<Def>(scene.joints.back().def);
}

}  // namespace

void addBall(Scene& scene, int a, int b, const DVec3& point) {
    addJoint<BallDef>(scene, a, b, jointFrames(scene, a, b, point));
}

HingeDef& addHinge(Scene& scene, int a, int b, const DVec3& point, const Vec3& axis) {
    return addJoint<HingeDef>(scene, a, b, jointFrames(scene, a, b, point, axis));
}

SliderDef& addSlider(Scene& scene, int a, int b, const DVec3& point, const Vec3& axis) {
    return addJoint<SliderDef>(scene, a, b, jointFrames(scene, a, b, point, axis));
}

DistanceDef& addDistance(Scene& scene, int a, int b, const DVec3& pointA, const DVec3& pointB) {
    JointBodies frames = jointFrames(scene, a, b, pointA);
    frames.frameB = jointFrames(scene, a, b, pointB).frameB;
    return addJoint<DistanceDef>(scene, a, b, frames);
}

MassProperties massOf(const BodyDef& def) {
    if (def.mass) return *def.mass;
    std::vector<MassProperties> parts;
    for (const ShapeDef& shape : def.shapes)
        parts.push_back(transformed(ragtop::massOf(shape.geometry, shape.density), shape.frame));
    return combined(parts);
}

DVec3 jitter(Dice& dice, float largest) {
    const float x = largest * dice.between(-1, 1), z = largest * dice.between(-1, 1);
    return DVec3{Vec3{x, 0, z}};
}

}  // namespace ragtop::stability
