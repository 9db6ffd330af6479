#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "constraints/joint_sim.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

constexpr double kTwoPi = 6.283185307179586;
const Quat kZAxisTurn = rotationBetween({1, 0, 0}, {0, 0, 1});

WorldSettings swept() {
    WorldSettings settings = withoutGravity();
    settings.solver = SolverChoice::iterative;
    return settings;
}

/// A thin rod of 1 m.
BodyDef rodAt(const DVec3& position) { return bodyDef(Box{{0.5f, 0.02f, 0.02f}}, position); }

double lengthOf(const DVec3& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

/// (r' − r)/h − ω × r of a turn about z; what is left out is of the order θ⁵ of ω r, 9/2 θ⁵ where arms fade.
TEST(Curving, IsWhatATurnAddsToItsFirstSpeed) {
    const float h = 1.0f / 240, radius = 0.7f;
    for (const double angle : {0.001, 0.01, 0.1, 0.2}) {
        const double w = angle / static_cast<double>(h), r = static_cast<double>(radius);
        const Vec3 found = curving<Vec3>({0, 0, static_cast<float>(w)}, {radius, 0, 0}, h);
        const double x = r * (std::cos(angle) - 1) / static_cast<double>(h);
        const double y = r * std::sin(angle) / static_cast<double>(h) - w * r;
        const double rounding = 1e-6 * w * r, bound = 4.5 * std::pow(angle, 5) * w * r + rounding;
        EXPECT_NEAR(static_cast<double>(found.x), x, bound) << angle;
        EXPECT_NEAR(static_cast<double>(found.y), y, bound) << angle;
    }
}

TEST(Curving, StaysFiniteAtAnySpeed) {
    for (const float w : {1e3f, 1e6f, 1e9f}) {
        const Vec3 found = curving<Vec3>({w, w, 0}, {1, 0, 1}, 1.0f / 240);
        EXPECT_LE(length(found), 2 * w);
    }
}

/// A rod whirls about its end. Nothing is left of ½ h ω² r, which would open the joint by 1.2 mm: only the joint's
/// spring of frequency f gives way, by the acceleration over (2 π f)², half of which acts before positions move.
TEST(SweptJoints, GiveWayToAWhirlingRodAsTheirSpringDoes) {
    constexpr float kSpin = 6;
    for (const bool hinged : {false, true}) {
        World world(swept());
        BodyDef def = rodAt({0.5, 0, 0});
        def.linearVelocity = {0, 0.5f * kSpin, 0};
        def.angularVelocity = {0, 0, kSpin};
        const BodyId rod = world.create(def);
        JointBodies bodies;
        bodies.b = rod;
        bodies.frameA = {{}, kZAxisTurn};
        bodies.frameB = {{-0.5f, 0, 0}, kZAxisTurn};
        const JointDef made = hinged ? JointDef(HingeDef{.bodies = bodies}) : JointDef(BallDef{.bodies = bodies});
        const JointId joint = world.create(made);
        run(world, 10);
        const double rate = 240 * static_cast<double>(world.settings().jointFrequency) * kTwoPi;
        const double gives = 0.5 * (0.5 * kSpin * kSpin) / (rate * rate);
        EXPECT_NEAR(static_cast<double>(world.state(joint).gap), gives, 0.1 * gives) << hinged;
        EXPECT_NEAR(static_cast<double>(world.angularVelocity(rod).z), kSpin, 1e-3 * kSpin) << hinged;
    }
}

/// What circles at the end of 0.5 m, and how far its joint has given way after ten seconds, m.
struct Whirled {
    double gives, speed, aside;
};
constexpr float kWhirl = 6, kCircle = 0.5f;
Whirled whirl(JointDef joint, bool alone) {
    World world(swept());
    BodyDef def = bodyDef(Sphere{0.1f}, {static_cast<double>(kCircle), 0, 0});
    def.linearVelocity = {0, kCircle * kWhirl, 0};
    def.angularVelocity = {0, 0, kWhirl};
    const BodyId ball = world.create(def);
    std::visit([&](auto& each) { each.bodies.b = ball; }, joint);
    world.create(joint);
    // A rope that is never taut.
    if (!alone) world.create(JointDef(DistanceDef{.bodies = {.b = ball}, .limit = Range{0, 100}}));
    run(world, 10);
    const DVec3 at = world.pose(ball).position;
    return {std::hypot(at.x, at.y) - static_cast<double>(kCircle),
            static_cast<double>(length(world.linearVelocity(ball))), at.z};
}
/// m ω² r against the stiffness m (2πf)² of the rows; half of it, as the row leaks in one of two passes.
double givesAsASpring() {
    const double rate = 240 * static_cast<double>(WorldSettings{}.jointFrequency) * kTwoPi;
    return 0.5 * static_cast<double>(kCircle * kWhirl * kWhirl) / (rate * rate);
}
std::vector<JointDef> whirlers() {
    SixDofDef locked{.bodies = {.frameA = {{}, kZAxisTurn}, .frameB = {{-kCircle, 0, 0}, kZAxisTurn}}};
    for (AxisDef* axis : {&locked.x, &locked.y, &locked.z, &locked.swingY, &locked.swingZ}) axis->limit = Range{};
    return {UniversalDef{.bodies = locked.bodies}, CylindricalDef{.bodies = locked.bodies}, locked};
}

/// The same of a ball on a rod of 0.5 m, on a ring of that radius and at the end of a travel that turns with it.
TEST(SweptJoints, GiveWayToWhatCirclesAsTheirSpringsDo) {
    std::vector<JointDef> joints = whirlers();
    joints.push_back(DistanceDef{.limit = Range{kCircle, kCircle}});
    for (const JointDef& joint : joints) {
        const Whirled found = whirl(joint, std::holds_alternative<DistanceDef>(joint));
        EXPECT_NEAR(found.gives, givesAsASpring(), 0.1 * givesAsASpring()) << joint.index();
        EXPECT_NEAR(found.speed, asDouble(kCircle * kWhirl), 0.003) << joint.index();
        EXPECT_NEAR(found.aside, 0, 1e-6) << joint.index();
    }
}

/// Joints of axes whose bodies have no other joint are solved at once, so they carry their load without giving way:
/// what is left is of fourth order in the turn θ = ω h of a substep, and single precision.
TEST(SweptJoints, OfAxesThatAreAloneCarryTheirWholeLoad) {
    const double turn = asDouble(kWhirl) / 240;
    for (const JointDef& joint : whirlers()) {
        const Whirled found = whirl(joint, true);
        EXPECT_NEAR(found.gives, 0, asDouble(kCircle) * (std::pow(turn, 4) + 1e-6)) << joint.index();
        EXPECT_NEAR(found.speed, asDouble(kCircle * kWhirl), 1e-4 * asDouble(kCircle * kWhirl)) << joint.index();
    }
}

/// A cross that begins at an end of its second angle, with 5 rad/s beyond it and turning about the first: the impact is
/// taken within the substep, so that nothing has to be brought back, which would do work against the load of the end.
TEST(SweptJoints, ThatAreAloneStopAtOnceWhereTheyBegin) {
    World world(swept());
    BodyDef def = bodyDef(Box{{0.3f, 0.1f, 0.2f}}, {0.3, 0, 0});
    def.angularVelocity = {4, 5, 0};
    def.linearVelocity = cross(def.angularVelocity, {0.3f, 0, 0});
    const BodyId body = world.create(def);
    UniversalDef cardan{.bodies = {.b = body, .frameB = {{-0.3f, 0, 0}, {}}}};
    cardan.second.limit = Range{-1, 0};
    const JointId joint = world.create(JointDef(cardan));
    world.step(kDt);
    const double before = kineticEnergy(world, body);
    // Of the impact, the bend of the way that ends in it is left: ½ h ω² of the speed.
    EXPECT_GT(world.state(joint).limitMargin, -0.5f * 41 / (240.0f * 240.0f));
    run(world, 2, kDt, [&] { EXPECT_LT(kineticEnergy(world, body), before * (1 + 1e-5)); });
}

/// A cross between the world and a body of three different moments turns about two axes that change each other's
/// moment. What speeds are short of by their projection onto new axes is of second order in ω h = 0.028 and goes to and
/// fro.
TEST(SweptJoints, KeepTheEnergyOfUniversalJoints) {
    World world(swept());
    BodyDef def = bodyDef(Box{{0.3f, 0.1f, 0.2f}}, {0.3, 0, 0});
    def.angularVelocity = {3, 6, 0};
    def.linearVelocity = cross(def.angularVelocity, {0.3f, 0, 0});
    const BodyId body = world.create(def);
    world.create(JointDef(UniversalDef{.bodies = {.b = body, .frameB = {{-0.3f, 0, 0}, {}}}}));
    const double before = kineticEnergy(world, body);
    for (int i = 0; i < 600; ++i) {
        world.step(1.0 / 60);
        ASSERT_NEAR(kineticEnergy(world, body), before, 8e-4 * before) << i;
    }
}

/// Velocities that a new joint does not allow are lost as in an impact: both momenta stay, the joint does not open, and
/// no more energy comes back.
TEST(NewJoints, TakeAtOnceWhatDoesNotFit) {
    World world(withoutGravity());
    BodyDef first = rodAt({-0.5, 0, 0}), second = rodAt({0.5, 0, 0});
    first.angularVelocity = {1, -2, 3}, second.angularVelocity = {-2, 4, 5};
    second.linearVelocity = {0, 1, 2};
    UniversalDef def;
    def.bodies.a = world.create(first), def.bodies.b = world.create(second);
    def.bodies.frameA = {{0.5f, 0, 0}, {}}, def.bodies.frameB = {{-0.5f, 0, 0}, {}};
    const JointId joint = world.create(JointDef(def));
    world.step(1.0 / 60);
    EXPECT_LT(world.state(joint).gap, 1e-4f);
    const Vec3 xA = rotate(world.pose(def.bodies.a).rotation, {1, 0, 0});
    const Vec3 yB = rotate(world.pose(def.bodies.b).rotation, {0, 1, 0});
    EXPECT_NEAR(static_cast<double>(dot(xA, yB)), 0, 1e-4);
    const DVec3 sum = DVec3(world.linearVelocity(def.bodies.a)) + DVec3(world.linearVelocity(def.bodies.b));
    EXPECT_LT(lengthOf(sum - DVec3{0, 1, 2}), 1e-5);
}

/// What fits already keeps every bit of its velocity.
TEST(NewJoints, LeaveWhatFits) {
    World world(withoutGravity());
    BodyDef def = rodAt({0.5, 0, 0});
    def.angularVelocity = {0, 0, 3};
    def.linearVelocity = {0, 1.5f, 0};
    const BodyId rod = world.create(def);
    JointSim joint;
    joint.stateB = 1;
    BallDef ball;
    ball.bodies.frameB = {{-0.5f, 0, 0}, {}};
    compileJoint(JointDef(ball), {}, {}, joint);
    BodyState states[2];
    states[1].v = world.linearVelocity(rod), states[1].w = world.angularVelocity(rod);
    states[1].invMass = 1;
    BodyInertia inertia[2];
    inertia[1].xx = inertia[1].yy = inertia[1].zz = 12;
    placeJoint(joint, {{0.5f, 0, 0}, {}, {}}, states, inertia);
    EXPECT_FALSE(fitVelocities(joint, states, inertia));
    EXPECT_EQ(states[1].v, (Vec3{0, 1.5f, 0}));
    states[1].v = {0, 1, 0};
    EXPECT_TRUE(fitVelocities(joint, states, inertia));
    // The impulse λ at the end moves the middle and slows the turning: v + λ = ½ (ω − 6 λ).
    EXPECT_NEAR(states[1].v.y, 1.125, 1e-6);
    EXPECT_NEAR(states[1].w.z, 2.25, 1e-6);
    EXPECT_EQ(warmStartImpulse(joint).linear, Vec3{});
}

/// Tension does not resist turns about its own line, however easy they are: nothing is taken from the momentum of two
/// thin rods that whirl on one joint.
TEST(SweptJoints, LeaveThinRodsTheirMomentum) {
    World world(swept());
    BodyDef first = rodAt({-0.5, 0, 0}), second = rodAt({0.5, 0, 0});
    first.angularVelocity = second.angularVelocity = {0, 0, 20};
    first.linearVelocity = {0, -10, 0}, second.linearVelocity = {0, 10, 0};
    const BodyId a = world.create(first), b = world.create(second);
    BallDef def;
    def.bodies.a = a, def.bodies.b = b;
    def.bodies.frameA = {{0.5f, 0, 0}, {}}, def.bodies.frameB = {{-0.5f, 0, 0}, {}};
    world.create(def);
    const auto momentum = [&] {
        DVec3 sum;
        for (const BodyId body : {a, b}) {
            const DVec3 x = world.pose(body).position;
            sum = sum + DVec3(cross(toVec3(x), world.linearVelocity(body)));
            sum = sum + (0.2504 / 3) * DVec3{0, 0, static_cast<double>(world.angularVelocity(body).z)};
        }
        return sum;
    };
    const DVec3 before = momentum();
    run(world, 10);
    EXPECT_LT(lengthOf(momentum() - before), 1e-4 * lengthOf(before));
}

}  // namespace
}  // namespace ragtop::test
