#include "ragtop/animated_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "world_support.h"

// A sliding door closes on a box before a wall: it stalls, yields or breaks the box at the force that it is given.
namespace ragtop::test {
namespace {

constexpr float kBudget = 300;

AnimatedBodyDef sliding(BodyId door, WhenBlocked whenBlocked) {
    AnimatedBodyDef def;
    def.body = door;
    def.keys = {{0, {{0, 1.1, 0}, {}}}, {2, {{1.5, 1.1, 0}, {}}}};
    def.maxForce = kBudget;
    def.maxTorque = 1000;
    def.whenBlocked = whenBlocked;
    return def;
}

BodyDef withDensity(float density, BodyDef def) {
    def.shapes[0].density = density;
    return def;
}

struct Doorway {
    World world{withoutSleep()};
    BodyId door{}, wall{}, box{};
    std::unique_ptr<AnimatedBody> animation;
    double pressed = 0, onWall = 0;  // N, the most that the animation gave while blocked; mean of the last steps
    double apart = 0;                // m, from where its clock is
    int blocked = 0;

    explicit Doorway(WhenBlocked whenBlocked, bool withBox = true) {
        addFloor(world, surface(0.3f));
        door = world.create(withDensity(100, bodyDef(Box{{0.05f, 1, 0.5f}}, {0, 1.1, 0}, surface(0.3f))));
        wall = world.create(bodyDef(Box{{0.1f, 1, 1}}, {2.1, 1, 0}, surface(0.3f), BodyType::fixed));
        if (withBox) box = world.create(withDensity(50, bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {1.3, 0.3, 0}, surface(0))));
        animation = std::make_unique<AnimatedBody>(world, sliding(door, whenBlocked));
    }
    void go(double seconds) {
        run(world, seconds, kDt, [&] {
            // What the door itself had of momentum is over after a few steps.
            constexpr int kImpact = 6;
            const AnimationState now = animation->state();
            blocked = now.blocked && now.rate > -0.1f ? blocked + 1 : 0;
            if (blocked > kImpact) pressed = std::max(pressed, asDouble(now.force));
            world.forEachContact(
                wall, [&](const Contact& contact) { onWall += 0.05 * (asDouble(contact.normalForce) - onWall); });
            const Pose expected = animation->at(animation->state().clock);
            apart = std::max(apart, std::abs(world.pose(door).position.x - expected.position.x));
        });
    }
};

TEST(AnimatedBody, FollowsItsAnimationAsAKinematicBodyDoes) {
    Doorway doorway(WhenBlocked::stall, false);
    double worst = 0, late = 0;
    for (int i = 1; i <= 150; ++i) {
        doorway.world.step(kDt);
        const double clock = std::min(i * kDt, 2.0);
        late = std::max(late, std::abs(doorway.animation->state().clock - clock));
        const DVec3 off = doorway.world.pose(doorway.door).position - doorway.animation->at(clock).position;
        worst = std::max(worst, asDouble(length(toVec3(off))));
    }
    EXPECT_LT(late, 1e-9);
    EXPECT_LT(worst, 1e-4);
}

TEST(AnimatedBody, StallsAtItsBudgetAndGoesOnWhenTheWayIsFree) {
    Doorway doorway(WhenBlocked::stall);
    doorway.go(6);
    const AnimationState stalled = doorway.animation->state();
    EXPECT_TRUE(stalled.blocked);
    EXPECT_NEAR(stalled.rate, 0, 0.02);
    EXPECT_NEAR(doorway.world.pose(doorway.door).position.x, 2 - 0.6 - 0.05, 5e-3);
    EXPECT_NEAR(asDouble(stalled.force), asDouble(kBudget), 0.05 * asDouble(kBudget));
    EXPECT_NEAR(doorway.pressed, asDouble(kBudget), 0.05 * asDouble(kBudget));
    EXPECT_NEAR(doorway.onWall, asDouble(kBudget), 0.05 * asDouble(kBudget));
    EXPECT_LT(doorway.apart, 1e-3);
    doorway.world.destroy(doorway.box);
    doorway.go(2);
    EXPECT_NEAR(doorway.animation->state().clock, 2, 1e-9);
    EXPECT_NEAR(doorway.world.pose(doorway.door).position.x, 1.5, 1e-4);
}

TEST(AnimatedBody, YieldsAfterAWhileAndTriesAgain) {
    Doorway doorway(WhenBlocked::yield);
    double back = 9;
    bool away = false;
    for (int i = 0; i < 480; ++i) {
        doorway.go(kDt);
        away |= doorway.animation->state().rate < -0.9f;
        if (away) back = std::min(back, doorway.world.pose(doorway.door).position.x);
    }
    EXPECT_TRUE(away);
    EXPECT_NEAR(back, 0, 1e-3);
    EXPECT_NEAR(doorway.pressed, asDouble(kBudget), 0.05 * asDouble(kBudget));
    EXPECT_LT(doorway.apart, 1e-3);
}

TEST(AnimatedBody, BreaksWhatBlocksItAtItsBudget) {
    Doorway doorway(WhenBlocked::breakThrough);
    BodyId broken{};
    for (int i = 0; i < 240; ++i) {
        doorway.go(kDt);
        if (!doorway.animation->state().broken.isNull()) broken = doorway.animation->state().broken;
    }
    EXPECT_EQ(broken, doorway.box);
    EXPECT_FALSE(doorway.world.isValid(doorway.box));
    EXPECT_NEAR(doorway.pressed, asDouble(kBudget), 0.05 * asDouble(kBudget));
    EXPECT_NEAR(doorway.world.pose(doorway.door).position.x, 1.5, 1e-4);
}

TEST(AnimatedBody, HandsItsVelocityOver) {
    Doorway doorway(WhenBlocked::stall, false);
    doorway.go(1);
    const Vec3 before = doorway.world.linearVelocity(doorway.door);
    EXPECT_NEAR(asDouble(before.x), 1.5 / 2 * 1.5, 0.02);
    doorway.animation->letGo();
    EXPECT_EQ(doorway.world.linearVelocity(doorway.door), before);
    doorway.world.step(kDt);
    EXPECT_NEAR(asDouble(doorway.world.linearVelocity(doorway.door).x), asDouble(before.x), 1e-6);
    EXPECT_NEAR(asDouble(doorway.world.linearVelocity(doorway.door).y), -9.81 / 60, 1e-3);
}

TEST(AnimatedBody, SwingsRoundAsFarAsItIsTold) {
    World world(withoutSleep());
    const BodyId body = world.create(bodyDef(Box{{0.5f, 0.05f, 0.2f}}, {}));
    AnimatedBodyDef def;
    def.body = body;
    for (int i = 0; i <= 4; ++i)
        def.keys.push_back({0.5 * i, {{0.3 * i, 0, 0}, rotationAbout({0, 1, 0}, 1.5f * static_cast<float>(i))}});
    const AnimatedBody animation(world, def);
    run(world, 2.1);
    const Vec3 off = rotationVector(world.pose(body).rotation * conjugate(def.keys[4].pose.rotation));
    EXPECT_LT(asDouble(length(off)), 1e-3);
    EXPECT_NEAR(world.pose(body).position.x, 1.2, 1e-4);
}

TEST(AnimatedBody, GoesOnBitForBitAfterARestore) {
    Doorway doorway(WhenBlocked::yield);
    doorway.go(1.9);
    std::vector<std::byte> saved(doorway.world.saveSize());
    doorway.world.save(saved);
    doorway.go(2);
    const std::uint64_t hash = doorway.world.hash();
    doorway.world.restore(saved);
    doorway.go(2);
    EXPECT_EQ(doorway.world.hash(), hash);
}

TEST(AnimatedBody, SaysWhatIsWrong) {
    Doorway doorway(WhenBlocked::stall);
    const auto complaint = [&](auto&& change) -> std::string {
        AnimatedBodyDef def = sliding(doorway.box, WhenBlocked::stall);
        change(def);
        try {
            const AnimatedBody body(doorway.world, def);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_EQ(complaint([](AnimatedBodyDef& def) { def.keys.pop_back(); }), "keys: 1 are given, must be at least 2");
    EXPECT_EQ(complaint([](AnimatedBodyDef& def) { def.keys[1].time = 0; }),
              "keys[1].time is 0, must be after that of the key before, 0 s");
    EXPECT_EQ(complaint([](AnimatedBodyDef& def) { def.maxForce = NAN; }),
              "maxForce is nan, must be finite and above 0");
    EXPECT_EQ(complaint([&](AnimatedBodyDef& def) { def.body = doorway.wall; }),
              "body names no dynamic body of this world");
}

}  // namespace
}  // namespace ragtop::test
