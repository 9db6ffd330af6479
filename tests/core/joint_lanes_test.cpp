#include <gtest/gtest.h>

#include <cstring>
#include <memory_resource>
#include <string>

#include "joint_rig.h"
#include "scenes.h"

namespace ragtop::test {
namespace {

struct Kind {
    const char* name;
    JointDef (*make)(scenes::Dice& dice);
};

const Stop kBouncy{.restitution = 0.5f};
const Bearing kBearing{.breakaway = 0.5f, .viscous = 0.25f, .coefficient = 0.25f, .pinRadius = 0.125f};

BallDef limitedBall(scenes::Dice& dice) {
    BallDef def;
    def.swingLimit = dice.between(0.25f, 1.5f);
    def.twistLimit = Range{-dice.between(0.125f, 2), dice.between(0.125f, 2)};
    return def;
}
HingeDef limitedHinge(scenes::Dice& dice) {
    HingeDef def;
    def.limit = Range{-dice.between(0.125f, 8), dice.between(0.125f, 8)};
    return def;
}

/// Every structure that lanes have rows for.
const Kind kKinds[] = {
    {"ball", [](scenes::Dice&) -> JointDef { return BallDef{}; }},
    {"ball with limits and friction",
     [](scenes::Dice& dice) -> JointDef {
         BallDef def = limitedBall(dice);
         def.friction = dice.between(0.125f, 4);
         return def;
     }},
    {"ball with bouncing limits and a bearing",
     [](scenes::Dice& dice) -> JointDef {
         BallDef def = limitedBall(dice);
         def.stop = kBouncy;
         def.bearing = kBearing;
         return def;
     }},
    {"ball with a spring",
     [](scenes::Dice& dice) -> JointDef {
         BallDef def;
         def.spring = Spring{.stiffness = dice.between(1, 1000), .damping = dice.between(0, 20)};
         def.target = dice.rotation();
         def.maxSpringTorque = dice.between(1, 100);
         return def;
     }},
    {"ball with a tuned spring and limits",
     [](scenes::Dice& dice) -> JointDef {
         BallDef def = limitedBall(dice);
         def.spring = Spring{.frequency = dice.between(0.5f, 60), .dampingRatio = dice.between(0, 3)};
         return def;
     }},
    {"ball that may break", [](scenes::Dice&) -> JointDef { return BallDef{.bodies = {.breakForce = 1e6f}}; }},
    {"hinge", [](scenes::Dice&) -> JointDef { return HingeDef{}; }},
    {"hinge with limits and friction",
     [](scenes::Dice& dice) -> JointDef {
         HingeDef def = limitedHinge(dice);
         def.friction = dice.between(0.125f, 4);
         return def;
     }},
    {"hinge with a motor, bouncing limits and a bearing",
     [](scenes::Dice& dice) -> JointDef {
         HingeDef def = limitedHinge(dice);
         def.stop = kBouncy;
         def.motor = Motor{dice.between(-10, 10), dice.between(0, 20), dice.between(0, 10)};
         def.bearing = kBearing;
         return def;
     }},
    {"hinge with a spring",
     [](scenes::Dice& dice) -> JointDef {
         HingeDef def;
         def.spring = Spring{.frequency = dice.between(0.5f, 60), .dampingRatio = dice.between(0, 3), .speed = 0.5f};
         def.target = dice.between(-4, 4);
         return def;
     }},
    {"locked hinge",
     [](scenes::Dice& dice) -> JointDef {
         const float angle = dice.between(-2, 2);
         return HingeDef{.limit = Range{angle, angle}};
     }},
    {"fixed", [](scenes::Dice&) -> JointDef { return FixedDef{}; }},
    {"rope",
     [](scenes::Dice& dice) -> JointDef {
         return DistanceDef{.limit = Range{0, dice.between(0.25f, 3)}};
     }},
    {"spring between points",
     [](scenes::Dice& dice) -> JointDef {
         return DistanceDef{.limit = Range{0.25f, 4},
                            .stop = kBouncy,
                            .spring = Spring{.stiffness = dice.between(1, 200), .damping = 2},
                            .rest = dice.between(0, 3)};
     }},
};

/// Pairs of bodies in any place and motion, some held by the world and some with a locked way or turns; the joints'
/// frames are off by a little, or by much.
Rig pairs(const Kind& kind, int count, std::uint64_t seed) {
    scenes::Dice dice(seed);
    Rig rig;
    rig.gravity = {3, 0, -2};
    const auto vector = [&](float size) {
        return Vec3{dice.between(-size, size), dice.between(-size, size), dice.between(-size, size)};
    };
    const auto body = [&] {
        // One draw after the other: the order of a call's arguments is the compiler's.
        const DVec3 place(vector(2));
        const Vec3 size{dice.between(0.125f, 1), dice.between(0.125f, 1), 0.25f};
        RigBody b = box(dice.between(0.125f, 8), size, place);
        b.rotation = dice.rotation();
        b.v = vector(4);
        b.w = vector(16);
        if (dice.below(8) == 0) b.locks = 2, b.v.y = 0;
        if (dice.below(16) == 0) b.inertia = {};
        return b;
    };
    for (int i = 0; i < count; ++i) {
        JointDef def = kind.make(dice);
        const bool held = dice.below(6) == 0;
        const std::uint32_t a = held ? 0 : rig.add(body()), b = rig.add(body());
        std::visit(
            [&](auto& joint) {
                const bool near = dice.below(2) == 0;
                joint.bodies.frameA = {vector(0.5f), dice.rotation()};
                joint.bodies.frameB = {vector(0.5f), near ? joint.bodies.frameA.rotation : dice.rotation()};
                const RigBody& other = rig.bodies[a];
                RigBody& placed = rig.bodies[b];
                if (near) placed.rotation = other.rotation;
                // What is locked could not close a gap.
                const Vec3 gap = other.locks != 0 || placed.locks != 0 ? Vec3{} : vector(near ? 0.0625f : 1);
                placed.position = other.position + rotate(other.rotation, joint.bodies.frameA.position) -
                                  rotate(placed.rotation, joint.bodies.frameB.position) + gap;
            },
            def);
        // Held or locked bodies are of no figure.
        const bool mayBe = !held && rig.bodies[a].locks == 0 && rig.bodies[b].locks == 0;
        rig.join(a, b, def).ofFreeTree = static_cast<float>(mayBe && i % 2 == 0 ? 1 : 0);
    }
    return rig;
}

/// The bits of everything that a joint carries and its bodies do; a zero has one sign as good as the other.
void expectSame(const Rig& alone, const Rig& wide, const std::string& what) {
    for (std::size_t b = 0; b < alone.bodies.size(); ++b) {
        ASSERT_EQ(alone.bodies[b].v, wide.bodies[b].v) << what << ", body " << b;
        ASSERT_EQ(alone.bodies[b].w, wide.bodies[b].w) << what << ", body " << b;
        ASSERT_EQ(alone.bodies[b].rotation, wide.bodies[b].rotation) << what << ", body " << b;
    }
    for (std::size_t j = 0; j < alone.joints.size(); ++j) {
        const JointSim &a = alone.joints[j], &b = wide.joints[j];
        ASSERT_EQ(warmStartImpulse(a).linear, warmStartImpulse(b).linear) << what << ", joint " << j;
        ASSERT_EQ(warmStartImpulse(a).angular, warmStartImpulse(b).angular) << what << ", joint " << j;
        ASSERT_EQ(a.stepImpulse.angular, b.stepImpulse.angular) << what << ", joint " << j;
        ASSERT_EQ(a.axis.angle.turns, b.axis.angle.turns) << what << ", joint " << j;
        ASSERT_EQ(alone.state(j).coordinate, wide.state(j).coordinate) << what << ", joint " << j;
    }
}

class JointLanes : public testing::TestWithParam<int> {};

TEST_P(JointLanes, GiveTheBitsOfJointsAlone) {
    const JointKernels& kernels = selectJointKernels(GetParam());
    for (const Kind& kind : kKinds) {
        const int joints = 3 * kernels.lanes + 2;
        Rig alone = pairs(kind, joints, 7), wide = pairs(kind, joints, 7);
        ConstraintGraph graph(kernels.lanes, std::pmr::get_default_resource());
        for (std::uint32_t j = 0; j < wide.joints.size(); ++j) {
            const JointSim& joint = wide.joints[j];
            ASSERT_TRUE(isWide(joint)) << kind.name;
            graph.insertJoint(j, joint.stateA, joint.stateA != 0, joint.stateB, true, false);
        }
        JointBundles bundles(kernels.lanes, std::pmr::get_default_resource());
        bundles.build(graph, wide.places().data());
        ASSERT_GT(bundles.color(ConstraintGraph::kOverflow).end, 2) << kind.name;
        for (int step = 0; step < 60; ++step) {
            alone.step();
            wide.step(kernels, bundles);
            expectSame(alone, wide, std::string(kind.name) + ", step " + std::to_string(step));
            if (HasFatalFailure()) return;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Widths, JointLanes, testing::Values(4, 8, 16),
                         [](const auto& param) { return std::to_string(param.param); });

}  // namespace
}  // namespace ragtop::test
