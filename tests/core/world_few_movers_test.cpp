#include <gtest/gtest.h>

#include <vector>

#include "ragtop/tasks.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// A lattice of balls at rest without gravity, a few of which are thrown at their next one, or at each other: few
/// enough for partners to be sought one by one.
struct FewMovers {
    static constexpr int kSide = 17, kThrown = 50;
    static constexpr float kSpeed = 2;  // m/s, over a gap of 2 m
    World world;
    std::vector<BodyId> balls;

    static WorldSettings settings() {
        WorldSettings settings;
        settings.gravity = {};
        settings.sleeping = false;
        return settings;
    }
    /// Balls that are thrown at the next one, which comes to meet them if `both`.
    static bool isThrown(int i) { return i % kThrown == 0 && i % kSide + 1 < kSide; }
    static bool both(int i) { return i % (2 * kThrown) == 0; }

    explicit FewMovers(int workers) : world(settings(), {.tasks = threadTasks(workers)}) {
        for (int i = 0; i < kSide * kSide * kSide; ++i) {
            const DVec3 at{3.0 * (i % kSide), 3.0 * (i / kSide % kSide), 3.0 * (i / (kSide * kSide))};
            const bool comes = i > 0 && isThrown(i - 1) && both(i - 1);
            const Vec3 velocity{isThrown(i) ? kSpeed : comes ? -kSpeed : 0.0f, 0, 0};
            balls.push_back(
                world.create(DynamicBody{.shape = Sphere{0.5f}, .position = at, .linearVelocity = velocity}));
        }
    }
    void play(int steps) {
        for (int i = 0; i < steps; ++i) world.step(1.0 / 60);
    }
    float speedOf(int i) const { return world.linearVelocity(balls[static_cast<std::size_t>(i)]).x; }
};

/// Equal balls that do not bounce go on together with half the speed, and stop where they came from both sides.
TEST(FewMovers, MeetWhatIsInTheirWay) {
    FewMovers lattice(1);
    lattice.play(80);
    int met = 0;
    for (std::size_t i = 0; i < lattice.balls.size(); ++i) {
        const int ball = static_cast<int>(i);
        if (!FewMovers::isThrown(ball)) continue;
        const float expected = FewMovers::both(ball) ? 0 : 0.5f * FewMovers::kSpeed;
        EXPECT_NEAR(lattice.speedOf(ball), expected, 1e-4f * FewMovers::kSpeed) << ball;
        EXPECT_NEAR(lattice.speedOf(ball + 1), expected, 1e-4f * FewMovers::kSpeed) << ball;
        ++met;
    }
    EXPECT_GT(met, 80);
}

TEST(FewMovers, ThreadsGiveTheSameBits) {
    FewMovers one(1), three(3);
    one.play(80);
    three.play(80);
    EXPECT_EQ(one.world.hash(), three.world.hash());
}

}  // namespace
}  // namespace ragtop
