#include <algorithm>

#include "chain_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Potential, of height, and kinetic energy of all bodies, J.
double energyOfAll(const World& world, const std::vector<BodyId>& bodies) {
    double sum = 0;
    for (const BodyId body : bodies) sum += test::energyOf(world, body);
    return sum;
}

/// Twenty planks between two banks, hung by two balls at each end, a tenth longer than their span; ten boxes of 15 to
/// 150 kg fall on them.
struct Bridge {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;

    explicit Bridge(World& world) {
        constexpr int kPlanks = 20;
        constexpr double kPitch = 0.54, kHeight = 10;
        addFloor(world);
        BodyId before{};
        for (int i = 0; i <= kPlanks; ++i) {
            const double edge = (i - kPlanks / 2) * kPitch;
            const auto sag = [](double x) { return 0.1 * (x * x - 5.4 * 5.4) / 5.4; };
            BodyId plank{};
            if (i < kPlanks) {
                BodyDef def = bodyDef(Box{{0.28f, 0.05f, 1}},
                                      {edge + 0.5 * kPitch, kHeight + 0.5 * (sag(edge) + sag(edge + kPitch)), 0});
                def.shapes[0].density = 500;
                plank = world.create(def);
                bodies.push_back(plank);
            }
            for (const double z : {-0.9, 0.9}) hang(world, before, plank, {edge, kHeight + sag(edge), z});
            before = plank;
        }
        for (int i = 0; i < 10; ++i) {
            BodyDef def = bodyDef(Box{{0.25f, 0.25f, 0.25f}}, {-3 + 0.6 * i, kHeight + 1.5 + 0.4 * i, 0.2 - 0.04 * i});
            def.shapes[0].density = 120.0f * static_cast<float>(1 + i);
            bodies.push_back(world.create(def));
        }
    }
    void hang(World& world, BodyId a, BodyId b, const DVec3& point) {
        JointBodies joined{.a = a, .b = b};
        const auto frame = [&](BodyId body) {
            const DVec3 from = world.isValid(body) ? world.pose(body).position : DVec3{};
            return Frame{toVec3(point - from), {}};
        };
        joined.frameA = frame(a), joined.frameB = frame(b);
        joints.push_back(world.create(BallDef{.bodies = joined}));
    }
};

/// Wherever it is solved, and whether that succeeds: falling boxes bring all the energy there is.
TEST(EnergyGuard, ABridgeThatBoxesFallOnNeverHasMoreEnergyThanTheyBring) {
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::iterative}) {
        WorldSettings settings = withoutSleep();
        settings.solver = solver;
        World world{settings};
        const Bridge bridge{world};
        const double start = energyOfAll(world, bridge.bodies);
        for (int i = 0; i < 480; ++i) {
            world.step(kDt);

            // Rows of joints trade up to a hundredth between places and speeds.
            ASSERT_LE(energyOfAll(world, bridge.bodies), 1.01 * start) << nameOf(solver) << " step " << i;
        }
    }
}

/// Of what a module pushes within a step it counts what the module has given, and no more: wheels of a vehicle on
/// planks had the guard look away from them.
TEST(EnergyGuard, ABridgeThatAModulePushesNeverHasMoreEnergyThanItIsGiven) {
    struct Pusher {
        std::vector<BodyId> bodies;
        double given = 0, phase = 0;

        void push(World& world, double h) {
            phase += 20 * h;
            for (const BodyId body : bodies) {
                const Vec3 impulse{0, static_cast<float>(20 * h * std::sin(phase)), 0};
                const Vec3 before = world.linearVelocity(body);
                world.applyImpulse(body, impulse, world.centerOfMass(body));
                given += 0.5 * static_cast<double>(dot(impulse, before + world.linearVelocity(body)));
            }
        }
    };
    WorldSettings settings = withoutSleep();
    settings.solver = SolverChoice::iterative;
    World world{settings};
    Bridge bridge{world};
    BodyDef heavy = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0.3, 14, 0});
    heavy.shapes[0].density = 20000;
    heavy.linearVelocity = {5, -15, 0};
    bridge.bodies.push_back(world.create(heavy));
    Pusher pusher{bridge.bodies};
    StepModule module{.user = &pusher, .name = "pusher"};
    module.beforeSubstep = [](void* user, World& w, double h) { static_cast<Pusher*>(user)->push(w, h); };
    world.add(&module);
    const double start = energyOfAll(world, bridge.bodies);
    double most = 0;
    for (int i = 0; i < 480; ++i) {
        world.step(kDt);
        most = std::max(most, pusher.given);
        ASSERT_LE(energyOfAll(world, bridge.bodies), 1.01 * start + most) << "step " << i;
    }
    EXPECT_GT(most, 10);
    EXPECT_GT(world.stats().energyGuarded, 0u);
}

/// Small balls in a square, each joined to its neighbours half way and held at the corners: flat, as long as its span,
/// so that its loads are as large as its sag is small. A ball falls on it.
struct Net {
    std::vector<BodyId> bodies;

    Net(World& world, int side, double x, float mass) {
        constexpr double kPitch = 0.25, kHeight = 8;
        const double middle = kPitch * (side - 1) / 2;
        addFloor(world);
        const auto place = [&](int i) {
            return DVec3{i % side * kPitch - middle, kHeight, i / side * kPitch - middle};
        };
        for (int i = 0; i < side * side; ++i) {
            BodyDef def = bodyDef(Sphere{0.04f}, place(i));
            def.shapes[0].density = 3000;
            bodies.push_back(world.create(def));
        }
        const auto tie = [&](BodyId a, const DVec3& ofA, int i, const DVec3& point) {
            JointBodies joined{.a = a, .b = bodies[static_cast<std::size_t>(i)]};
            joined.frameA = {toVec3(point - ofA), {}}, joined.frameB = {toVec3(point - place(i)), {}};
            world.create(BallDef{.bodies = joined});
        };
        for (int i = 0; i < side * side; ++i) {
            const BodyId knot = bodies[static_cast<std::size_t>(i)];
            if (i % side + 1 < side) tie(knot, place(i), i + 1, 0.5 * (place(i) + place(i + 1)));
            if (i / side + 1 < side) tie(knot, place(i), i + side, 0.5 * (place(i) + place(i + side)));
        }
        for (const int corner : {0, side - 1, side * (side - 1), side * side - 1}) tie({}, {}, corner, place(corner));
        BodyDef ball = bodyDef(Sphere{0.3f}, {x, kHeight + 2.3, 0});
        ball.mass = MassProperties{mass, {}, {{0.036f * mass, 0, 0}, {0, 0.036f * mass, 0}, {0, 0, 0.036f * mass}}};
        bodies.push_back(world.create(ball));
    }
};

/// A solve that fails in the midst of that leaves nothing: bodies are as fast as they were, or slower, but for the room
/// that a group has: 1/200 of the energy of its motion, which is what the fall of the ball and the sag of the net give.
TEST(EnergyGuard, ANetThatABallFallsOnNeverHasMoreEnergyThanItBrings) {
    constexpr double kSag = 0.5, kFall = 2.3 + kSag;  // m, that the net hangs through and that the ball falls
    constexpr double kRoom = 0.005;
    struct Case {
        int side;
        double x;
        float mass;
    };
    for (const Case& c : {Case{14, 0, 12}, Case{14, 0, 110}, Case{14, -0.2, 5}, Case{6, 0.23, 30}}) {
        World world{withoutSleep()};
        const Net net(world, c.side, c.x, c.mass);
        double fall = asDouble(c.mass) * (kFall - kSag);  // kg m
        for (const BodyId body : net.bodies) fall += asDouble(world.mass(body).mass) * kSag;
        const double start = energyOfAll(world, net.bodies), room = kRoom * asDouble(kGravity) * fall;
        for (int i = 0; i < stepsIn(1); ++i) {
            world.step(kDt);
            ASSERT_LE(energyOfAll(world, net.bodies), start + room) << c.side << ", " << c.mass << " kg, step " << i;
        }
    }
}

/// h² K / I of a link between a pull of T on both its ends: 2 T a h² / I = 4.9 for 1000 kg on links of 1 kg and half a
/// metre, which an explicit step does not follow (4), and each of its joints alone (2.5) does not show.
TEST(EnergyGuard, SweepsHoldLightLinksThatBothTheirJointsPull) {
    WorldSettings settings = withoutSleep();
    settings.solver = SolverChoice::iterative;
    World world{settings};
    const Chain chain(world, 12, 1000);
    const double start = energyOf(world, chain), released = 1000 * 9.81 * 6;
    for (int i = 0; i < 600; ++i) {
        world.step(kDt);
        ASSERT_LE(energyOf(world, chain), start + 0.01 * released) << i;
    }
}

/// The guard answers to gains alone: what swings, and falls, and lands, keeps its energy by itself.
TEST(EnergyGuard, IsNotAskedByChainsThatSwingNorByFiguresThatFall) {
    World world{withoutSleep()};
    const Chain light(world, 10, 1), hinged(world, 6, 10, 5, true), heavy(world, 20, 1000, 10);
    for (int i = 0; i < 300; ++i) world.step(kDt);
    EXPECT_EQ(world.stats().energyGuarded, 0u);
    EXPECT_EQ(world.stats().energyTaken, 0);
}

/// A tower is solved as what it is in its own frame: on a platform that moves evenly it moves as little against that as
/// on the ground, 20 boxes by less than a thousandth of one.
TEST(EnergyGuard, ATowerOnAPlatformThatMovesEvenlyStandsAsOnTheGround) {
    for (const float speed : {0.1f, 2.0f, 50.0f}) {
        World world{withoutSleep()};
        BodyDef platform = bodyDef(Box{{5, 1, 5}}, {0, -1, 0}, {}, BodyType::kinematic);
        platform.linearVelocity = {speed, 0, 0};
        const BodyId below = world.create(platform);
        std::vector<BodyId> boxes;
        for (int i = 0; i < 20; ++i) {
            BodyDef box = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5 + i, 0});
            box.linearVelocity = {speed, 0, 0};
            boxes.push_back(world.create(box));
        }
        for (int i = 0; i < 1200; ++i) world.step(kDt);
        for (int i = 0; i < 20; ++i) {
            const DVec3 place = world.pose(boxes[static_cast<std::size_t>(i)]).position - world.pose(below).position;
            EXPECT_NEAR(place.x, 0, 1e-3) << speed << " m/s, box " << i;
            EXPECT_NEAR(place.y, 1.5 + i, 1e-3) << speed << " m/s, box " << i;
        }
    }
}

/// A rope that is made shorter from step to step draws its load along; what it lacks is less than the way of one step.
/// A second body hangs below the first.
TEST(EnergyGuard, AWinchLiftsItsLoadAsFastAsItsRopeShortens) {
    for (const float speed : {0.1f, 0.5f, 2.0f}) {
        World world;
        const BodyId load = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0, -5, 0}));
        const BodyId below = world.create(bodyDef(Sphere{0.4f}, {0, -6, 0}));
        BallDef link;
        link.bodies = {.a = load, .b = below, .frameA = {{0, -0.5f, 0}, {}}, .frameB = {{0, 0.5f, 0}, {}}};
        world.create(JointDef{link});
        DistanceDef rope;
        rope.bodies.b = load;
        rope.limit = Range{0, 5};
        const JointId winch = world.create(JointDef{rope});
        for (int i = 0; i < 120; ++i) world.step(kDt);
        const auto step = speed * static_cast<float>(kDt);
        for (int i = 1; i <= static_cast<int>(3 / step); ++i) {
            rope.limit = Range{0, 5 - step * static_cast<float>(i)};
            world.setDef(winch, JointDef{rope});
            world.step(kDt);
            EXPECT_LE(world.state(winch).gap, step) << speed << " m/s, step " << i;
        }
        EXPECT_EQ(world.stats().energyGuarded, 0u) << speed;
    }
}

/// A pendulum whose anchor is put 0.5 m aside, farther than its rope reaches, swings from there.
TEST(EnergyGuard, WhatHangsFollowsAnAnchorThatIsPutElsewhere) {
    for (const BodyType type : {BodyType::fixed, BodyType::kinematic}) {
        World world{withoutSleep()};
        const BodyId anchor = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0, 2, 0}, {}, type));
        const BodyId load = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0, 1, 0}));
        DistanceDef rope;
        rope.bodies.a = anchor;
        rope.bodies.b = load;
        rope.limit = Range{0, 1};
        const JointId joint = world.create(JointDef{rope});
        for (int i = 0; i < 60; ++i) world.step(kDt);
        world.setPose(anchor, {{0.5, 2, 0}, {}});
        double farthest = 0;
        for (int i = 0; i < 120; ++i) {
            world.step(kDt);
            farthest = std::max(farthest, world.pose(load).position.x);
            EXPECT_LT(world.state(joint).gap, i > 30 ? 1e-3f : 0.12f) << i;
        }
        EXPECT_GT(farthest, 0.6);
    }
}

/// A cart of three boxes in a row lies on a belt that starts long after it was made; friction takes it along.
TEST(EnergyGuard, ABeltThatStartsTakesAlongWhatJointsHoldTogether) {
    World world{withoutSleep()};
    const BodyId belt = world.create(bodyDef(Box{{50, 0.5f, 1}}, {0, -0.5, 0}, {}, BodyType::fixed));
    BodyId before{};
    for (int i = 0; i < 3; ++i) {
        const BodyId box = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0.5 * i, 0.2, 0}));
        HingeDef hinge;
        hinge.bodies = {.a = before, .b = box, .frameA = {{0.25f, 0, 0}, {}}, .frameB = {{-0.25f, 0, 0}, {}}};
        if (i > 0) world.create(JointDef{hinge});
        before = box;
    }
    for (int i = 0; i < 30; ++i) world.step(kDt);
    Material moving = world.material(world.shapes(belt).front());
    moving.surfaceVelocity = {4, 0, 0};
    world.setMaterial(world.shapes(belt).front(), moving);
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_NEAR(world.linearVelocity(before).x, 4, 4e-3);
    EXPECT_EQ(world.stats().energyGuarded, 0u);
}

/// What a kinematic body lifts by a joint gains m g per metre from it, at any speed.
TEST(EnergyGuard, LetsWhatIsLiftedSlowlyRise) {
    for (const float speed : {0.001f, 0.03f, 1.0f}) {
        World world;
        const BodyId hand = world.create(bodyDef(Box{{0.1f, 0.1f, 0.1f}}, {0, 0, 0}, {}, BodyType::kinematic));
        const BodyId load = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0, -1, 0}));
        BallDef grip;
        grip.bodies = {.a = hand, .b = load, .frameA = {{0, -0.5f, 0}, {}}, .frameB = {{0, 0.5f, 0}, {}}};
        world.create(JointDef{grip});
        for (int i = 0; i < 600; ++i) {
            world.setVelocity(hand, {0, speed, 0}, {});
            world.step(kDt);
        }
        EXPECT_NEAR(world.pose(load).position.y + 1, world.pose(hand).position.y, 1e-4) << speed;
        EXPECT_EQ(world.stats().energyGuarded, 0u) << speed;
    }
}

/// Balls of 4 kg on damped springs to all of up to 26 neighbours, h c Σ 1/m = 5: more than iteration follows.
struct Lattice {
    std::vector<BodyId> bodies;

    Lattice(World& world, int side, double height, const Vec3& shear = {}) {
        constexpr double kPitch = 0.25;
        Spring spring;
        spring.stiffness = 1e5f, spring.damping = 200;
        const auto place = [&](int i) {
            return kPitch * DVec3{Vec3{static_cast<float>(i / (side * side)), static_cast<float>(i / side % side),
                                       static_cast<float>(i % side)}};
        };
        for (int i = 0; i < side * side * side; ++i) {
            BodyDef def = bodyDef(Sphere{0.1f}, place(i) + DVec3{0, height, 0});
            def.shapes[0].density = 1000;
            def.linearVelocity = (i % 2 == 0 ? 1.0f : -1.0f) * shear;
            bodies.push_back(world.create(def));
            for (int j = 0; j < i; ++j) {
                const DVec3 way = place(i) - place(j);
                if (lengthSquared(toVec3(way)) > 3.5 * kPitch * kPitch) continue;
                DistanceDef joint;
                joint.bodies = {.a = bodies[static_cast<std::size_t>(i)], .b = bodies[static_cast<std::size_t>(j)]};
                joint.rest = static_cast<float>(std::sqrt(lengthSquared(toVec3(way))));
                joint.spring = spring;
                world.create(JointDef{joint});
            }
        }
    }
    double speed(const World& world) const {
        double fastest = 0;
        for (const BodyId body : bodies) fastest = std::max(fastest, asDouble(length(world.linearVelocity(body))));
        return fastest;
    }
};

/// Whoever solves it: a step that is undone again loses half of its speeds, of 3 m/s in ten steps a hundredth is left.
TEST(EnergyGuard, ALatticeThatNoSolverHoldsComesToRestRatherThanHangInMidMotion) {
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::iterative}) {
        WorldSettings settings = withoutSleep();
        settings.solver = solver;
        World world{settings};
        addFloor(world);
        const Lattice lattice(world, 4, 0.5);
        const double start = energyOfAll(world, lattice.bodies);
        int stuck = 0;
        DVec3 before{};
        for (int i = 0; i < stepsIn(4); ++i) {
            world.step(kDt);
            const DVec3 now = world.pose(lattice.bodies.back()).position;
            stuck = now == before && lattice.speed(world) > 0.01 ? stuck + 1 : 0;
            before = now;
            ASSERT_LE(stuck, 10) << nameOf(solver) << " step " << i;
            ASSERT_LE(energyOfAll(world, lattice.bodies), 1.01 * start) << nameOf(solver) << " step " << i;
        }
        EXPECT_LT(lattice.speed(world), 0.02) << nameOf(solver);
    }
}

/// Its steps are undone, its fall is not: the centre of mass is where y = y₀ − ½ g t² says, to the rounding of places.
TEST(EnergyGuard, WhatIsUndoneInFlightFallsOn) {
    WorldSettings settings = withoutSleep();
    settings.solver = SolverChoice::iterative;
    World world{settings};
    const Lattice lattice(world, 4, 0, {0, 0, 3});
    const auto centre = [&] {
        DVec3 sum{};
        for (const BodyId body : lattice.bodies) sum = sum + world.pose(body).position;
        return (1.0 / static_cast<double>(lattice.bodies.size())) * sum;
    };
    const DVec3 start = centre();
    for (int i = 0; i < stepsIn(1); ++i) world.step(kDt);
    EXPECT_GT(world.stats().energyGuarded, 0u);
    const DVec3 way = centre() - start;
    EXPECT_NEAR(way.y, -0.5 * 9.81, 1e-3);
    EXPECT_NEAR(way.x, 0, 1e-3);
    EXPECT_NEAR(way.z, 0, 1e-3);
}

}  // namespace
}  // namespace ragtop
