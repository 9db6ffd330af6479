#include <algorithm>
#include <cmath>
#include <vector>

#include "world_support.h"

// What stands on something that turns is carried in a circle.

namespace ragtop {
namespace {

using namespace test;

constexpr float kCarouselFriction = 0.5f, kRiderHalf = 0.25f;

enum class Carrier { kinematic, onHinge };

struct Carousel {
    World world;
    BodyId disc;
    std::vector<BodyId> riders;

    Carousel(SolverChoice solver, Carrier carrier, float rate, float radius) : world(settingsOf(solver)) {
        const auto half = radius + 3;
        const bool isKinematic = carrier == Carrier::kinematic;
        BodyDef def = bodyDef(Box{{half, 0.5f, half}}, {0, -0.5, 0}, surface(kCarouselFriction),
                              isKinematic ? BodyType::kinematic : BodyType::dynamic);
        def.shapes[0].density = 5000;  // hardly slower for what it carries
        def.angularVelocity = {0, rate, 0};
        disc = world.create(def);
        if (isKinematic) return;
        HingeDef hinge;
        hinge.bodies.b = disc;
        hinge.bodies.frameA = {{0, -0.5f, 0}, {0, 0, std::sqrt(0.5f), std::sqrt(0.5f)}};  // x to y
        hinge.bodies.frameB.rotation = hinge.bodies.frameA.rotation;
        world.create(JointDef{hinge});
    }
    static WorldSettings settingsOf(SolverChoice solver) {
        WorldSettings settings = withoutSleep();
        settings.solver = solver;
        return settings;
    }
    void add(Shape shape, float rate, float radius, double height) {
        BodyDef def = bodyDef(std::move(shape), {radius, height, 0}, surface(kCarouselFriction));
        def.linearVelocity = {0, 0, -rate * radius};
        def.angularVelocity = {0, rate, 0};
        riders.push_back(world.create(def));
    }
    /// m, seen from the disc.
    Vec3 placeOf(BodyId rider) const {
        const Pose from = world.pose(disc);
        return inverseRotate(from.rotation, toVec3(world.pose(rider).position - from.position));
    }
    /// m, the farthest that a rider goes on the disc.
    float farthest(double seconds, double rate) {
        std::vector<Vec3> start;
        for (const BodyId rider : riders) start.push_back(placeOf(rider));
        float most = 0;
        run(world, seconds, 1 / rate, [&] {
            for (std::size_t i = 0; i < riders.size(); ++i) {
                const Vec3 way = placeOf(riders[i]) - start[i];
                most = std::max(most, std::hypot(way.x, way.z));
            }
        });
        return most;
    }
};

/// With friction left no rider goes anywhere: what each step errs by is taken back, and of the sixth of h³ ω³ r by
/// which a substep errs nothing may add up.
TEST(Carousel, CarriesWhatFrictionHolds) {
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::direct})
        for (const double hertz : {30.0, 60.0, 120.0})
            for (const float rate : {0.1f, 0.8f, 3.0f}) {
                const float radius = std::min(0.8f * kCarouselFriction * kGravity / (rate * rate), 20.0f);
                Carousel scene(solver, Carrier::kinematic, rate, radius);
                scene.add(Box{{kRiderHalf, kRiderHalf, kRiderHalf}}, rate, radius, asDouble(kRiderHalf));
                EXPECT_LT(scene.farthest(20, hertz), 0.001f)
                    << hertz << " Hz, " << rate << " rad/s, " << nameOf(solver);
            }
}

/// Of dynamic carriers too, by iteration and directly. Of a pair at a fifth of what friction holds, which is far from
/// tipping.
TEST(Carousel, OnAHingeCarriesAStack) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (const float rate : {0.8f, 3.0f}) {
            const float radius = 0.2f * kCarouselFriction * kGravity / (rate * rate);
            Carousel scene(solver, Carrier::onHinge, rate, radius);
            for (int i = 0; i < 2; ++i)
                scene.add(Box{{kRiderHalf, kRiderHalf, kRiderHalf}}, rate, radius, asDouble(kRiderHalf) * (1 + 2 * i));
            EXPECT_LT(scene.farthest(20, 60), 0.001f) << rate << " rad/s, " << nameOf(solver);
        }
}

/// μ g = ω² r, within two hundredths.
TEST(Carousel, LetsGoWhereFrictionEnds) {
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::direct})
        for (const float rate : {0.8f, 3.0f})
            for (const float share : {0.98f, 1.02f}) {
                const float radius = share * kCarouselFriction * kGravity / (rate * rate);
                Carousel scene(solver, Carrier::kinematic, rate, radius);
                scene.add(Box{{kRiderHalf, kRiderHalf, kRiderHalf}}, rate, radius, asDouble(kRiderHalf));
                const float way = scene.farthest(20, 60);
                EXPECT_EQ(way < 0.001f, share < 1)
                    << rate << " rad/s, " << share << ", " << nameOf(solver) << ": " << way;
            }
}

/// A ball that rolls on it goes round a circle with 2/7 of its rate, wherever that lies [Milne 1948], and stays on it.
TEST(Carousel, BallsRollInCircles) {
    for (const double hertz : {30.0, 60.0, 120.0}) {
        constexpr float kTableRate = 2, kBallRate = kTableRate * 2 / 7, kBallReach = 2, kBallRadius = 0.25f;
        Carousel scene(SolverChoice::automatic, Carrier::kinematic, kTableRate, 10);
        scene.add(Sphere{kBallRadius}, kBallRate, kBallReach, asDouble(kBallRadius));
        scene.world.setVelocity(scene.riders[0], {0, 0, -kBallRate * kBallReach},
                                {(kTableRate - kBallRate) * kBallReach / kBallRadius, 0, 0});
        double off = 0;
        run(scene.world, 20, 1 / hertz, [&] {
            const DVec3 p = scene.world.pose(scene.riders[0]).position;
            off = std::max(off, std::abs(std::hypot(p.x, p.z) - asDouble(kBallReach)));
        });
        EXPECT_LT(off, 0.001) << hertz;
    }
}

/// Whatever turns faster than steps can follow stays in range.
TEST(Carousel, TooFastToFollowThrowsNothingFarther) {
    constexpr float kTableRate = 600, kBallRadius = 0.3f;
    Carousel scene(SolverChoice::automatic, Carrier::kinematic, kTableRate, kBallRadius);
    scene.add(Box{{kRiderHalf, kRiderHalf, kRiderHalf}}, 0, kBallRadius, asDouble(kRiderHalf));
    run(scene.world, 2);
    EXPECT_LT(length(scene.world.linearVelocity(scene.riders[0])), kTableRate * (kBallRadius + 3 + kRiderHalf));
}

}  // namespace
}  // namespace ragtop
