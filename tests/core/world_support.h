#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/world.h"

/// Worlds and bodies that many tests begin with.
namespace ragtop::test {

inline constexpr double kDt = 1.0 / 60;
inline constexpr float kGravity = 9.81f;
inline constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
/// Frames whose axis is z.
inline const Quat kAboutZ = rotationBetween({1, 0, 0}, {0, 0, 1});

/// For messages of tests that run with several solvers.
inline std::string_view nameOf(SolverChoice choice) { return enumNames(choice)[static_cast<std::size_t>(choice)]; }

inline Material surface(float friction, float restitution = 0, float rollingResistance = 0) {
    Material material;
    material.friction = friction;
    material.restitution = restitution;
    material.rollingResistance = rollingResistance;
    return material;
}

inline ShapeDef shapeDef(Shape geometry, const Material& material = {}) {
    ShapeDef def;
    def.geometry = std::move(geometry);
    def.material = material;
    return def;
}

inline BodyDef bodyDef(Shape geometry, const DVec3& position, const Material& material = {},
                       BodyType type = BodyType::dynamic) {
    BodyDef def;
    def.type = type;
    def.shapes.push_back(shapeDef(std::move(geometry), material));
    def.pose.position = position;
    return def;
}

/// A slab whose top is the plane y = 0.
inline BodyId addFloor(World& world, const Material& material = {}, const DVec3& center = {}) {
    return world.create(bodyDef(Box{{100, 1, 100}}, center + DVec3{0, -1, 0}, material, BodyType::fixed));
}

inline WorldSettings withoutGravity() {
    WorldSettings settings;
    settings.gravity = {};
    return settings;
}

inline WorldSettings withoutSleep() {
    WorldSettings settings;
    settings.sleeping = false;
    return settings;
}

inline double asDouble(float a) { return static_cast<double>(a); }

inline int stepsIn(double seconds, double dt = kDt) { return static_cast<int>(std::lround(seconds / dt)); }

/// Fails with the first fact about the world's own tables that does not hold.
inline bool isSound(const World& world) {
    const std::string broken = world.validate();
    EXPECT_EQ(broken, "");
    return broken.empty();
}

inline void run(World& world, double seconds, double dt = kDt) {
    for (int i = 0; i < stepsIn(seconds, dt); ++i) {
        world.step(dt);
        if (!isSound(world)) return;
    }
}

/// Steps, calling `each` after every one.
template <class Each>
void run(World& world, double seconds, double dt, Each&& each) {
    for (int i = 0; i < stepsIn(seconds, dt); ++i) {
        world.step(dt);
        each();
    }
}

/// A second from now, and the same second again from what was saved: the same bits.
inline void expectRestoredGoesOn(World& world) {
    std::vector<std::byte> state(world.saveSize());
    world.save(state);
    run(world, 1);
    const std::uint64_t expected = world.hash();
    world.restore(state);
    run(world, 1);
    EXPECT_EQ(world.hash(), expected);
}

inline double height(const World& world, BodyId body) { return world.pose(body).position.y; }

/// About the centre of mass, world axes, kg m²/s.
inline Vec3 angularMomentum(const World& world, BodyId body) {
    const Quat q = world.pose(body).rotation;
    return rotate(q, world.mass(body).inertia * inverseRotate(q, world.angularVelocity(body)));
}

/// J, ½ m v² + ½ ω · I ω.
inline double kineticEnergy(const World& world, BodyId body) {
    const MassProperties mass = world.mass(body);
    const Vec3 v = world.linearVelocity(body),
               w = inverseRotate(world.pose(body).rotation, world.angularVelocity(body));
    return 0.5 * asDouble(mass.mass * dot(v, v) + dot(w, mass.inertia * w));
}

/// J, of motion and of height.
inline double energyOf(const World& world, BodyId body) {
    return kineticEnergy(world, body) + asDouble(world.mass(body).mass * kGravity) * world.centerOfMass(body).y;
}

inline double distanceBetween(const DVec3& a, const DVec3& b) {
    const DVec3 d = a - b;
    return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

template <class Action>
void expectMessage(Action&& action, const std::string& part) {
    try {
        action();
        ADD_FAILURE() << "nothing was thrown, expected: " << part;
    } catch (const std::exception& error) {
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

}  // namespace ragtop::test
