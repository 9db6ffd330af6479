#include <algorithm>
#include <cmath>

#include "chain_support.h"

/// Energy is a law of all that touches and hangs together, not of jointed groups alone: what a group hands to a body
/// without joints counts, and what drives it is left its work.
namespace ragtop {
namespace {

using namespace test;

/// Planks of 1 kg on hinges between two fixed points, a thousandth longer than their span.
struct LightBridge {
    std::vector<BodyId> bodies;
    static constexpr int kPlanks = 20;
    static constexpr double kPitch = 0.6 * 0.999, kHeight = 8;

    explicit LightBridge(World& world) {
        const Quat aboutZ = rotationBetween({1, 0, 0}, {0, 0, 1});
        const double sag = kPlanks * kPitch * std::sqrt(3.0 / 8 * 0.001);
        const auto height = [&](double x) {
            return kHeight - sag * (1 - 4 * x * x / (kPlanks * kPitch * kPlanks * kPitch));
        };
        BodyId before{};
        for (int i = 0; i <= kPlanks; ++i) {
            const double edge = (i - kPlanks / 2) * kPitch;
            BodyId plank{};
            if (i < kPlanks) {
                const double rise = height(edge + kPitch) - height(edge);
                BodyDef def = bodyDef(Box{{0.28f, 0.05f, 1}}, {edge + 0.5 * kPitch, height(edge) + 0.5 * rise, 0});
                def.pose.rotation = normalized(Quat{0, 0, static_cast<float>(0.5 * rise / kPitch), 1});
                def.shapes[0].density = 1 / (0.56f * 0.1f * 2);
                plank = world.create(def);
                bodies.push_back(plank);
            }
            HingeDef hinge;
            hinge.bodies = {.a = before, .b = plank};
            const auto frame = [&](BodyId body) {
                const Pose pose = world.isValid(body) ? world.pose(body) : Pose{};
                return relative(pose, Pose{{edge, height(edge), 0}, aboutZ});
            };
            hinge.bodies.frameA = frame(before), hinge.bodies.frameB = frame(plank);
            world.create(JointDef{hinge});
            before = plank;
        }
    }
};

/// The planks throw it back, and it throws them: whatever they hand each other, together they have what fell.
TEST(GuardedIslands, ABallThatALightBridgeCatchesBringsAllTheEnergyThereIs) {
    for (const float mass : {50.0f, 100.0f})
        for (const double x : {-3.0, 0.1}) {
            World world{withoutSleep()};
            addFloor(world);
            LightBridge bridge{world};
            BodyDef def = bodyDef(Sphere{0.4f}, {x, LightBridge::kHeight + 1.5, 0.1});
            def.shapes[0].density = mass / (4.18879f * 0.064f);
            def.linearVelocity = {4, 0, 0};
            bridge.bodies.push_back(world.create(def));
            const auto energy = [&] {
                double sum = 0;
                for (const BodyId body : bridge.bodies) sum += energyOf(world, body);
                return sum;
            };
            // From each step on: what was lost in one is no room for another. A hundredth is what rows trade.
            double least = energy(), gained = 0;
            const double most = least;
            for (int i = 0; i < stepsIn(3); ++i) {
                world.step(kDt);
                const double now = energy();
                gained = std::max(gained, now - least);
                least = std::min(least, now);
            }
            EXPECT_LE(gained, 0.01 * most) << mass << " kg at " << x;
        }
}

/// Whatever its torque, on a shaft and between two bodies in flight: what it gives is its own.
TEST(GuardedIslands, AMotorIsLeftAllTheWorkThatItDoes) {
    for (const bool flies : {false, true})
        for (const float torque : {50.0f, 500.0f, 50000.0f}) {
            World world{withoutSleep()};
            const BodyId wheel = world.create(bodyDef(Box{{0.5f, 0.1f, 0.5f}}, {0, 5, 0}));
            HingeDef hinge;
            hinge.bodies = {.b = wheel, .frameA = {{0, 5, 0}, {}}};
            if (flies) {
                hinge.bodies.a = world.create(bodyDef(Box{{0.5f, 0.1f, 0.5f}}, {0, 5.5, 0}));
                hinge.bodies.frameA = {{0, -0.25f, 0}, {}}, hinge.bodies.frameB = {{0, 0.25f, 0}, {}};
            }
            hinge.motor = Motor{.targetSpeed = -30, .maxForce = torque};
            world.create(JointDef{hinge});
            for (int i = 0; i < stepsIn(1); ++i) world.step(kDt);
            EXPECT_EQ(world.stats().energyGuarded, 0u) << torque << flies;
            EXPECT_GT(length(world.angularVelocity(wheel)), 1.0f) << torque << flies;
        }
}

/// An arm that a motor holds against its stop, and a load on two links of a thousandth of its mass that swings from it
/// and whirls them.
struct StalledArm {
    std::vector<BodyId> bodies;

    StalledArm(World& world, float torque, float swing) {
        const BodyId arm = addBox(world, {1, 0.1f, 0.1f}, {1, 9, 0}, 100);
        HingeDef hinge;
        hinge.bodies = joined(world, {}, arm, {0, 9, 0});
        hinge.limit = Range{0, 1};
        hinge.motor = Motor{.targetSpeed = -2, .maxForce = torque};
        world.create(JointDef{hinge});
        BodyId above = arm;
        for (int i = 0; i < 3; ++i) {
            const double y = 9 - 0.3 * i;
            const BodyId body = i < 2 ? addBox(world, {0.05f, 0.15f, 0.05f}, {2, y - 0.15, 0}, 4)
                                      : addBox(world, {0.4f, 0.4f, 0.4f}, {2, y - 0.4, 0}, 4000);
            world.create(JointDef{BallDef{.bodies = joined(world, above, body, {2, y, 0})}});
            above = body;
        }
        world.setVelocity(bodies.back(), {swing, 0, 0.3f * swing}, {});
    }
    double energy(const World& world) const {
        double sum = 0;
        for (const BodyId body : bodies) sum += energyOf(world, body);
        return sum;
    }

private:
    BodyId addBox(World& world, const Vec3& half, const DVec3& at, float mass) {
        BodyDef def = bodyDef(Box{half}, at);
        def.shapes[0].density = mass / (8 * half.x * half.y * half.z);
        bodies.push_back(world.create(def));
        return bodies.back();
    }
    static JointBodies joined(const World& world, BodyId a, BodyId b, const DVec3& point) {
        const Pose joint{point, rotationBetween({1, 0, 0}, {0, 0, 1})};
        const auto frame = [&](BodyId body) {
            return relative(world.isValid(body) ? world.pose(body) : Pose{}, joint);
        };
        return {.a = a, .b = b, .frameA = frame(a), .frameB = frame(b)};
    }
};

/// Its torque times its speed would be 3 kJ in each step. What rows trade is the guard's room, half a per cent of the
/// load's swing and of its weight times its size, once up and once down.
TEST(GuardedIslands, AMotorThatStandsGivesNothing) {
    for (const float swing : {1.5f, 2.5f, 3.5f}) {
        World world{withoutSleep()};
        const StalledArm arm(world, 100000, swing);
        const double room = 0.005 * 4000 * static_cast<double>(0.5f * swing * swing + kGravity * 0.4f);
        double least = arm.energy(world), gained = 0;
        for (int i = 0; i < stepsIn(10); ++i) {
            world.step(kDt);
            const double now = arm.energy(world);
            gained = std::max(gained, now - least);
            least = std::min(least, now);
        }
        EXPECT_LE(gained, 2 * room) << swing;
    }
}

}  // namespace
}  // namespace ragtop
