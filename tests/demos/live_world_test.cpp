#include "serve/live_world.h"

#include <gtest/gtest.h>

#include "live_support.h"
#include "ragtop/world.h"

namespace ragtop::live {
namespace {

class LiveWorldTest : public SessionTest {
protected:
    void SetUp() override { openYard(); }
    LiveWorld& live() { return session_->live(); }
    BodyId body(const std::string& name) { return world().bodies()[nodeNamed(name)]; }
    void run(int count) {
        for (int i = 0; i < count; ++i) live().step();
    }
    void play() { perform(live(), body("brick 20")); }
    /// Everything that a viewer can do, over 200 steps.
    static void perform(LiveWorld& live, BodyId brick) {
        const auto run = [&](int count) {
            for (int i = 0; i < count; ++i) live.step();
        };
        run(7);
        live.apply(GrabInput{brick, {0.1f, 0, 0}, {0, 2, 9}});
        run(20);
        live.apply(DragInput{{1, 2.5, 9}});
        run(20);
        live.apply(ReleaseInput{});
        live.apply(ShootInput{{0, 1, 0}, {0, 0, 1}, 20, 0.2f});
        live.apply(DriveInput{.vehicle = 0, .throttle = 1.0f, .steer = 0.3f, .gear = std::optional<int>(1)});
        run(53);
        live.apply(TuneInput{{{"vehicles.car.chassis.mass", 900.0}, {"settings.gravity", DVec3(0, -5, 0)}}});
        live.apply(TuneInput{{{"vehicles.car.differential.type", std::string("limitedSlip")}}});
        run(40);
        live.apply(ShootInput{{0, 1, 0}, {0.1f, 0.1f, 1}, 30, 0.3f});
        live.apply(ResetInput{0});
        run(60);
    }
};

TEST_F(LiveWorldTest, SixtyStepsBackAndForwardEndWhereTheyBegan) {
    run(100);
    const std::uint64_t hash = world().hash();
    live().seek(40);
    EXPECT_EQ(live().now(), 40u);
    EXPECT_NE(world().hash(), hash);
    live().seek(100);
    EXPECT_EQ(world().hash(), hash);
}

TEST_F(LiveWorldTest, AnyStepComesBackWithItsInputs) {
    play();
    const std::uint64_t last = live().now(), end = world().hash();
    for (const std::uint64_t step : {199u, 0u, 7u, 8u, 27u, 46u, 47u, 48u, 100u, 101u, 139u, 140u, 141u, 1u}) {
        live().seek(step);
        const std::uint64_t there = world().hash();
        live().seek(last);
        ASSERT_EQ(world().hash(), end) << step;
        live().seek(0);
        while (live().now() < step) live().step();
        ASSERT_EQ(world().hash(), there) << step;
    }
}

TEST_F(LiveWorldTest, PlayingOnFromThePastFollowsTheLog) {
    play();
    const std::uint64_t last = live().now(), end = world().hash();
    live().seek(3);
    while (live().now() < last) live().step();
    EXPECT_EQ(world().hash(), end);
    EXPECT_EQ(live().last(), last);
}

TEST_F(LiveWorldTest, TheSameInputsGiveTheSameWorld) {
    play();
    const std::uint64_t end = world().hash();
    LiveScene again((folder_ / "yard.json").string(), {});
    LiveWorld other(again.cast(), again.tuning(), 1 << 20);
    perform(other, again.cast().world->bodies()[nodeNamed("brick 20")]);
    EXPECT_EQ(again.cast().world->hash(), end);
}

TEST_F(LiveWorldTest, ANewInputDropsTheFuture) {
    play();
    live().seek(50);
    const std::uint64_t timeline = live().timeline();
    live().apply(ShootInput{{0, 1, 0}, {0, 0, 1}, 10, 0.5f});
    EXPECT_EQ(live().last(), 50u);
    EXPECT_GT(live().timeline(), timeline);
    EXPECT_THROW(live().seek(51), std::out_of_range);
    run(100);
    // What was tuned in the dropped future is not.
    EXPECT_EQ(car().def().chassis.mass, 1200);
}

TEST_F(LiveWorldTest, TunedValuesGoBackWithTheWorld) {
    run(20);
    live().apply(TuneInput{{{"vehicles.car.chassis.mass", 800.0}}});
    run(20);
    live().seek(10);
    EXPECT_EQ(car().def().chassis.mass, 1200);
    EXPECT_EQ(world().mass(car().chassis()).mass, 1200);
    live().seek(30);
    EXPECT_EQ(car().def().chassis.mass, 800);
    EXPECT_EQ(world().mass(car().chassis()).mass, 800);
}

TEST_F(LiveWorldTest, RestartBeginsAnewWithWhatIsTuned) {
    play();
    live().restart();
    EXPECT_EQ(live().now(), 0u);
    EXPECT_EQ(live().last(), 0u);
    EXPECT_EQ(car().def().chassis.mass, 900);
    EXPECT_FALSE(live().driven()[0]);
    EXPECT_EQ(world().settings().gravity.y, -5);
}

TEST_F(LiveWorldTest, AGrabbedBrickFollowsTheCursor) {
    const BodyId brick = body("brick 20");
    live().apply(GrabInput{brick, {}, world().pose(brick).position});
    const DVec3 start = world().pose(brick).position;
    for (int i = 1; i <= 120; ++i) {
        live().apply(DragInput{start + DVec3(0, 0.01 * i, -0.01 * i)});
        live().step();
    }
    run(60);
    // At rest the spring carries the weight: m g = m ω² x.
    const float sag = 9.81f / (2 * kPi * 2.5f) / (2 * kPi * 2.5f);
    const Vec3 off = relative(world().pose(brick).position, start + DVec3(0, 1.2, -1.2));
    EXPECT_NEAR(off.x, 0, 0.01);
    EXPECT_NEAR(off.y, -sag, 0.01);
    EXPECT_NEAR(off.z, 0, 0.01);
}

TEST_F(LiveWorldTest, AGrabbedHandLiftsThePerson) {
    const BodyId hand = body("person left forearm");
    const BodyId foot = body("person left foot");
    live().apply(GrabInput{hand, {}, world().pose(hand).position});
    live().apply(DragInput{DVec3(-4, 4, 4)});
    run(240);
    EXPECT_GT(world().pose(foot).position.y, 1);
    live().apply(ReleaseInput{});
    run(120);
    EXPECT_LT(world().pose(foot).position.y, 1);
}

/// The pull has a limit: a brick that is held beyond a wall of stone does not get there.
TEST_F(LiveWorldTest, TheHandIsNoStrongerThanTenTimesTheWeight) {
    const BodyId brick = body("brick 20");
    const float mass = world().mass(brick).mass;
    live().apply(GrabInput{brick, {}, DVec3(0, 1000, 0)});
    live().step();
    live().step();
    const float speed = world().linearVelocity(brick).y;
    EXPECT_GT(speed, 0);
    EXPECT_LE(speed, 2.01f / 60 * (100 - 9.81f));
    EXPECT_GT(mass, 1);
}

TEST_F(LiveWorldTest, OnlyWhatMovesCanBeGrabbed) {
    EXPECT_THROW(live().apply(GrabInput{body("ground"), {}, {}}), std::invalid_argument);
    EXPECT_THROW(live().apply(DragInput{{0, 1, 0}}), std::invalid_argument);
    EXPECT_TRUE(live().hand().held().isNull());
}

TEST_F(LiveWorldTest, ASleepingBodyWakesInTheHand) {
    const BodyId brick = body("brick 20");
    world().sleep(brick);
    live().apply(GrabInput{brick, {}, DVec3(0, 2, 9)});
    live().step();
    EXPECT_TRUE(world().isAwake(brick));
}

TEST_F(LiveWorldTest, AShotBallFliesAndGoesWithThePast) {
    run(5);
    const BodyId ball = live().apply(ShootInput{{0, 5, -20}, {0, 0, 2}, 12, 0.1f});
    const std::size_t bodies = world().bodies().size();
    run(30);
    EXPECT_NEAR(world().pose(ball).position.z, -20 + 12 * 0.5, 1e-3);
    live().seek(4);
    EXPECT_FALSE(world().isValid(ball));
    EXPECT_EQ(world().bodies().size(), bodies - 1);
    live().seek(35);
    EXPECT_TRUE(world().isValid(ball));
    EXPECT_NEAR(world().pose(ball).position.z, -20 + 12 * 0.5, 1e-3);
}

TEST_F(LiveWorldTest, TheOldestBallMakesRoom) {
    const std::size_t before = world().bodies().size();
    const BodyId first = live().apply(ShootInput{{0, 5, -20}, {0, 1, 0}, 1, 0.1f});
    for (std::size_t i = 0; i < Hand::kMostBalls; ++i) {
        live().apply(ShootInput{{0.5 * static_cast<double>(i), 5, -30}, {0, 1, 0}, 1, 0.1f});
    }
    EXPECT_EQ(world().bodies().size(), before + Hand::kMostBalls);
    EXPECT_FALSE(world().isValid(first));
}

TEST_F(LiveWorldTest, ADriverTakesOverFromTheScript) {
    EXPECT_FALSE(live().driven()[0]);
    live().apply(DriveInput{.vehicle = 0, .throttle = 1.0f});
    run(120);
    EXPECT_TRUE(live().driven()[0]);
    EXPECT_GT(car().telemetry().speed, 3);
    live().apply(DriveInput{.vehicle = 0, .throttle = 0.0f, .brake = 1.0f});
    run(180);
    EXPECT_LT(std::abs(car().telemetry().speed), 0.1);
    live().apply(ResetInput{0});
    run(60);
    EXPECT_NEAR(world().pose(car().chassis()).position.x, 4, 0.01);
    EXPECT_NEAR(world().pose(car().chassis()).position.z, 0, 0.01);
}

TEST(Snapshots, GapsGrowWithAgeAndStayNarrow) {
    Snapshots snapshots(64 * 1000);
    for (std::uint64_t step = 0; step <= 20000; step += Snapshots::kEvery) {
        snapshots.add({step, std::vector<std::byte>(1000), nullptr, {}});
        ASSERT_LE(snapshots.bytes(), 64u * 1000);
        ASSERT_EQ(snapshots.last(), step);
        ASSERT_EQ(snapshots.initial().step, 0u);
    }
    EXPECT_EQ(snapshots.size(), 64u);
    // The next ones are close, and nothing that can be sought is far from one.
    EXPECT_EQ(snapshots.before(19995).step, 19990u);
    EXPECT_LT(snapshots.first(), 20000u - 60 * Snapshots::kEvery);
    for (std::uint64_t step = snapshots.first(); step <= 20000; ++step) {
        ASSERT_LE(step - snapshots.before(step).step, Snapshots::kWidest);
    }
}

TEST(Snapshots, ThoseOfADroppedFutureGo) {
    Snapshots snapshots(1 << 20);
    for (std::uint64_t step = 0; step <= 100; step += 10) snapshots.add({step, {}, nullptr, {}});
    snapshots.dropAfter(55);
    EXPECT_EQ(snapshots.last(), 50u);
    snapshots.dropAfter(0);
    EXPECT_EQ(snapshots.size(), 1u);
    EXPECT_EQ(snapshots.first(), 0u);
}

}  // namespace
}  // namespace ragtop::live
