// What stiff springs hold upright, and hardly moves, takes several substeps at once (world/multirate.h).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <variant>
#include <vector>

#include "without_saving.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

/// A foot of 2 kg on the ground, and on its ankle a rod of 8 kg and 1 m that leans, held by a spring far stiffer than
/// the foot is heavy.
class Standing {
public:
    static constexpr double kStiffness = 4000, kMass = 8, kArm = 0.5;  ///< N m/rad, kg, m to its centre of mass
    static constexpr double kLean = 0.05;                              ///< rad, where the spring has no torque

    explicit Standing(BodyType ground = BodyType::fixed, const WorldSettings& settings = withoutSleep())
        : world_(settings) {
        BodyDef floor = bodyDef(Box{{10, 0.5f, 10}}, {0, -0.5, 0});
        floor.type = ground;
        floor_ = world_.create(floor);
        BodyDef foot = bodyDef(Box{{0.2f, 0.02f, 0.15f}}, {0, 0.02, 0});
        foot.shapes[0].density = 2 / (0.4f * 0.04f * 0.3f);
        foot.shapes[0].filter.group = -1;
        foot_ = world_.create(foot);
        const auto half = static_cast<float>(kArm);
        BodyDef rod = bodyDef(Box{{0.03f, half, 0.03f}}, {0, 0.04 + kArm, 0});
        rod.shapes[0].density = static_cast<float>(kMass) / (0.06f * 2 * half * 0.06f);
        rod.shapes[0].filter.group = -1;
        rod_ = world_.create(rod);
        HingeDef ankle;
        const Quat axis = rotationAbout({0, 1, 0}, -0.5f * kPi);  // about z
        ankle.bodies = {.a = foot_, .b = rod_, .frameA = {{0, 0.02f, 0}, axis}, .frameB = {{0, -half, 0}, axis}};
        ankle.spring = Spring{.stiffness = static_cast<float>(kStiffness), .damping = 200};
        ankle.target = static_cast<float>(kLean);
        ankle_ = world_.create(ankle);
    }
    void step(double seconds) { run(world_, seconds); }
    double angle() const { return static_cast<double>(world_.state(ankle_).coordinate); }
    /// Newton's, of the last step.
    int iterations() const {
        int sum = 0;
        for (const auto& island : world_.stats().islands) sum += island.iterations;
        return sum;
    }
    /// Of the spring's torque k (θ − θ₀) and the rod's weight m g l sin θ.
    static double restingAngle(double gravity) {
        double angle = kLean;
        for (int i = 0; i < 50; ++i) angle = kLean + kMass * gravity * kArm * std::sin(angle) / kStiffness;
        return angle;
    }

    World world_;
    BodyId floor_, foot_, rod_;
    JointId ankle_;
};

TEST(StandingSprings, LeanAsStaticsSaysHoweverLongSubstepsAre) {
    const double expected = Standing::restingAngle(static_cast<double>(length(WorldSettings{}.gravity)));
    Standing all;
    all.step(8);
    EXPECT_NEAR(all.angle(), expected, 1e-4 * expected);
    const Without without(&Economy::calmTrees);
    Standing one;
    one.step(8);
    EXPECT_NEAR(one.angle(), expected, 1e-4 * expected);
    EXPECT_LE(4 * all.iterations(), one.iterations() + 3);
    EXPECT_GT(all.iterations(), 0);
}

/// The torque that a joint tells is that of the whole step, and so is the force of contacts.
TEST(StandingSprings, TellTheForcesThatTheyBear) {
    Standing stands;
    stands.step(8);
    const double gravity = static_cast<double>(length(WorldSettings{}.gravity));
    double force = 0;
    const auto add = [&](const Contact& contact) { force += static_cast<double>(contact.normalForce); };
    stands.world_.forEachContact(stands.foot_, std::cref(add));
    EXPECT_NEAR(force, (2 + Standing::kMass) * gravity, 1e-3 * (2 + Standing::kMass) * gravity);
    EXPECT_NEAR(static_cast<double>(length(stands.world_.state(stands.ankle_).force)), Standing::kMass * gravity,
                1e-3 * Standing::kMass * gravity);
}

/// rad, the farthest that a blow of 3 N s on the rod turns it within half a second.
double turnedByABlow() {
    Standing stands;
    stands.step(8);
    const double rest = stands.angle();
    stands.world_.applyImpulse(stands.rod_, {-3, 0, 0}, stands.world_.pose(stands.rod_).position);
    double most = 0;
    for (int i = 0; i < 30; ++i) {
        stands.step(kDt);
        most = std::max(most, std::fabs(stands.angle() - rest));
    }
    return most;
}

TEST(StandingSprings, AnswerABlowSubstepBySubstep) {
    const double all = turnedByABlow();
    const Without without(&Economy::calmTrees);
    const double one = turnedByABlow();
    EXPECT_GT(one, 0.05 * Standing::kLean);
    EXPECT_NEAR(all, one, 1e-3 * one);
}

/// rad/s of the rod a tenth of a second after a blow has woken it, whose spring is soft by then.
Vec3 wokenOnASoftSpring() {
    Standing stands(BodyType::fixed, WorldSettings{});
    stands.step(8);
    EXPECT_FALSE(stands.world_.isAwake(stands.rod_));
    auto soft = std::get<HingeDef>(stands.world_.def(stands.ankle_));
    soft.spring = Spring{.stiffness = 60, .damping = 1};
    stands.world_.setDef(stands.ankle_, soft);
    stands.world_.applyImpulse(stands.rod_, {-3, 0, 0}, stands.world_.pose(stands.rod_).position);
    stands.step(0.1);
    return stands.world_.angularVelocity(stands.rod_);
}

/// What wakes as part of something else has no long substeps left.
TEST(StandingSprings, WokenAsSomethingElseTakeSingleSubsteps) {
    const Vec3 all = wokenOnASoftSpring();
    const Without without(&Economy::calmTrees);
    const Vec3 one = wokenOnASoftSpring();
    EXPECT_GT(length(one), 0.1f);
    EXPECT_LT(length(all - one), 1e-3f * length(one));
}

/// What is carried is looked at in every substep, however slowly the ground moves.
TEST(StandingSprings, OnGroundThatMovesTakeSingleSubsteps) {
    Standing fixed, carried(BodyType::kinematic);
    carried.world_.setVelocity(carried.floor_, {0.001f, 0, 0}, {});
    fixed.step(4);
    carried.step(4);
    EXPECT_GE(carried.iterations() + 3, 4 * fixed.iterations());
}

/// The state of a world has all that its paces depend on.
TEST(StandingSprings, GoOnFromASavedStateWithTheSameBits) {
    Standing stands;
    stands.step(0.4);
    std::vector<std::byte> saved(stands.world_.saveSize());
    stands.world_.save(saved);
    stands.step(2);
    const std::uint64_t hash = stands.world_.hash();
    stands.world_.restore(saved);
    stands.step(2);
    EXPECT_EQ(stands.world_.hash(), hash);
}

}  // namespace
}  // namespace ragtop::test
