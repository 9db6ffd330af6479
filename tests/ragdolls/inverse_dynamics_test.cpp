#include "ragtop/inverse_dynamics.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/heap_counter.h"
#include "human.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

const RagdollDef& frictionless() {
    static const RagdollDef def = makeRagdoll(HumanRig().skeleton, {.bodyMass = 75, .jointFriction = 0});
    return def;
}

/// Two rods that hang from a pin, each 1 m long, on balls.
RagdollDef rods() {
    RagdollDef def;
    for (int i = 0; i < 2; ++i) {
        RagdollPart part{
            .name = i == 0 ? "upper" : "lower", .bone = i, .bind = {{0, -1.0f * static_cast<float>(i), 0}, {}}};
        part.shape = Capsule{0.05f, 0.4f};
        part.frame = {{0, -0.5f, 0}, {}};
        part.mass = 2;
        def.parts.push_back(part);
        def.bones.push_back({.name = part.name, .parent = i - 1, .part = i});
    }
    def.joints.push_back({0, 1, BallDef{.bodies = {.frameA = {{0, -1, 0}, {}}}}});
    return def;
}

/// A compound pendulum that is held level takes m g l, and (I + m l²) α more to be turned upwards by α.
TEST(InverseDynamics, HoldAndTurnARodAsTheCompoundPendulumSays) {
    World world;
    const RagdollDef def = rods();
    std::vector<Pose> pose{{{0, 0, 0}, {}}, {{0, -1, 0}, rotationAbout({0, 0, 1}, 0.5f * kPi)}};
    Ragdoll body(world, def, pose);
    const InverseDynamics dynamics(world, body);
    std::vector<Vec3> torques(1);
    dynamics.torques({}, {}, torques);
    EXPECT_NEAR(torques[0].z, 2 * 9.81f * 0.5f, 1e-3f);
    std::vector<PartMotion> motion(2);
    const Vec3 alpha[] = {{0, 0, 3}};
    dynamics.accelerate({}, alpha, motion);
    EXPECT_NEAR(motion[1].linear.y, 3 * 0.5f, 1e-5f);
    dynamics.torques(motion, {}, torques);
    const MassProperties mass = world.mass(body.bodies()[1]);
    EXPECT_NEAR(torques[0].z, 2 * 9.81f * 0.5f + (mass.inertia.cx.x + 2 * 0.25f) * 3, 2e-3f);
}

/// One that whirls about its pin without a torque pulls at it by m ω² l.
TEST(InverseDynamics, KnowTheAccelerationOfWhatWhirls) {
    World world(WorldSettings{.gravity = {}});
    Ragdoll body(world, rods());
    world.setVelocity(body.bodies()[1], cross({0, 0, 4}, {0, -0.5f, 0}), {0, 0, 4});
    const InverseDynamics dynamics(world, body);
    std::vector<PartMotion> motion(2);
    const Vec3 none[] = {{}};
    dynamics.accelerate({}, none, motion);
    EXPECT_NEAR(motion[1].linear.y, 16 * 0.5f, 1e-5f);
    std::vector<Vec3> torques(1);
    const PartMotion root = dynamics.torques(motion, {}, torques);
    EXPECT_LT(length(torques[0]), 1e-5f);
    EXPECT_NEAR(root.linear.y, 2 * 16 * 0.5f, 1e-4f);
}

TEST(InverseDynamics, AskNothingOfWhatFallsAndTheWeightOfWhatStands) {
    World world;
    Ragdoll body(world, frictionless());
    const InverseDynamics dynamics(world, body);
    std::vector<Vec3> torques(frictionless().joints.size());
    const std::vector<PartMotion> falling(frictionless().parts.size(), PartMotion{{0, -9.81f, 0}, {}});
    PartMotion root = dynamics.torques(falling, {}, torques);
    EXPECT_LT(length(root.linear) + length(root.angular), 1e-3f);
    for (const Vec3& torque : torques) EXPECT_LT(length(torque), 1e-3f);
    root = dynamics.torques({}, {}, torques);
    EXPECT_NEAR(root.linear.y, 75 * 9.81f, 0.01f);
    // On one hip.
    std::vector<PartMotion> outside(frictionless().parts.size());
    outside[0] = {{0, 75 * 9.81f, 0}, {}};
    root = dynamics.torques({}, outside, torques);
    EXPECT_LT(length(root.linear), 0.01f);
}

/// What hangs on a hand is borne by all joints up to the root.
TEST(InverseDynamics, BearWhatIsCarried) {
    World world;
    Ragdoll body(world, frictionless());
    InverseDynamics dynamics(world, body);
    std::vector<Vec3> before(frictionless().joints.size()), after(frictionless().joints.size());
    dynamics.torques({}, {}, before);
    std::size_t hand = 0;
    while (frictionless().parts[hand].role != BodyRole::hand) ++hand;
    const DVec3 at = world.centerOfMass(body.bodies()[hand]);
    const BodyId load = world.create(DynamicBody{.shape = Sphere{0.1f}, .position = at});
    const Frame place{inverseTransformPoint(world.pose(body.bodies()[hand]), at), {}};
    world.create(BallDef{.bodies = {.a = body.bodies()[hand], .b = load, .frameA = place}});
    dynamics.look();
    const float more = world.mass(load).mass;
    EXPECT_NEAR(dynamics.mass(), 75 + more, 1e-3f);
    dynamics.torques({}, {}, after);
    for (int part = static_cast<int>(hand); part > 0;) {
        const InverseDynamics::Part& each = dynamics.parts()[static_cast<std::size_t>(part)];
        const Vec3 lever = relative(at, each.anchor);
        const auto joint = static_cast<std::size_t>(each.joint);
        EXPECT_LT(length(after[joint] - before[joint] - cross(lever, {0, more * 9.81f, 0})), 0.01f);
        part = each.parent;
    }
}

/// The torques that a motion takes, given to the joints of a body in flight, are that motion in the world itself.
TEST(InverseDynamics, GiveTheMotionThatTheWorldMakesOfThem) {
    RagdollDef def = frictionless();
    for (RagdollJoint& joint : def.joints) {
        if (auto* ball = std::get_if<BallDef>(&joint.joint)) ball->swingLimit.reset(), ball->twistLimit.reset();
        // Balls all, so that any acceleration is possible.
        if (auto* hinge = std::get_if<HingeDef>(&joint.joint)) joint.joint = BallDef{.bodies = hinge->bodies};
    }
    // Of first order in the step, which turns the torques' axes.
    constexpr double kStep = 3e-6;
    std::mt19937 random(7);
    const auto any = [&](float most) {
        std::uniform_real_distribution<float> in(-most, most);
        return Vec3{in(random), in(random), in(random)};
    };
    World world(WorldSettings{.substeps = 1, .sleeping = false, .solver = SolverChoice::direct});
    Ragdoll body(world, def, Pose{{0, 5, 0}, {}});
    // Moving joints, compatible with each other: spins from the root outwards.
    InverseDynamics dynamics(world, body);
    world.setVelocity(body.bodies()[0], {}, any(2));
    for (std::size_t i = 1; i < def.parts.size(); ++i) {
        const InverseDynamics::Part& part = dynamics.parts()[i];
        const BodyId carrier = body.bodies()[static_cast<std::size_t>(part.parent)];
        const Vec3 spin = world.angularVelocity(carrier) + any(2);
        world.setVelocity(body.bodies()[i],
                          world.velocityAt(carrier, part.anchor) + cross(spin, relative(part.center, part.anchor)),
                          spin);
    }
    world.step(kStep);
    dynamics.look();
    std::vector<Vec3> joints(def.joints.size()), torques(def.joints.size());
    for (Vec3& each : joints) each = any(20);
    std::vector<PartMotion> motion(def.parts.size());
    // What the root lacks is given from outside.
    dynamics.accelerate({}, joints, motion);
    const PartMotion root = dynamics.torques(motion, {}, torques);
    const auto step = [&] {
        world.applyForce(body.bodies()[0], root.linear, world.centerOfMass(body.bodies()[0]));
        world.applyTorque(body.bodies()[0], root.angular);
        for (std::size_t i = 0; i < joints.size(); ++i) {
            world.applyTorque(body.bodies()[static_cast<std::size_t>(def.joints[i].parent)], -torques[i]);
            world.applyTorque(body.bodies()[static_cast<std::size_t>(def.joints[i].child)], torques[i]);
        }
        world.step(kStep);
    };
    step();
    std::vector<Vec3> before;
    for (const BodyId part : body.bodies()) before.push_back(world.angularVelocity(part));
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i) step();
    for (std::size_t i = 0; i < def.parts.size(); ++i) {
        const Vec3 gained =
            (1 / static_cast<float>(kSteps * kStep)) * (world.angularVelocity(body.bodies()[i]) - before[i]);
        EXPECT_LT(length(gained - motion[i].angular), 0.02f * (20 + length(motion[i].angular))) << def.parts[i].name;
    }
}

TEST(InverseDynamics, LookWithoutMemory) {
    World world;
    Ragdoll body(world, frictionless());
    InverseDynamics dynamics(world, body);
    std::vector<Vec3> torques(frictionless().joints.size());
    const long before = heapCalls();
    dynamics.look();
    dynamics.torques({}, {}, torques);
    EXPECT_EQ(heapCalls(), before);
}

}  // namespace
}  // namespace ragtop
