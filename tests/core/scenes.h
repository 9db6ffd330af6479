#pragma once

#include <cstdint>
#include <vector>

#include "ragtop/world.h"

/// Scenes built in code, the same bits on every platform: sizes are short binary fractions or products of them, and no
/// function of the C library takes part. Tests and benchmarks share them.
namespace ragtop::scenes {

/// A scene in other units: with gravity and densities as they are, lengths times s² and times times s give the same
/// motion; masses are then s⁶ times as large. Powers of two scale without rounding.
struct Scale {
    float s = 1;
    float length(float a) const { return s * s * a; }
    Vec3 length(const Vec3& a) const { return s * s * a; }
    DVec3 position(double x, double y, double z) const { return double{s} * s * DVec3{x, y, z}; }
    float time(float a) const { return s * a; }
    Vec3 velocity(const Vec3& a) const { return s * a; }
    Vec3 spin(const Vec3& a) const { return (1 / s) * a; }
    float perTime(float a) const { return a / s; }
    float mass(float a) const { return s * s * s * s * s * s * a; }
    float force(float a) const { return mass(a); }
    float torque(float a) const { return s * s * mass(a); }
    Spring linear(float stiffness, float damping) const { return {mass(stiffness) / (s * s), mass(damping) / s}; }
    Spring angular(float stiffness, float damping) const { return {s * s * mass(stiffness), s * s * s * mass(damping)}; }
};

/// Whole numbers without a pattern [O'Neill, PCG, 2014], in place of random ones.
class Dice {
public:
    explicit Dice(std::uint64_t seed = 1) : state_(seed * 2862933555777941757u + 3037000493u) {}
    std::uint32_t below(std::uint32_t n) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::uint32_t>(state_ >> 33) % n;
    }
    /// A multiple of 1/64 in [from, to).
    float between(float from, float to) {
        return from + static_cast<float>(below(static_cast<std::uint32_t>((to - from) * 64))) / 64;
    }
    Quat rotation() {
        return normalized(Quat{between(-1, 1), between(-1, 1), between(-1, 1), between(0.25f, 1)});
    }

private:
    std::uint64_t state_;
};

inline BodyId addFloor(World& world, const Scale& scale = {}, float half = 64) {
    return world.create(StaticBody{.shape = Box{scale.length(Vec3{half, 1, half})}, .position = scale.position(0, -1, 0)});
}

inline BodyId addBox(World& world, const Scale& scale, const Vec3& half, double x, double y, double z) {
    return world.create(DynamicBody{.shape = Box{scale.length(half)}, .position = scale.position(x, y, z)});
}

/// Boxes of 1 m on top of each other.
inline void addTower(World& world, const Scale& scale = {}, int boxes = 12) {
    addFloor(world, scale);
    for (int i = 0; i < boxes; ++i) addBox(world, scale, {0.5f, 0.5f, 0.5f}, i % 2 == 0 ? 0.0 : 0.03125, 0.5 + i, 0);
}

/// Bricks in bond, columns × rows, resting.
inline void addBricks(World& world, const Scale& scale, int columns, int rows, double z) {
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < columns; ++i)
            addBox(world, scale, {0.5f, 0.25f, 0.25f}, (i - columns / 2) * 1.03125 + (row % 2) * 0.5, 0.25 + row * 0.5, z);
}

/// A brick wall and a ball that flies into it.
inline void addWallAndBall(World& world, const Scale& scale = {}) {
    addFloor(world, scale);
    addBricks(world, scale, 8, 8, 0);
    world.create(DynamicBody{.shape = Sphere{scale.length(0.5f)},
                             .density = 4000,
                             .position = scale.position(0.25, 1.5, 6),
                             .linearVelocity = scale.velocity({0, 1, -24})});
}

/// Bricks in a square pyramid.
inline void addPyramid(World& world, const Scale& scale = {}, int base = 12) {
    addFloor(world, scale);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            for (int j = 0; j < base - row; ++j)
                addBox(world, scale, {0.5f, 0.5f, 0.5f}, (i + 0.5 * row) * 1.0625, 0.5 + row, (j + 0.5 * row) * 1.0625);
}

/// Storeys of four pillars, two beams and a slab.
inline void addHouse(World& world, const Scale& scale = {}, int storeys = 3, double x = 0, bool floor = true) {
    if (floor) addFloor(world, scale);
    for (int i = 0; i < storeys; ++i) {
        const double y = 2.75 * i;
        for (const double px : {-1.5, 1.5})
            for (const double pz : {-1.5, 1.5}) addBox(world, scale, {0.25f, 1, 0.25f}, x + px, y + 1, pz);
        for (const double px : {-1.5, 1.5}) addBox(world, scale, {0.25f, 0.25f, 2}, x + px, y + 2.25, 0);
        addBox(world, scale, {2, 0.125f, 2}, x, y + 2.625, 0);
    }
}

/// Hills as a height field, 24 × 24 m about the origin.
inline void addHills(World& world, const Scale& scale = {}) {
    constexpr int kSamples = 25;
    std::vector<float> heights;
    Dice dice(7);
    for (int row = 0; row < kSamples; ++row)
        for (int column = 0; column < kSamples; ++column) {
            const float dx = static_cast<float>(column - 12), dz = static_cast<float>(row - 12);
            heights.push_back(scale.length((dx * dx + dz * dz) / 64 + dice.between(0, 0.5f)));
        }
    world.create(StaticBody{.shape = HeightField{kSamples, kSamples, scale.length(1), heights},
                            .position = scale.position(-12, -1, -12)});
}

/// A bowl as a triangle mesh, 24 × 24 m about the origin.
inline void addBowl(World& world, const Scale& scale = {}) {
    constexpr std::uint32_t kSide = 13;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t row = 0; row < kSide; ++row)
        for (std::uint32_t column = 0; column < kSide; ++column) {
            const float x = 2 * static_cast<float>(column) - 12, z = 2 * static_cast<float>(row) - 12;
            vertices.push_back(scale.length(Vec3{x, (x * x + z * z) / 32 - 1, z}));
        }
    for (std::uint32_t row = 0; row + 1 < kSide; ++row)
        for (std::uint32_t column = 0; column + 1 < kSide; ++column) {
            const std::uint32_t a = row * kSide + column, b = a + 1, c = a + kSide, d = c + 1;
            triangles.push_back({a, c, b});
            triangles.push_back({b, c, d});
        }
    world.create(StaticBody{.shape = TriangleMesh{vertices, triangles}});
}

/// Spheres, capsules and boxes above the ground, and hulls when there are corners for them; of all sizes and materials.
inline void addMixedShapes(World& world, const Scale& scale, int count, const ConvexHull* hull = nullptr) {
    Dice dice(3);
    for (int i = 0; i < count; ++i) {
        DynamicBody body;
        const float size = dice.between(0.25f, 0.5f);
        switch (i % (hull ? 4 : 3)) {
        case 0: body.shape = Sphere{scale.length(size)}; break;
        case 1: body.shape = Capsule{scale.length(0.75f * size), scale.length(dice.between(0.25f, 0.75f))}; break;
        case 2: body.shape = Box{scale.length(Vec3{size, dice.between(0.25f, 0.5f), dice.between(0.25f, 0.5f)})}; break;
        default: body.shape = *hull;
        }
        // Braces, because the arguments of a call may be evaluated in any order.
        const Vec3 aside{dice.between(0, 0.25f), 0, dice.between(0, 0.25f)};
        body.position = scale.position(1.25 * (i % 5 - 2), 2 + 1.125 * (i / 25), 1.25 * (i / 5 % 5 - 2)) + scale.length(aside);
        body.rotation = dice.rotation();
        body.linearVelocity = scale.velocity({dice.between(-1, 1), dice.between(-2, 0), dice.between(-1, 1)});
        body.angularVelocity = scale.spin({dice.between(-4, 4), dice.between(-4, 4), dice.between(-4, 4)});
        body.material.friction = dice.between(0.25f, 1);
        body.material.restitution = i % 7 == 0 ? 0.5f : 0.0f;
        body.material.rollingResistance = i % 3 == 0 ? scale.length(0.03125f) : 0.0f;
        world.create(body);
    }
}

/// A chain of capsules on ball joints, from a point in the air, with a heavy box at its end.
inline void addChain(World& world, const Scale& scale = {}, int links = 12) {
    BodyId previous;
    for (int i = 0; i <= links; ++i) {
        const bool last = i == links;
        const BodyId link = world.create(DynamicBody{
            .shape = last ? Shape{Box{scale.length(Vec3{0.5f, 0.5f, 0.5f})}}
                          : Shape{Capsule{scale.length(0.125f), scale.length(0.25f)}},
            .position = scale.position(0.5 * i + 0.25, 8, 0),
            .rotation = normalized(Quat{0, 0, -1, 1})});
        BallDef ball;
        ball.bodies.a = previous;
        ball.bodies.b = link;
        ball.bodies.frameA.position = previous.isNull() ? scale.length(Vec3{0, 8, 0}) : scale.length(Vec3{0, 0.25f, 0});
        ball.bodies.frameB.position = scale.length(Vec3{0, -0.25f, 0});
        // The world's frame is turned as the first link is, so that the joint's zero is the straight chain.
        if (previous.isNull()) ball.bodies.frameA.rotation = normalized(Quat{0, 0, -1, 1});
        if (i % 3 == 1) ball.swingLimit = 1.0f;
        if (i % 3 == 2) ball.twistLimit = Range{-0.5f, 0.5f};
        ball.friction = scale.torque(0.25f);
        world.create(ball);
        previous = link;
    }
}

/// A bare link at half a length from `above`; it collides with nothing.
inline BodyId hangLink(World& world, const Scale& scale, BodyId above, double x, double z, bool heavy, bool hinge) {
    BodyDef def;
    ShapeDef shape;
    shape.geometry =
        heavy ? Shape{Sphere{scale.length(0.25f)}} : Shape{Capsule{scale.length(0.0625f), scale.length(0.125f)}};
    shape.density = heavy ? 64000 : 1000;
    shape.filter.mask = 0;
    def.shapes.push_back(shape);
    def.pose = {scale.position(x, 8, z), normalized(Quat{0, 0, -1, 1})};
    const BodyId link = world.create(def);
    JointBodies joined{.a = above, .b = link};
    const Vec3 end = scale.length(Vec3{0, 0.25f, 0});
    joined.frameA.position = above.isNull() ? toVec3(scale.position(x - 0.25, 8, z)) : end;
    if (above.isNull()) joined.frameA.rotation = normalized(Quat{0, 0, -1, 1});
    joined.frameB.position = -end;
    if (hinge)
        world.create(HingeDef{.bodies = joined});
    else
        world.create(BallDef{.bodies = joined});
    return link;
}

/// Trees of bare joints, heavy at their ends: chains of two lengths, one of them of hinges, and one that forks.
inline void addChains(World& world, const Scale& scale = {}) {
    for (int chain = 0; chain < 7; ++chain) {
        const int links = chain % 3 == 2 ? 9 : 6;
        BodyId above;
        for (int i = 0; i <= links; ++i) {
            above = hangLink(world, scale, above, 0.5 * i + 0.25, 2.0 * chain, i == links, chain == 5);
            if (chain == 6 && i == 3) hangLink(world, scale, above, 0.5 * i + 0.75, 2.0 * chain, true, false);
        }
    }
}

/// A figure of a torso and four limbs: cones, a hinge with limits, springs to a pose, friction.
inline void addFigure(World& world, const Scale& scale, double x, double y) {
    const BodyId torso = addBox(world, scale, {0.25f, 0.5f, 0.125f}, x, y, 0);
    for (int i = 0; i < 4; ++i) {
        const float side = i % 2 == 0 ? -1.0f : 1.0f, end = i < 2 ? 0.5f : -0.5f;
        const double limbX = x + 0.375 * static_cast<double>(side), limbY = y + static_cast<double>(end) - 0.375;
        const BodyId upper = world.create(DynamicBody{.shape = Capsule{scale.length(0.0625f), scale.length(0.25f)},
                                                      .position = scale.position(limbX, limbY, 0)});
        const BodyId lower = world.create(DynamicBody{.shape = Capsule{scale.length(0.0625f), scale.length(0.25f)},
                                                      .position = scale.position(limbX, limbY - 0.75, 0)});
        BallDef shoulder;
        shoulder.bodies.a = torso;
        shoulder.bodies.b = upper;
        shoulder.bodies.frameA.position = scale.length(Vec3{0.375f * side, end, 0});
        shoulder.bodies.frameB.position = scale.length(Vec3{0, 0.375f, 0});
        shoulder.swingLimit = 1.25f;
        shoulder.twistLimit = Range{-1, 1};
        shoulder.spring = scale.angular(20, 2);
        shoulder.maxSpringTorque = scale.torque(16);
        world.create(shoulder);
        HingeDef elbow;
        elbow.bodies.a = upper;
        elbow.bodies.b = lower;
        elbow.bodies.frameA.position = scale.length(Vec3{0, -0.375f, 0});
        elbow.bodies.frameB.position = scale.length(Vec3{0, 0.375f, 0});
        elbow.limit = Range{0, 2};
        elbow.friction = scale.torque(0.5f);
        world.create(elbow);
    }
}

/// One of each joint at work: a motor, a lift on a spring, a rope, a weld.
inline void addMachines(World& world, const Scale& scale = {}) {
    const BodyId rotor = addBox(world, scale, {1, 0.125f, 0.125f}, -6, 4, 0);
    HingeDef hinge;
    hinge.bodies.b = rotor;
    hinge.bodies.frameA = {scale.length(Vec3{-6, 4, 0}), normalized(Quat{0, 1, 0, 1})};
    hinge.bodies.frameB.rotation = hinge.bodies.frameA.rotation;
    hinge.motor = Motor{scale.perTime(6), scale.torque(500)};
    world.create(hinge);

    const BodyId lift = addBox(world, scale, {0.5f, 0.25f, 0.5f}, -9, 3, 0);
    SliderDef slider;
    slider.bodies.b = lift;
    slider.bodies.frameA = {scale.length(Vec3{-9, 3, 0}), normalized(Quat{0, 0, 1, 1})};
    slider.bodies.frameB.rotation = slider.bodies.frameA.rotation;
    slider.limit = Range{scale.length(-1), scale.length(1)};
    slider.spring = scale.linear(20000, 200);
    slider.friction = scale.force(64);
    world.create(slider);

    const BodyId bob = addBox(world, scale, {0.25f, 0.25f, 0.25f}, -6, 1, 2);
    DistanceDef rope;
    rope.bodies.a = rotor;
    rope.bodies.b = bob;
    rope.bodies.frameA.position = scale.length(Vec3{1, 0, 0});
    rope.limit = Range{0, scale.length(4)};
    world.create(rope);

    const BodyId stick = addBox(world, scale, {0.125f, 0.5f, 0.125f}, -9, 3.75, 0);
    FixedDef weld;
    weld.bodies.a = lift;
    weld.bodies.b = stick;
    weld.bodies.frameA.position = scale.length(Vec3{0, 0.25f, 0});
    weld.bodies.frameB.position = scale.length(Vec3{0, -0.5f, 0});
    world.create(weld);
}

inline void addJoints(World& world, const Scale& scale = {}) {
    addFloor(world, scale);
    addChain(world, scale);
    for (int i = 0; i < 3; ++i) addFigure(world, scale, 8 + 2 * i, 2 + 0.5 * i);
    addMachines(world, scale);
}

/// Bodies that spin many times per step, in the air and onto the floor; one has locks, one is thrown through a wall.
inline void addSpinners(World& world, const Scale& scale = {}) {
    addFloor(world, scale);
    const Vec3 halves[3] = {{1, 0.25f, 0.125f}, {0.125f, 0.5f, 0.5f}, {0.5f, 0.125f, 0.25f}};
    const Vec3 spins[3] = {{0.125f, 40, 0.25f}, {200, 0, 3}, {64, 64, -32}};
    for (int i = 0; i < 3; ++i) {
        BodyDef def;
        def.shapes.push_back({.geometry = Box{scale.length(halves[i])}});
        def.pose.position = scale.position(4 * i, 6, 0);
        def.angularVelocity = scale.spin(spins[i]);
        def.angularDamping = i == 2 ? scale.perTime(0.5f) : 0.0f;
        def.gravityScale = i == 0 ? 0.0f : 1.0f;
        def.locks.rotationX = def.locks.translationZ = i == 2;
        world.create(def);
    }
    world.create(StaticBody{.shape = Box{scale.length(Vec3{0.0625f, 2, 2})}, .position = scale.position(-8, 2, 0)});
    world.create(DynamicBody{.shape = Sphere{scale.length(0.125f)},
                             .position = scale.position(-16, 2, 0),
                             .linearVelocity = scale.velocity({200, 1, 0}),
                             .angularVelocity = scale.spin({0, 0, 100})});
    BodyDef paddle;
    paddle.type = BodyType::kinematic;
    paddle.shapes.push_back({.geometry = Box{scale.length(Vec3{2, 0.25f, 0.5f})}});
    paddle.pose.position = scale.position(6, 0.5, 0);
    paddle.angularVelocity = scale.spin({0, 3, 0});
    world.create(paddle);
}

/// What happens to a scene while it runs, before the step whose number world.stepCount() gives: bodies come, go, are
/// moved and pushed; things that fell asleep are struck.
inline void disturb(World& world, const Scale& scale = {}) {
    const std::uint64_t step = world.stepCount();
    if (step % 16 == 5) {
        const auto i = static_cast<float>(step / 16 % 5);
        world.create(DynamicBody{.shape = Sphere{scale.length(0.375f)},
                                 .position = scale.position(static_cast<double>(i) - 2, 9, 0.25),
                                 .linearVelocity = scale.velocity({0, -2, 0.5f * i})});
    }
    // The last body is the youngest only as long as no index is used again, which is part of the test.
    if (step % 48 == 31) world.destroy(world.bodies().back());
    if (step % 64 == 40) {
        const BodyId body = world.bodies()[world.bodies().size() / 2];
        if (world.type(body) == BodyType::dynamic)
            world.applyImpulse(body, scale.s * world.mass(body).mass * Vec3{1, 3, 0}, world.centerOfMass(body));
    }
}

/// A scene with what happens to it.
struct Scenario {
    const char* name;
    void (*build)(World& world, const Scale& scale);
    bool disturbed;
    int steps;
};

inline constexpr float kStep = 1.0f / 64;

/// All that hold no hull: building one takes Qhull, which not every build has.
inline constexpr Scenario kScenarios[] = {
    {"tower", [](World& world, const Scale& scale) { addTower(world, scale); }, false, 300},
    {"wall", [](World& world, const Scale& scale) { addWallAndBall(world, scale); }, false, 300},
    {"hills",
     [](World& world, const Scale& scale) {
         addHills(world, scale);
         addMixedShapes(world, scale, 75);
     },
     true, 400},
    {"bowl",
     [](World& world, const Scale& scale) {
         addBowl(world, scale);
         addMixedShapes(world, scale, 50);
     },
     true, 400},
    {"joints", [](World& world, const Scale& scale) { addJoints(world, scale); }, false, 400},
    {"spinners", [](World& world, const Scale& scale) { addSpinners(world, scale); }, false, 300},
    {"chains", [](World& world, const Scale& scale) { addChains(world, scale); }, false, 300},
    {"house", [](World& world, const Scale& scale) { addHouse(world, scale); }, true, 400},
};

/// One step of a scenario.
inline void advance(World& world, const Scenario& scenario, const Scale& scale = {}) {
    if (scenario.disturbed) disturb(world, scale);
    world.step(static_cast<double>(scale.time(kStep)));
}

}  // namespace ragtop::scenes
