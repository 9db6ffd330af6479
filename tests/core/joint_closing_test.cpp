#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "chain_support.h"
#include "constraints/axis_rows.h"
#include "constraints/joint_sim.h"

namespace ragtop {
namespace {

using namespace test;

/// Boxes of half a metre in a row, each joined to the next by a ball where they meet, with gaps that no contact fills.
struct Row {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;

    Row(World& world, int count, float ratio) {
        for (int i = 0; i < count; ++i) {
            BodyDef def = bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0.5 * i, 5, 0});
            def.shapes[0].density = i % 2 == 0 ? 1000.0f : 1000.0f / ratio;
            bodies.push_back(world.create(def));
            if (i == 0) continue;
            JointBodies joined{.a = bodies[bodies.size() - 2], .b = bodies.back()};
            joined.frameA = {{0.25f, 0, 0}, {}}, joined.frameB = {{-0.25f, 0, 0}, {}};
            joints.push_back(world.create(BallDef{.bodies = joined}));
        }
    }
    float largestGap(const World& world) const {
        float gap = 0;
        for (const JointId joint : joints) gap = std::max(gap, world.state(joint).gap);
        return gap;
    }
};

WorldSettings inSpace() {
    WorldSettings settings = withoutSleep();
    settings.gravity = {};
    settings.solver = SolverChoice::iterative;
    return settings;
}

/// Σ m x / Σ m, m.
DVec3 centerOf(const World& world, const std::vector<BodyId>& bodies) {
    DVec3 sum{};
    double mass = 0;
    for (const BodyId body : bodies) {
        const auto m = static_cast<double>(world.mass(body).mass);
        sum = sum + m * world.centerOfMass(body);
        mass += m;
    }
    return (1 / mass) * sum;
}

/// kg m²/s, about the origin.
DVec3 momentOf(const World& world, const std::vector<BodyId>& bodies) {
    DVec3 sum{};
    for (const BodyId body : bodies)
        sum = sum + DVec3{cross(toVec3(world.centerOfMass(body)), world.mass(body).mass * world.linearVelocity(body)) +
                          angularMomentum(world, body)};
    return sum;
}

/// The least way in the metric of the masses has no part that all bodies share.
TEST(JointClosing, MovesNoCentreOfMassAndKeepsAngularMomentum) {
    World world{inSpace()};
    const Row row(world, 6, 50);
    Pose pose = world.pose(row.bodies[3]);
    pose.position = pose.position + DVec3{0.05, 0.1, -0.08};
    world.setPose(row.bodies[3], pose);
    // Some turning that all share: places that are closed change its angular momentum, speeds give that back.
    for (const BodyId body : row.bodies) {
        const Vec3 w{0.2f, 0.3f, -0.1f};
        world.setVelocity(body, cross(w, toVec3(world.centerOfMass(body) - DVec3{0, 5, 0})), w);
    }
    const DVec3 before = centerOf(world, row.bodies), moment = momentOf(world, row.bodies);
    Vec3 momentum;
    for (const BodyId body : row.bodies) momentum += world.mass(body).mass * world.linearVelocity(body);
    float mass = 0;
    for (const BodyId body : row.bodies) mass += world.mass(body).mass;

    world.step(kDt);

    EXPECT_EQ(world.stats().jointsClosed, 1u);
    EXPECT_LE(row.largestGap(world), 0.01f * 0.4f);
    const DVec3 after = before + DVec3{(static_cast<float>(kDt) / mass) * momentum};
    // Of what bodies move in a step, some 0.2 m, single precision rounds 2⁻²³ in each of a dozen sums.
    EXPECT_LE(length(toVec3(centerOf(world, row.bodies) - after)), 1e-6);
    // Joints that are 14 cm open are pulled with 30 m/s before they are closed: their impulses are rounded to 1e-7 of
    // that.
    EXPECT_LE(length(toVec3(momentOf(world, row.bodies) - moment)), 1e-3 * length(toVec3(moment)));
}

/// Rows give way by 10⁻⁶ of the inverse mass of what is lightest: where that is a link between bodies of 10⁸ times its
/// mass, they would give way to all that is open, round by round.
TEST(JointClosing, ClosesALightLinkBetweenBodiesOfAHundredMillionTimesItsMass) {
    World world{inSpace()};
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    constexpr float kHalf[] = {0.5f, 0.1f, 0.5f};
    constexpr float kDensity[] = {1e6f, 1.25f, 1e6f};  // 10⁶ kg, 0.01 kg
    for (std::size_t i = 0; i < 3; ++i) {
        BodyDef def = bodyDef(Box{{kHalf[i], kHalf[i], kHalf[i]}}, {0.6 * static_cast<double>(i), 5, 0});
        def.shapes[0].density = kDensity[i];
        bodies.push_back(world.create(def));
        if (i == 0) continue;
        JointBodies joined{.a = bodies[i - 1], .b = bodies[i]};
        joined.frameA.position = {kHalf[i - 1], 0, 0}, joined.frameB.position = {-kHalf[i], 0, 0};
        joints.push_back(world.create(BallDef{.bodies = joined}));
    }
    world.setPose(bodies[2], {{1.25, 5, 0}, {}});
    const DVec3 before = centerOf(world, bodies);
    world.step(kDt);
    for (const JointId joint : joints) EXPECT_LE(world.state(joint).gap, 0.02f * 2 * kHalf[1]);
    EXPECT_LE(length(toVec3(centerOf(world, bodies) - before)), 1e-6f);
}

/// Links that lie nearly along the line by which they were torn apart would have to turn by many radians to close it to
/// first order, which the metric of the masses prefers to lifting what hangs from them. They go straight instead.
TEST(JointClosing, LiftsAHeavyBallRatherThanTurningTheTornLinksThatHoldIt) {
    constexpr int kLinks = 10;
    constexpr float kHalf = 0.1f, kTurn = 0.1f;
    for (const float ratio : {1.0f, 30.0f, 1000.0f}) {
        World world(withoutSleep());
        std::vector<BodyId> bodies;
        std::vector<JointId> joints;
        for (int i = 0; i <= kLinks; ++i) {
            const Shape link = Box{{0.02f, kHalf, 0.02f}}, ball = Sphere{kHalf};
            BodyDef def = bodyDef(i == kLinks ? ball : link, {0, 10 - (2 * i + 1) * 0.1, 0});
            def.shapes[0].filter.mask = 0;
            if (i == kLinks) def.shapes[0].density *= ratio * massOf(link, 1).mass / massOf(ball, 1).mass;
            bodies.push_back(world.create(def));
            JointBodies joined{.a = i == 0 ? BodyId{} : bodies[bodies.size() - 2], .b = bodies.back()};
            joined.frameA.position = i == 0 ? Vec3{0, 10, 0} : Vec3{0, -kHalf, 0};
            joined.frameB.position = {0, kHalf, 0};
            joints.push_back(world.create(BallDef{.bodies = joined}));
        }
        for (int i = 0; i <= kLinks; ++i)
            world.setPose(bodies[static_cast<std::size_t>(i)],
                          {{0, 10 - (2 * i + 1) * 0.12, 0}, rotationAbout({0, 0, 1}, i % 2 == 0 ? kTurn : -kTurn)});
        world.step(kDt);
        float gap = 0;
        for (const JointId joint : joints) gap = std::max(gap, world.state(joint).gap);
        EXPECT_LE(gap, 0.01f * 2 * kHalf) << "ratio " << ratio;
    }
}

/// Whatever strikes it, and however unlike its bodies are: but for a fiftieth of a body's size and for ½ θ² r of what
/// turns by θ in a substep.
TEST(JointClosing, NoStepLeavesAJointOfAStruckRowOpen) {
    for (const float ratio : {1.0f, 20.0f, 200.0f})
        for (const float speed : {5.0f, 50.0f, 200.0f}) {
            World world{inSpace()};
            const float h = static_cast<float>(kDt) / static_cast<float>(world.settings().substeps);
            const Row row(world, 8, ratio);
            world.setVelocity(row.bodies[3], {0, speed, 0.3f * speed}, {});
            for (int i = 0; i < 120; ++i) {
                world.step(kDt);
                for (std::size_t j = 0; j < row.joints.size(); ++j) {
                    const auto turns = [&](BodyId body) {
                        return 0.5f * h * h * lengthSquared(world.angularVelocity(body)) * 0.25f;
                    };
                    ASSERT_LE(world.state(row.joints[j]).gap,
                              1.001f * (0.02f * 0.4f + turns(row.bodies[j]) + turns(row.bodies[j + 1])))
                        << ratio << " at " << speed << " m/s, step " << i;
                }
            }
        }
}

/// Balls on arms longer than they are, in a row that folds: those that no joint holds to each other are apart.
struct Beads {
    static constexpr float kRadius = 0.2f, kArm = 0.25f;
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;

    Beads(World& world, int count) {
        for (int i = 0; i < count; ++i) {
            bodies.push_back(world.create(bodyDef(Sphere{kRadius}, {2.0 * kArm * i, 5, 0})));
            if (i == 0) continue;
            JointBodies joined{.a = bodies[bodies.size() - 2], .b = bodies.back()};
            joined.frameA = {{kArm, 0, 0}, {}}, joined.frameB = {{-kArm, 0, 0}, {}};
            joints.push_back(world.create(BallDef{.bodies = joined}));
        }
    }
    /// m, by which two balls that no joint holds together overlap.
    double deepest(const World& world) const {
        double deepest = 0;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            for (std::size_t j = i + 2; j < bodies.size(); ++j)
                deepest = std::max(deepest, 2.0 * static_cast<double>(kRadius) -
                                                static_cast<double>(length(relative(world.centerOfMass(bodies[i]),
                                                                                    world.centerOfMass(bodies[j])))));
        return deepest;
    }
};

/// What closes a joint may not push a part into another: both are closed up to a fiftieth of the size.
TEST(JointClosing, DrivesNoPartIntoAnother) {
    std::mt19937 random(18);
    const auto number = [&](float from, float to) { return std::uniform_real_distribution<float>(from, to)(random); };
    for (int run = 0; run < 60; ++run) {
        World world{inSpace()};
        const Beads row(world, 4 + run % 9);
        const float speed = std::exp(number(std::log(3.0f), std::log(60.0f)));
        for (const BodyId body : row.bodies)
            world.setVelocity(body, {number(-1, 1) * speed, number(-1, 1) * speed, number(-1, 1) * speed}, {});
        for (int i = 0; i < 120; ++i) {
            world.step(kDt);
            ASSERT_LE(row.deepest(world), 0.02 * 2 * static_cast<double>(Beads::kRadius))
                << row.bodies.size() << " at " << speed << " m/s, run " << run << ", step " << i;
        }
    }
}

/// The same of limits, which are closed up to a fiftieth of a radian, and left by a tenth where that cannot be.
TEST(JointClosing, NoStepLeavesALimitPassed) {
    constexpr float kLimit = 0.3f, kTorn = 0.05f;
    for (const float ratio : {1.0f, 20.0f})
        for (const float speed : {5.0f, 20.0f, 80.0f}) {
            World world{inSpace()};
            Row row(world, 8, ratio);
            for (JointId& joint : row.joints) {
                BallDef def = std::get<BallDef>(world.def(joint));
                def.swingLimit = kLimit;
                def.twistLimit = Range{-kLimit, kLimit};
                world.setDef(joint, def);
            }
            world.setVelocity(row.bodies[3], {0, speed, 0.3f * speed}, {0.5f * speed, 0, 0});
            for (int i = 0; i < 120; ++i) {
                world.step(kDt);
                for (std::size_t j = 1; j < row.bodies.size(); ++j) {
                    const Quat turn =
                        conjugate(world.pose(row.bodies[j - 1]).rotation) * world.pose(row.bodies[j]).rotation;
                    const double swing = 2 * std::atan2(std::hypot(asDouble(turn.y), asDouble(turn.z)),
                                                        std::hypot(asDouble(turn.w), asDouble(turn.x)));
                    const double twist = 2 * std::atan2(asDouble(turn.x), asDouble(turn.w));
                    ASSERT_LE(swing, kLimit + kTorn) << ratio << " at " << speed << " m/s, step " << i;
                    ASSERT_LE(std::abs(std::remainder(twist, 2 * 3.14159265358979)), kLimit + kTorn)
                        << ratio << " at " << speed << " m/s, step " << i;
                }
            }
        }
}

/// What a step has thrown about ends it no more torn than it began, keeps its momentum and gains no energy.
TEST(JointClosing, CutsAStepShortThatTearsALoop) {
    std::uint64_t cut = 0;
    for (float speed = 200; speed <= 1000; speed += 50) {
        World world{inSpace()};
        Row row(world, 8, 200);
        JointBodies across{.a = row.bodies[1], .b = row.bodies[6]};
        across.frameA = {{1.25f, 0, 0}, {}}, across.frameB = {{-1.25f, 0, 0}, {}};
        row.joints.push_back(world.create(BallDef{.bodies = across}));
        world.setVelocity(row.bodies[3], {0, speed, 90}, {0, 0, 40});
        world.setVelocity(row.bodies[4], {0, -speed, 20}, {0, 70, 0});
        Vec3 momentum;
        double energy = 0;
        for (const BodyId body : row.bodies) {
            momentum += world.mass(body).mass * world.linearVelocity(body);
            energy += kineticEnergy(world, body);
        }
        for (int i = 0; i < 60; ++i) {
            world.step(kDt);
            Vec3 now;
            double sum = 0;
            for (const BodyId body : row.bodies) {
                now += world.mass(body).mass * world.linearVelocity(body);
                sum += kineticEnergy(world, body);
            }
            ASSERT_LE(row.largestGap(world), 0.1f * 0.4f) << i << " at " << speed;
            ASSERT_LE(length(now - momentum), 1e-3f * length(momentum)) << i << " at " << speed;
            ASSERT_LE(sum, 1.005 * energy) << i << " at " << speed;
        }
        cut += world.stats().stepsCut;
    }
    EXPECT_GT(cut, 0u);
}

/// Speeds that open joints are taken, none is given.
TEST(JointClosing, AddsNoKineticEnergy) {
    World world{inSpace()};
    const Row row(world, 8, 20);
    world.setVelocity(row.bodies[3], {0, 100, 30}, {});
    const auto energy = [&] {
        double sum = 0;
        for (const BodyId body : row.bodies) sum += kineticEnergy(world, body);
        return sum;
    };
    const double start = energy();
    for (int i = 0; i < 120; ++i) {
        world.step(kDt);
        ASSERT_LE(energy(), 1.005 * start) << i;  // the guard's room
    }
    EXPECT_GT(world.stats().jointsClosed, 0u);
}

/// What hangs from a hand that moves keeps up with it: joints are at rest against the hand, not against the world.
TEST(JointClosing, FollowsTheHandThatItHangsFrom) {
    for (const double speed : {2.0, 20.0}) {
        World world{inSpace()};
        const Row row(world, 6, 20);
        BodyDef hand;
        hand.type = BodyType::kinematic;
        hand.pose.position = {-0.25, 5, 0};
        const BodyId held = world.create(hand);
        JointBodies joined{.a = held, .b = row.bodies[0]};
        joined.frameB = {{-0.25f, 0, 0}, {}};
        world.create(BallDef{.bodies = joined});
        // Along the row, which stays straight and must be as fast when it has been put aside by 3 cm and closed.
        world.setVelocity(held, {static_cast<float>(-speed), 0, 0}, {});
        for (const BodyId body : row.bodies) world.setVelocity(body, {static_cast<float>(-speed), 0, 0}, {});
        Pose pose = world.pose(row.bodies[0]);
        pose.position.x += 0.03;
        world.setPose(row.bodies[0], pose);

        world.step(kDt);

        EXPECT_GT(world.stats().jointsClosed, 0u) << speed;
        for (const BodyId body : row.bodies) EXPECT_NEAR(world.linearVelocity(body).x, -speed, 1e-3 * speed) << speed;
    }
}

/// What sweeps close by themselves is left to them.
TEST(JointClosing, LeavesAloneWhatIsClosed) {
    World world{withoutSleep()};
    const Chain chain(world, 8, 1);
    for (int i = 0; i < 240; ++i) world.step(kDt);
    EXPECT_EQ(world.stats().jointsClosed, 0u);
}

/// A hinge or the turn of a cylindrical joint, whose one coordinate has come to 5 rad.
AxesJointSim turned(JointKind kind) {
    AxesJointSim joint;
    joint.kind = kind;
    joint.axes.freeRows = hasAxes(kind) ? 1 : 0;
    AxisRows& axis = hasAxes(kind) ? joint.axes.axis[0] : joint.axis;
    for (const float angle : {0.0f, 2.0f, -2.28f, -1.28f}) track(axis, angle);
    return joint;
}

double coordinateOf(const AxesJointSim& joint) {
    const AxisRows& axis = hasAxes(joint.kind) ? joint.axes.axis[0] : joint.axis;
    return unwrapped(axis, axis.angle.last);
}

/// A step that came to nothing may have turned a body many times, or to an angle that is no number.
TEST(JointCounts, AreThoseOfTheStepsBeginningWhereItIsTakenBack) {
    for (const JointKind kind : {JointKind::hinge, JointKind::cylindrical}) {
        AxesJointSim joint = turned(kind);
        const double before = coordinateOf(joint);
        EXPECT_NEAR(before, 5.0, 0.01);
        keepCounts(joint);
        AxisRows& axis = hasAxes(kind) ? joint.axes.axis[0] : joint.axis;
        for (const float angle : {2.0f, -2.0f, std::numeric_limits<float>::quiet_NaN()}) track(axis, angle);
        restoreCounts(joint);
        EXPECT_EQ(coordinateOf(joint), before);
    }
}

}  // namespace
}  // namespace ragtop
