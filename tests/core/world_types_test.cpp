#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "ragtop/tasks.h"
#include "scenes.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

BodyId addBody(World& world, BodyType type, const DVec3& position, const Vec3& half = {0.5f, 0.5f, 0.5f}) {
    BodyDef def;
    def.type = type;
    def.shapes.push_back({.geometry = Box{half}});
    def.pose.position = position;
    return world.create(def);
}

void steps(World& world, int count) {
    for (int i = 0; i < count; ++i) {
        world.step(kDt);
        ASSERT_TRUE(isSound(world)) << "step " << i;
    }
}

/// A body's velocity outlasts the time in which no force moves it, and so does the place of each of its points.
TEST(BodyTypes, ThereAndBackKeepsPlaceVelocityAndMass) {
    World world({.gravity = {}});
    const BodyId body = addBody(world, BodyType::dynamic, {1, 2, 3}, {1, 0.5f, 0.25f});
    world.setVelocity(body, {1, 2, 3}, {0.3f, -0.2f, 0.5f});
    world.step(kDt);
    const Pose pose = world.pose(body);
    const Vec3 v = world.linearVelocity(body), w = world.angularVelocity(body);
    const float mass = world.mass(body).mass;
    world.setType(body, BodyType::kinematic);
    EXPECT_EQ(world.type(body), BodyType::kinematic);
    EXPECT_EQ(world.linearVelocity(body), v);
    EXPECT_EQ(world.angularVelocity(body), w);
    world.setType(body, BodyType::dynamic);
    EXPECT_EQ(world.pose(body).position, pose.position);
    EXPECT_EQ(world.pose(body).rotation, pose.rotation);
    EXPECT_EQ(world.linearVelocity(body), v);
    EXPECT_EQ(world.angularVelocity(body), w);
    EXPECT_EQ(world.mass(body).mass, mass);
    EXPECT_TRUE(world.isAwake(body));
    EXPECT_TRUE(isSound(world));
}

/// A kinematic body goes on as it went, whatever pulls at it; a fixed one stops.
TEST(BodyTypes, KinematicBodiesGoOnAndFixedOnesStand) {
    World world;
    const BodyId body = addBody(world, BodyType::dynamic, {0, 10, 0});
    world.setVelocity(body, {2, 0, 0}, {});
    world.setType(body, BodyType::kinematic);
    const double height = world.pose(body).position.y;
    steps(world, 60);
    EXPECT_NEAR(world.pose(body).position.x, 2, 1e-5);
    EXPECT_EQ(world.pose(body).position.y, height);
    world.setType(body, BodyType::fixed);
    EXPECT_EQ(world.linearVelocity(body), Vec3{});
    EXPECT_FALSE(world.isAwake(body));
    const DVec3 place = world.pose(body).position;
    steps(world, 10);
    EXPECT_EQ(world.pose(body).position, place);
    world.setType(body, BodyType::dynamic);
    steps(world, 30);
    EXPECT_NEAR(world.pose(body).position.y, height - 0.5 * 9.81 * 0.25, 0.05);
}

/// What was never dynamic gets the mass of its shapes, about their centre, and the velocity of that point.
TEST(BodyTypes, NewMassIsThatOfTheShapes) {
    World world({.gravity = {}});
    BodyDef def;
    def.type = BodyType::kinematic;
    def.shapes.push_back({.geometry = Box{{0.5f, 0.5f, 0.5f}}, .frame = {{1, 0, 0}, {}}, .density = 300});
    def.angularVelocity = {0, 0, 1};
    const BodyId body = world.create(def);
    const DVec3 corner{1.5, 0.5, 0.5};
    const Vec3 before = world.velocityAt(body, corner);
    world.setType(body, BodyType::dynamic);
    EXPECT_NEAR(world.mass(body).mass, 300, 1e-3);
    EXPECT_NEAR(world.mass(body).inertia.cx.x, 300.0f / 6, 1e-3);
    EXPECT_NEAR(length(relative(world.centerOfMass(body), DVec3{1, 0, 0})), 0, 1e-6);
    EXPECT_NEAR(length(world.velocityAt(body, corner) - before), 0, 1e-6);
    EXPECT_NEAR(length(world.linearVelocity(body) - Vec3{0, 1, 0}), 0, 1e-6);
}

/// A kinematic body takes a mass for the day on which forces move it.
TEST(BodyTypes, KinematicBodiesTakeAMass) {
    World world({.gravity = {}});
    const BodyId body = addBody(world, BodyType::kinematic, {});
    world.setMass(body, {8, {0.1f, 0, 0}, {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}});
    world.setVelocity(body, {1, 0, 0}, {});
    steps(world, 1);
    world.setType(body, BodyType::dynamic);
    EXPECT_EQ(world.mass(body).mass, 8);
    world.applyImpulse(body, {8, 0, 0}, world.centerOfMass(body));
    EXPECT_NEAR(length(world.linearVelocity(body) - Vec3{2, 0, 0}), 0, 1e-6);
    EXPECT_THROW(world.setMass(world.create(StaticBody{.shape = Box{{1, 1, 1}}}), world.mass(body)),
                 std::invalid_argument);
}

/// A ball whose centre of mass leaves its middle rolls on to the same bits after its state was restored.
TEST(BodyTypes, RestoredAfterANewMassGoOnAlike) {
    World world;
    scenes::addFloor(world);
    const BodyId ball = world.create(DynamicBody{.shape = Sphere{0.5f}, .position = {0, 0.5, 0}});
    world.setVelocity(ball, {1, 0, 0}, {0, 0, -2});
    for (int i = 0; i < 20; ++i) world.step(kDt);
    MassProperties mass = world.mass(ball);
    mass.center.x += 0.1f;
    world.setMass(ball, mass);
    std::vector<std::byte> saved(world.saveSize());
    world.save(saved);
    for (int i = 0; i < 20; ++i) world.step(kDt);
    const std::uint64_t hash = world.hash();
    world.restore(saved);
    for (int i = 0; i < 20; ++i) world.step(kDt);
    EXPECT_EQ(world.hash(), hash);
}

/// What rests frozen on the ground is solved again once it has a joint.
TEST(BodyTypes, FrozenBodiesTakeJoints) {
    World world({.sleeping = false});
    scenes::addFloor(world);
    const BodyId box = addBody(world, BodyType::dynamic, {0, 0.5, 0});
    steps(world, 120);
    world.create(BallDef{.bodies = {.b = box, .frameA = {toVec3(world.pose(box).position), {}}}});
    EXPECT_TRUE(isSound(world));
    steps(world, 10);
}

/// Nothing of a stack moves when one of its boxes, at whatever height, becomes fixed, and nothing when it is freed
/// again.
TEST(BodyTypes, StacksStandOnWhatBecomesFixed) {
    for (const int changed : {0, 2, 4}) {
        World world;
        scenes::addFloor(world);
        std::vector<BodyId> boxes;
        for (int i = 0; i < 5; ++i) boxes.push_back(addBody(world, BodyType::dynamic, {0, 0.5 + i, 0}));
        steps(world, 120);
        std::vector<double> heights;
        for (const BodyId box : boxes) heights.push_back(world.pose(box).position.y);
        const BodyId body = boxes[static_cast<std::size_t>(changed)];
        for (const BodyType type : {BodyType::fixed, BodyType::dynamic, BodyType::kinematic, BodyType::dynamic}) {
            world.setType(body, type);
            ASSERT_TRUE(isSound(world));
            for (int i = 0; i < 60; ++i) {
                steps(world, 1);
                for (std::size_t k = 0; k < boxes.size(); ++k) {
                    EXPECT_NEAR(world.pose(boxes[k]).position.y, heights[k], 1e-3);
                    EXPECT_LT(length(world.linearVelocity(boxes[k])), 0.02f) << k;
                }
            }
        }
    }
}

/// What lay asleep on a body falls when that is taken out of the world, and lies on it again when it is put back in
/// time.
TEST(BodyTypes, WhatLiesOnADisabledBodyFalls) {
    World world;
    const BodyId table = addBody(world, BodyType::fixed, {0, 0, 0}, {2, 0.1f, 2});
    const BodyId box = addBody(world, BodyType::dynamic, {0, 0.6, 0});
    world.step(kDt);
    world.sleep(box);
    world.setEnabled(table, false);
    EXPECT_FALSE(world.isEnabled(table));
    EXPECT_TRUE(world.isAwake(box));
    EXPECT_TRUE(world.castRay({{0, -5, 0}, {0, 4.95f, 0}}).shape.isNull());
    EXPECT_EQ(world.type(table), BodyType::fixed);
    steps(world, 30);
    EXPECT_NEAR(world.pose(box).position.y, 0.6 - 0.5 * 9.81 * 0.25, 0.06);
    world.setPose(box, {{0, 1, 0}, {}});
    world.setVelocity(box, {}, {});
    world.setEnabled(table, true);
    steps(world, 120);
    EXPECT_NEAR(world.pose(box).position.y, 0.6, 2e-3);
}

/// A body that comes back has what it had: place, velocity, mass, and a way that forces did not bend meanwhile.
TEST(BodyTypes, DisabledBodiesComeBackWithTheirVelocity) {
    World world;
    const BodyId body = addBody(world, BodyType::dynamic, {0, 10, 0});
    world.setVelocity(body, {1, 2, 0}, {0, 1, 0});
    const double energy = world.energy();
    world.setEnabled(body, false);
    EXPECT_FALSE(world.isAwake(body));
    EXPECT_EQ(world.energy(), 0);
    steps(world, 20);
    EXPECT_EQ(world.pose(body).position, (DVec3{0, 10, 0}));
    world.setEnabled(body, true);
    EXPECT_EQ(world.linearVelocity(body), (Vec3{1, 2, 0}));
    EXPECT_EQ(world.angularVelocity(body), (Vec3{0, 1, 0}));
    EXPECT_DOUBLE_EQ(world.energy(), energy);
    steps(world, 1);
    EXPECT_LT(world.linearVelocity(body).y, 2);
}

/// A pendulum hung from a body that becomes kinematic is carried along by it; where both ends stand, the joint rests,
/// and swings on with the period of a pendulum when the bob is freed.
TEST(BodyTypes, JointsFollowWhatTheyHold) {
    World world;
    const BodyId hook = addBody(world, BodyType::dynamic, {0, 5, 0}, {0.1f, 0.1f, 0.1f});
    const BodyId bob = addBody(world, BodyType::dynamic, {1, 5, 0}, {0.1f, 0.1f, 0.1f});
    const JointId joint = world.create(BallDef{.bodies = {.a = hook, .b = bob, .frameB = {{-1, 0, 0}, {}}}});
    world.setType(hook, BodyType::kinematic);
    world.setVelocity(hook, {0.5f, 0, 0}, {});
    for (int i = 0; i < 120; ++i) {
        steps(world, 1);
        EXPECT_LT(world.state(joint).gap, 2e-3f);
    }
    EXPECT_NEAR(world.pose(hook).position.x, 1, 1e-5);
    EXPECT_EQ(world.pose(hook).position.y, 5);
    world.setType(bob, BodyType::fixed);
    const DVec3 place = world.pose(bob).position;
    world.setVelocity(hook, {}, {});
    steps(world, 30);
    EXPECT_EQ(world.pose(bob).position, place);
    EXPECT_TRUE(world.isValid(joint));
    world.setType(bob, BodyType::dynamic);
    for (int i = 0; i < 60; ++i) {
        steps(world, 1);
        EXPECT_LT(world.state(joint).gap, 2e-3f);
    }
    world.setEnabled(hook, false);
    const Vec3 before = world.linearVelocity(bob);
    steps(world, 1);
    // Free of its joint it falls.
    EXPECT_NEAR(length(world.linearVelocity(bob) - before - Vec3{0, -9.81f / 60, 0}), 0, 1e-3);
}

/// A chain whose upper half is kinematic for a while keeps the energy that it has then: nothing kicks.
TEST(BodyTypes, ChangesOfAFigureAtRestMoveNothing) {
    World world;
    std::vector<BodyId> links;
    links.push_back(addBody(world, BodyType::fixed, {0, 10, 0}, {0.1f, 0.1f, 0.1f}));
    for (int i = 1; i <= 8; ++i) {
        links.push_back(addBody(world, BodyType::dynamic, {0, 10 - 0.5 * i, 0}, {0.05f, 0.2f, 0.05f}));
        world.create(BallDef{.bodies = {.a = links[links.size() - 2],
                                        .b = links.back(),
                                        .frameA = {{0, -0.25f, 0}, {}},
                                        .frameB = {{0, 0.25f, 0}, {}}}});
    }
    steps(world, 60);
    for (int round = 0; round < 4; ++round)
        for (std::size_t i = 1; i < links.size(); ++i) {
            world.setType(links[i],
                          (i + static_cast<std::size_t>(round)) % 2 == 0 ? BodyType::kinematic : BodyType::dynamic);
            steps(world, 5);
            for (const BodyId link : links) EXPECT_LT(length(world.linearVelocity(link)), 0.01f);
        }
}

/// Momentum: what is freed in flight takes nothing from others, and nothing is given by the change.
TEST(BodyTypes, ChangesGiveNoMomentumToOthers) {
    World world({.gravity = {}});
    const BodyId a = addBody(world, BodyType::dynamic, {0, 0, 0}), b = addBody(world, BodyType::dynamic, {1, 0, 0});
    world.create(HingeDef{.bodies = {.a = a, .b = b, .frameA = {{0.5f, 0, 0}, {}}, .frameB = {{-0.5f, 0, 0}, {}}}});
    for (const BodyId body : {a, b}) world.setVelocity(body, {1, 0.5f, 0}, {});
    for (const BodyType type : {BodyType::kinematic, BodyType::dynamic}) {
        world.setType(a, type);
        steps(world, 10);
        for (const BodyId body : {a, b}) EXPECT_NEAR(length(world.linearVelocity(body) - Vec3{1, 0.5f, 0}), 0, 1e-5);
    }
    world.setEnabled(a, false);
    steps(world, 10);
    EXPECT_NEAR(length(world.linearVelocity(b) - Vec3{1, 0.5f, 0}), 0, 1e-5);
}

TEST(BodyTypes, WrongCallsChangeNothing) {
    World world;
    BodyDef def;
    def.type = BodyType::fixed;
    def.shapes.push_back({.geometry = Box{{1, 1, 1}}, .density = 0});
    const BodyId weightless = world.create(def);
    const std::uint64_t hash = world.hash();
    try {
        world.setType(weightless, BodyType::dynamic);
        FAIL() << "accepted";
    } catch (const std::invalid_argument& wrong) {
        EXPECT_NE(std::string(wrong.what()).find("above 0 kg"), std::string::npos) << wrong.what();
    }
    EXPECT_THROW(world.setType(weightless, static_cast<BodyType>(7)), std::invalid_argument);
    EXPECT_THROW(world.setType({}, BodyType::fixed), std::out_of_range);
    EXPECT_THROW(world.setEnabled({}, false), std::out_of_range);
    EXPECT_EQ(world.hash(), hash);
    EXPECT_EQ(world.type(weightless), BodyType::fixed);
    world.setEnabled(weightless, false);
    EXPECT_THROW(world.setVelocity(weightless, {}, {}), std::invalid_argument);
    EXPECT_TRUE(isSound(world));

    struct Caller {
        BodyId body;
        int refused = 0;
    } caller{addBody(world, BodyType::dynamic, {0, 5, 0})};
    StepModule module;
    module.user = &caller;
    module.name = "caller";
    module.beforeStep = [](void* user, World& inside, double) {
        auto& self = *static_cast<Caller*>(user);
        try {
            inside.setType(self.body, BodyType::fixed);
        } catch (const std::logic_error&) {
            ++self.refused;
        }
        try {
            inside.setEnabled(self.body, false);
        } catch (const std::logic_error&) {
            ++self.refused;
        }
    };
    world.add(&module);
    world.step(kDt);
    EXPECT_EQ(caller.refused, 2);
    EXPECT_EQ(world.type(caller.body), BodyType::dynamic);
    world.remove(&module);
}

/// Changes types, takes out and puts back at random, among boxes that fall, lie and hang.
class Changer {
public:
    explicit Changer(World& world) : world_(world) {
        scenes::addFloor(world);
        for (int i = 0; i < 24; ++i)
            bodies_.push_back(addBody(world, BodyType::dynamic, {1.2 * (i % 5), 1 + 1.1 * (i / 5), 0.3 * (i % 3)}));
        for (std::size_t i = 0; i + 1 < 12; i += 2) join(i, i + 1);
        for (std::size_t i = 12; i + 1 < bodies_.size(); ++i) join(i, i + 1);
    }
    void act() {
        const BodyId body = bodies_[dice_.below(static_cast<std::uint32_t>(bodies_.size()))];
        switch (dice_.below(6)) {
            case 0:
                return world_.setType(body, BodyType::fixed);
            case 1:
                return world_.setType(body, BodyType::kinematic);
            case 2:
                return world_.setEnabled(body, false);
            case 3:
                return world_.setEnabled(body, true);
            case 4:
                return world_.sleep(body);
            default:
                return world_.setType(body, BodyType::dynamic);
        }
    }
    void moveSome() {
        const BodyId body = bodies_[dice_.below(static_cast<std::uint32_t>(bodies_.size()))];
        if (world_.type(body) != BodyType::fixed) world_.setVelocity(body, {dice_.between(-1, 1), 0.5f, 0}, {});
    }
    void freeAll() {
        for (const BodyId body : bodies_) world_.setEnabled(body, true), world_.setType(body, BodyType::dynamic);
    }
    float fastest() const {
        float most = 0;
        for (const BodyId body : bodies_) most = std::max(most, length(world_.linearVelocity(body)));
        return most;
    }

private:
    void join(std::size_t a, std::size_t b) {
        const Vec3 half = 0.5f * relative(world_.pose(bodies_[b]).position, world_.pose(bodies_[a]).position);
        world_.create(
            BallDef{.bodies = {.a = bodies_[a], .b = bodies_[b], .frameA = {half, {}}, .frameB = {-half, {}}}});
    }

    World& world_;
    scenes::Dice dice_;
    std::vector<BodyId> bodies_;
};

TEST(BodyTypes, AnySequenceKeepsAllFacts) {
    for (const int workers : {1, 2}) {
        World world({}, {.tasks = threadTasks(workers)});
        Changer changer(world);
        for (int i = 0; i < 2000; ++i) {
            changer.act();
            ASSERT_TRUE(isSound(world)) << i;
            if (i % 7 == 0) changer.moveSome();
            if (i % 3 == 0) world.step(kDt);
            ASSERT_TRUE(isSound(world)) << "step after " << i;
            ASSERT_LT(changer.fastest(), 100.0f) << i;
        }
        changer.freeAll();
        for (int i = 0; i < 600; ++i) world.step(kDt);
        ASSERT_TRUE(isSound(world));
        EXPECT_LT(changer.fastest(), 1.0f);
    }
}

/// The same calls after a state was restored lead to the same bits, with any number of threads.
TEST(BodyTypes, RestoredWorldsGoOnAlike) {
    std::uint64_t hashes[2];
    for (const int workers : {1, 2}) {
        World world({}, {.tasks = threadTasks(workers)});
        Changer changer(world);
        for (int i = 0; i < 60; ++i) changer.act(), world.step(kDt);
        std::vector<std::byte> saved(world.saveSize());
        world.save(saved);
        const auto goOn = [&] {
            Changer next = changer;
            for (int i = 0; i < 60; ++i) next.act(), world.step(kDt);
            return world.hash();
        };
        const std::uint64_t first = goOn();
        world.restore(saved);
        EXPECT_TRUE(isSound(world));
        EXPECT_EQ(goOn(), first);
        hashes[workers - 1] = first;
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

/// A joint that leaves all directions free is as good as none to what it joins, but that its bodies do not meet.
TEST(FreeJoints, HoldNothingAndKeepTheirBodiesFromMeeting) {
    World world({.gravity = {}});
    const BodyId a = addBody(world, BodyType::dynamic, {0, 0, 0}), b = addBody(world, BodyType::dynamic, {0.9, 0, 0});
    SixDofDef free;
    free.bodies.a = a;
    free.bodies.b = b;
    const JointId joint = world.create(free);
    const Vec3 v{0, 0.1f, 0}, none{};
    const auto goesFreely = [&] {
        world.setVelocity(a, v, none);
        world.setVelocity(b, none, none);
        steps(world, 30);
        return length(world.linearVelocity(a) - v) + length(world.linearVelocity(b)) +
                   length(world.angularVelocity(b)) <
               1e-9f;
    };
    EXPECT_TRUE(goesFreely());
    // Locked, it holds; freed again, it does not; nor does it when a coupling of its travels came and went.
    SixDofDef fixed = free;
    for (AxisDef* axis : {&fixed.x, &fixed.y, &fixed.z, &fixed.twist, &fixed.swingY, &fixed.swingZ})
        axis->limit = Range{0, 0};
    world.setPose(a, {});
    world.setPose(b, {});
    world.setDef(joint, fixed);
    EXPECT_FALSE(goesFreely());
    EXPECT_LT(length(world.linearVelocity(a) - world.linearVelocity(b)), 1e-4f);
    world.setDef(joint, free);
    EXPECT_TRUE(goesFreely());
    CouplingDef sum{.count = 2};
    sum.parts[0] = {joint, 3, 1};
    sum.parts[1] = {joint, 4, 1};
    sum.sum.limit = Range{-10, 10};
    sum.sum.friction = 1e6f;
    const CouplingId coupling = world.create(sum);
    EXPECT_FALSE(goesFreely());
    world.destroy(coupling);
    EXPECT_TRUE(goesFreely());
    // Without it they are pushed apart.
    world.setPose(a, {});
    world.setPose(b, {{0.9, 0, 0}, {}});
    world.setVelocity(a, none, none);
    EXPECT_TRUE(world.linearVelocity(b) == none);
    world.destroy(joint);
    steps(world, 60);
    EXPECT_GT(world.pose(b).position.x - world.pose(a).position.x, 0.99);
}

}  // namespace
}  // namespace ragtop
