#include <limits>
#include <random>
#include <set>

#include "ragtop/command_buffer.h"
#include "ragtop/fixed_stepper.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();

TEST(WorldApi, BadDefinitionsSayWhatIsWrong) {
    World world;
    BodyDef def = bodyDef(Sphere{-1}, {});
    expectMessage([&] { world.create(def); }, "radius");
    def = bodyDef(Sphere{1}, {static_cast<double>(kNowhere), 0, 0});
    expectMessage([&] { world.create(def); }, "pose.position");
    def = bodyDef(Sphere{1}, {});
    def.pose.rotation = {0, 0, 0, 0};
    expectMessage([&] { world.create(def); }, "pose.rotation");
    def = bodyDef(Sphere{1}, {});
    def.shapes[0].density = -1;
    expectMessage([&] { world.create(def); }, "density");
    def.shapes[0].density = 0;
    expectMessage([&] { world.create(def); }, "mass");
    def.shapes[0].density = 1000;
    def.shapes[0].sensor = true;
    expectMessage([&] { world.create(def); }, "mass of all shapes is 0");
    def = bodyDef(Sphere{1}, {}, surface(-1));
    expectMessage([&] { world.create(def); }, "friction");
    def = bodyDef(Sphere{1}, {});
    def.mass = MassProperties{-2, {}, {}};
    expectMessage([&] { world.create(def); }, "mass");
    def = bodyDef(Sphere{1}, {});
    def.linearVelocity.x = kNowhere;
    expectMessage([&] { world.create(def); }, "linearVelocity");
    const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    const Triangle triangle[] = {{0, 1, 2}};
    expectMessage([&] { world.create(bodyDef(TriangleMesh(corners, triangle), {})); }, "TriangleMesh");
    EXPECT_TRUE(world.bodies().empty());
    run(world, 0.1);

    WorldSettings settings;
    settings.substeps = 0;
    expectMessage([&] { world.setSettings(settings); }, "substeps");
    EXPECT_EQ(world.settings().substeps, 4);
    EXPECT_THROW(World{settings}, std::invalid_argument);
    EXPECT_THROW(World({}, WorldConfig{.lanes = 5}), std::invalid_argument);
}

TEST(WorldApi, NumbersThatAreNotFiniteAreRefused) {
    World world;
    const BodyId body = world.create(bodyDef(Sphere{1}, {}));
    EXPECT_THROW(world.applyImpulse(body, {kNowhere, 0, 0}, {}), std::invalid_argument);
    EXPECT_THROW(world.applyForce(body, {kNowhere, 0, 0}, {}), std::invalid_argument);
    EXPECT_THROW(world.applyTorque(body, {kNowhere, 0, 0}), std::invalid_argument);
    EXPECT_THROW(world.applyAngularImpulse(body, {kNowhere, 0, 0}), std::invalid_argument);
    EXPECT_THROW(world.setVelocity(body, {kNowhere, 0, 0}, {}), std::invalid_argument);
    EXPECT_THROW(world.setPose(body, {{0, 0, 0}, {kNowhere, 0, 0, 1}}), std::invalid_argument);
    EXPECT_THROW(world.setPose(body, {{0, 0, 0}, {0, 0, 0, 0}}), std::invalid_argument);
    EXPECT_THROW(world.setGravityScale(body, kNowhere), std::invalid_argument);
    EXPECT_THROW(world.moveTo(body, {}, 0), std::invalid_argument);
    EXPECT_EQ(world.linearVelocity(body), Vec3{});
    run(world, 0.1);
    EXPECT_TRUE(isFinite(world.pose(body).position));
}

TEST(WorldApi, IdsThatNameNothingAreOutOfRange) {
    World world;
    const BodyId body = world.create(bodyDef(Sphere{1}, {}));
    const ShapeId shape = world.shapes(body)[0];
    const JointId joint = world.create(BallDef{.bodies = {.b = body}});
    world.destroy(body);
    EXPECT_FALSE(world.isValid(body) || world.isValid(shape) || world.isValid(joint));
    for (const BodyId id : {body, BodyId{}, BodyId{0, 1}, BodyId{77, 1}}) {
        EXPECT_FALSE(world.isValid(id));
        EXPECT_THROW(world.pose(id), std::out_of_range);
        EXPECT_THROW(world.destroy(id), std::out_of_range);
        EXPECT_THROW(world.setVelocity(id, {}, {}), std::out_of_range);
        EXPECT_THROW(world.shapes(id), std::out_of_range);
        EXPECT_THROW(world.wake(id), std::out_of_range);
    }
    EXPECT_THROW(world.geometry(shape), std::out_of_range);
    EXPECT_THROW(world.def(joint), std::out_of_range);
    EXPECT_THROW(world.destroy(joint), std::out_of_range);
    EXPECT_THROW(world.create(BallDef{.bodies = {.b = body}}), std::invalid_argument);
    // Its successor has another name.
    const BodyId next = world.create(bodyDef(Sphere{1}, {}));
    EXPECT_NE(next, body);
    EXPECT_FALSE(world.isValid(body));
}

TEST(WorldApi, JointsKeepTypeAndBodies) {
    World world;
    const BodyId a = world.create(bodyDef(Sphere{0.2f}, {})), b = world.create(bodyDef(Sphere{0.2f}, {1, 0, 0}));
    const BodyId fixed = addFloor(world, {}, {0, -5, 0});
    const JointId joint = world.create(BallDef{.bodies = {.a = a, .b = b}});
    EXPECT_THROW(world.setDef(joint, HingeDef{.bodies = {.a = a, .b = b}}), std::invalid_argument);
    EXPECT_THROW(world.setDef(joint, BallDef{.bodies = {.a = b, .b = a}}), std::invalid_argument);
    EXPECT_THROW(world.create(BallDef{.bodies = {.a = a, .b = a}}), std::invalid_argument);
    EXPECT_THROW(world.create(BallDef{}), std::invalid_argument);
    EXPECT_THROW(world.create(BallDef{.bodies = {.b = fixed}}), std::invalid_argument);
    EXPECT_EQ(world.jointsOf(a).size(), 1u);
    world.destroy(b);
    EXPECT_TRUE(world.joints().empty());
    EXPECT_TRUE(world.jointsOf(a).empty());
    run(world, 0.1);
}

TEST(WorldApi, ABodyTellsWhatItWasMadeOf) {
    World world;
    Compound pair;
    pair.parts.push_back({Sphere{0.2f}, {{-1, 0, 0}, {}}});
    pair.parts.push_back({Box{{0.3f, 0.2f, 0.1f}}, {{1, 0, 0}, rotationAbout({0, 0, 1}, 0.5f)}});
    BodyDef def = bodyDef(pair, {1, 2, 3});
    def.pose.rotation = rotationAbout({1, 1, 0}, 0.4f);
    def.userData = 17;
    const BodyId body = world.create(def);
    EXPECT_EQ(world.userData(body), 17u);
    EXPECT_LT(distanceBetween(world.pose(body).position, def.pose.position), 1e-6);
    const MassProperties expected = massOf(pair, 1000), mass = world.mass(body);
    EXPECT_NEAR(mass.mass, expected.mass, 1e-5f * expected.mass);
    EXPECT_LT(length(mass.center - expected.center), 1e-5f);
    EXPECT_LT(length(mass.inertia.cx - expected.inertia.cx) + length(mass.inertia.cy - expected.inertia.cy) +
                  length(mass.inertia.cz - expected.inertia.cz),
              1e-4f * expected.inertia.cy.y);
    ASSERT_EQ(world.shapes(body).size(), 2u);
    EXPECT_LT(length(world.frame(world.shapes(body)[0]).position - Vec3{-1, 0, 0}), 1e-5f);
    EXPECT_LT(distanceBetween(world.centerOfMass(body), transformPoint(def.pose, mass.center)), 1e-5);
}

TEST(WorldApi, BuffersApplyInTheOrderOfTheirKeys) {
    World world(withoutGravity());
    const BodyId body = world.create(bodyDef(Sphere{1}, {}));
    CommandBuffer late(9), early(2);
    late.setVelocity(body, {9, 0, 0}, {});
    early.setVelocity(body, {2, 0, 0}, {});
    const std::size_t place = early.create(bodyDef(Sphere{1}, {5, 0, 0}));
    late.destroy(BodyId{55, 3});
    late.wake(body);
    CommandBuffer* const buffers[] = {&late, &early};
    EXPECT_THROW(world.apply(buffers), std::out_of_range);
    EXPECT_EQ(world.linearVelocity(body), (Vec3{9, 0, 0}));
    ASSERT_EQ(early.created().size(), 1u);
    EXPECT_TRUE(world.isValid(early.created()[place]));
    EXPECT_EQ(world.bodies().size(), 2u);
}

TEST(WorldApi, AStepperBlendsBetweenSteps) {
    World world(withoutGravity());
    BodyDef def = bodyDef(Sphere{1}, {});
    def.linearVelocity = {6, 0, 0};
    const BodyId body = world.create(def);
    FixedStepper stepper(kDt);
    double shown = 0;
    for (int frame = 1; frame <= 144; ++frame) {
        for (const double dt : stepper.advance(1.0 / 144)) {
            stepper.remember(world);
            world.step(dt);
        }
        const double x = stepper.blended(world, body).position.x;
        // Drawn one step late: 6 m/s · (t − dt), evenly.
        if (frame > 4) {
            EXPECT_NEAR(x, 6 * (frame / 144.0 - kDt), 1e-4);
            EXPECT_NEAR(x - shown, 6.0 / 144, 1e-4);
        }
        shown = x;
    }
}

// Whatever is created and destroyed, in any order and between any steps, ids never alias and nothing is left behind.
TEST(WorldApi, TenThousandRandomChangesLeaveNothingBehind) {
    World world;
    addFloor(world);
    std::mt19937 random(3);
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    std::set<BodyId> everBodies;
    std::set<JointId> everJoints;
    const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    for (int k = 0; k < 10000; ++k) {
        const auto what = static_cast<unsigned>(random() % 100);
        if (what < 30 && bodies.size() < 60) {
            const double x = static_cast<double>(random() % 400) / 100, z = static_cast<double>(random() % 400) / 100;
            const DVec3 at{x, 0.5 + static_cast<double>(random() % 300) / 100, z};
            const Shape shape = k % 3 ? k % 2 ? Shape(Sphere{0.3f}) : Shape(Capsule{0.2f, 0.2f}) : Shape(Box{});
            BodyDef def = bodyDef(shape, at, {},
                                  k % 17 == 0   ? BodyType::kinematic
                                  : k % 13 == 0 ? BodyType::fixed
                                                : BodyType::dynamic);
            def.shapes[0].sensor = k % 13 == 0;
            bodies.push_back(world.create(def));
            ASSERT_TRUE(everBodies.insert(bodies.back()).second);
        } else if (what < 50 && !bodies.empty()) {
            const std::size_t i = pick(bodies.size());
            world.destroy(bodies[i]);
            ASSERT_FALSE(world.isValid(bodies[i]));
            bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(i));
        } else if (what < 60 && bodies.size() > 2) {
            const BodyId a = bodies[pick(bodies.size())], b = bodies[pick(bodies.size())];
            if (a == b || (world.type(a) != BodyType::dynamic && world.type(b) != BodyType::dynamic)) continue;
            joints.push_back(world.create(DistanceDef{.bodies = {.a = a, .b = b}, .limit = Range{0, 3}}));
            ASSERT_TRUE(everJoints.insert(joints.back()).second);
        } else if (what < 66 && !joints.empty()) {
            const std::size_t i = pick(joints.size());
            if (world.isValid(joints[i])) world.destroy(joints[i]);
            joints.erase(joints.begin() + static_cast<std::ptrdiff_t>(i));
        } else if (what < 80 && !bodies.empty()) {
            const BodyId body = bodies[pick(bodies.size())];
            switch (random() % 7) {
                case 0:
                    world.setPose(body, {{1, 2, 1}, {}});
                    break;
                case 1:
                    world.applyImpulse(body, {100, 50, 0}, world.centerOfMass(body));
                    break;
                case 2:
                    world.sleep(body);
                    break;
                case 3:
                    world.wake(body);
                    break;
                case 4:
                    world.setFilter(world.shapes(body)[0],
                                    Filter{.category = random() % 2 ? 0u : 1u, .mask = random() % 2 ? 0u : ~0u});
                    break;
                case 5:
                    world.setMaterial(world.shapes(body)[0], surface(0.1f));
                    break;
                default:
                    world.setGravityScale(body, 0.5f);
                    break;
            }
        } else {
            world.step(kDt);
            for (const BodyId body : bodies) ASSERT_TRUE(isFinite(world.pose(body).position)) << k;
        }
    }
    std::erase_if(joints, [&](JointId joint) { return !world.isValid(joint); });
    EXPECT_EQ(world.bodies().size(), bodies.size() + 1);
    EXPECT_EQ(world.joints().size(), joints.size());
    for (const BodyId body : bodies) world.destroy(body);
    world.step(kDt);
    EXPECT_EQ(world.stats().bodies, 1);
    EXPECT_EQ(world.stats().contacts, 0);
    EXPECT_EQ(world.stats().joints, 0);
    EXPECT_EQ(world.stats().colors, 0);
}

/// Stages are timed in the first step of a small world and in few of the next ones, which leave what they have been.
TEST(WorldApi, SmallWorldsKeepTheStagesOfTheStepThatTheyWereTimedIn) {
    World world;
    world.create(DynamicBody{.shape = Sphere{0.5f}});
    EXPECT_TRUE(world.stats().stages.empty());
    for (int step = 0; step < 40; ++step) {
        world.step(kDt);
        const std::span<const StepStats::Stage> stages = world.stats().stages;
        ASSERT_GT(stages.size(), 9u) << step;
        EXPECT_STREQ(stages.front().name, "modules");
        EXPECT_STREQ(stages.back().name, "modules after");
    }
}

/// A ball that meets nothing falls through the floor, unseen, also by those that it is put into and from a restored
/// world; once it meets all again it lies on the next one.
TEST(WorldApi, WhatMeetsNothingIsInNoTreeUntilItMeetsSomething) {
    World world;
    for (const double height : {-1.0, -6.0})
        world.create(StaticBody{.shape = Box{{10, 1, 10}}, .position = {0, height, 0}});
    const BodyId ball = world.create(DynamicBody{.shape = Sphere{0.5f}, .position = {0, 1, 0}});
    const ShapeId shape = world.shapes(ball)[0];
    const auto isSeen = [&] {
        return world.castRay({world.pose(ball).position + DVec3{0, 0.8, 0}, {0, -0.8f, 0}}).shape == shape;
    };
    EXPECT_TRUE(isSeen());
    world.setFilter(shape, {.category = 0, .mask = 0});
    EXPECT_FALSE(isSeen());
    world.setPose(ball, {{0, 0.2, 0}, {}});
    world.setType(ball, BodyType::kinematic);
    world.setType(ball, BodyType::dynamic);
    std::vector<std::byte> saved(world.saveSize());
    world.save(saved);
    run(world, 0.5f);
    EXPECT_EQ(world.validate(), "");
    EXPECT_NEAR(world.pose(ball).position.y, 0.2 - 0.5 * 9.81 * 0.25, 0.03);
    world.restore(saved);
    run(world, 0.8f);
    EXPECT_LT(world.pose(ball).position.y, -2.5);
    world.setFilter(shape, {});
    EXPECT_TRUE(isSeen());
    run(world, 2);
    EXPECT_EQ(world.validate(), "");
    EXPECT_NEAR(world.pose(ball).position.y, -4.5, 0.01);
}

}  // namespace
}  // namespace ragtop
