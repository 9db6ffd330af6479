#include <vector>

#include <gtest/gtest.h>

#include "ragtop/tasks.h"
#include "road.h"

namespace ragtop {
namespace {

/// Boxes at rest and chains that swing far from the road: savings of the step that a car must not end.
struct Neighbourhood {
    World world;
    std::vector<BodyId> others;
    int links = 0;

    explicit Neighbourhood(int threads = 1) : world(awake(), {.tasks = threadTasks(threads)}) {
        world.create(StaticBody{.shape = Box{{500, 1, 500}}, .position = {0, -1, 0}});
        for (int i = 0; i < 200; ++i)
            others.push_back(world.create(
                DynamicBody{.shape = Box{{0.25f, 0.25f, 0.25f}}, .position = {100.0 + i % 20, 0.25, 1.0 * (i / 20)}}));
        for (int i = 0; i < 6; ++i) hang({-100, 20, 3.0 * i});
    }
    /// Links of 1 kg and a ball of 80 kg, let go sideways.
    void hang(const DVec3& from) {
        BodyId last;
        for (int i = 0; i < 10; ++i, ++links) {
            BodyDef def;
            def.shapes = {{.geometry = Sphere{i < 9 ? 0.1f : 0.3f}, .density = i < 9 ? 240.0f : 700.0f}};
            def.pose.position = from + DVec3{0.5 * (i + 1), 0, 0};
            const BodyId link = world.create(def);
            JointBodies joined{.a = last, .b = link};
            joined.frameA = last.isNull() ? Frame{toVec3(from), {}} : Frame{};
            joined.frameB = {{-0.5f, 0, 0}, {}};
            world.create(BallDef{.bodies = joined});
            others.push_back(last = link);
        }
    }
};

/// What the car does not touch goes the way that it goes without it, to the bit, and the step leaves out and sets apart
/// as much of it as without it.
TEST(Vehicle, OneCarTaxesNobody) {
    for (const int threads : {1, 2}) {
        Neighbourhood without(threads), with(threads);
        Vehicle car(with.world, hatchback());
        car.input.throttle = 0.5f;
        for (int i = 0; i < 180; ++i) {
            without.world.step(kStep);
            with.world.step(kStep);
        }
        EXPECT_GT(car.telemetry().speed, 1);
        const StepStats a = without.world.stats(), b = with.world.stats();
        ASSERT_EQ(a.independentBodies, without.links);
        ASSERT_EQ(a.solvedBodies, 0);  // boxes rest
        EXPECT_EQ(b.independentBodies, a.independentBodies);
        EXPECT_EQ(b.solvedBodies, 1);  // the car
        EXPECT_EQ(b.strayImpulses, 0u);
        for (std::size_t i = 0; i < with.others.size(); ++i)
            ASSERT_EQ(with.world.pose(with.others[i]), without.world.pose(without.others[i])) << i;
    }
}

/// A car at rest that sleeps is not looked at by the step at all.
TEST(Vehicle, ThatSleepsIsNotSolved) {
    Road road;
    Vehicle car(road.world, hatchback());
    car.input.handbrake = 1;
    run(road.world, 20);
    ASSERT_FALSE(road.world.isAwake(car.chassis()));
    road.world.step(kStep);
    EXPECT_EQ(road.world.stats().solvedBodies, 0);
    EXPECT_EQ(road.world.stats().awakeBodies, 0);
}

/// Cars beside each other, and some that stand on the same plank, which they share.
TEST(Vehicle, CarsAreSolvedOnAnyNumberOfThreadsWithTheSameBits) {
    const auto drive = [](int threads) {
        World world({}, {.tasks = threadTasks(threads)});
        world.create(StaticBody{.shape = Box{{500, 1, 500}}, .position = {0, -1, 0}});
        std::vector<Vehicle> cars;
        for (int i = 0; i < 12; ++i) {
            world.create(DynamicBody{.shape = Box{{6, 0.05f, 0.3f}}, .density = 400, .position = {20.0 * i, 0.05, 3}});
            for (const double x : {-3.0, 3.0})
                cars.emplace_back(world, hatchback(), VehiclePlacement{.position = {20.0 * i + x, 0, 0}});
        }
        std::vector<std::uint64_t> hashes;
        for (std::size_t i = 0; i < cars.size(); ++i) cars[i].input.throttle = 0.3f + 0.02f * static_cast<float>(i);
        for (int i = 0; i < 240; ++i) {
            world.step(kStep);
            if (i % 20 == 19) hashes.push_back(world.hash());
        }
        EXPECT_GT(world.pose(cars[0].chassis()).position.z, 3);
        return hashes;
    };
    const std::vector<std::uint64_t> one = drive(1);
    EXPECT_EQ(drive(2), one);
    EXPECT_EQ(drive(4), one);
}

}  // namespace
}  // namespace ragtop
