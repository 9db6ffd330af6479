// Bodies that begin inside each other come apart, and do not fly.
#include <algorithm>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

WorldSettings floating() {
    WorldSettings settings = withoutGravity();
    settings.sleeping = false;
    return settings;
}

/// Two balls of 0.5 m, three times as heavy the second.
struct OverlappingPair {
    explicit OverlappingPair(double overlap) : world(floating()), distance(1 - overlap) {
        a = world.create(bodyDef(Sphere{0.5f}, {0, 0, 0}));
        BodyDef heavy = bodyDef(Sphere{0.5f}, {distance, 0, 0});
        heavy.shapes[0].density *= 3;
        b = world.create(heavy);
    }
    double apart() const { return world.pose(b).position.x - world.pose(a).position.x; }
    double middle() const { return (world.pose(a).position.x + 3 * world.pose(b).position.x) / 4; }

    World world;
    double distance;
    BodyId a, b;
};

// In every substep a row that carries nothing asks for the speed pushOut · size / dt at most, from rest, and the relax
// pass takes it back: per step the balls go 0.03 · 0.5 m apart while they are deeper than where that is what softness
// asks for.
TEST(WorldOverlap, PushingGoesAsFarPerStepAsItMay) {
    OverlappingPair pair(0.07);
    pair.world.step(kDt);
    EXPECT_NEAR(pair.apart() - pair.distance, asDouble(WorldSettings{}.pushOut) * 0.5, 1e-5);
}

// One row's relax pass is exact, and what is moved by places has no speed: at no time do balls fly, nor does their
// common centre move. An overlap of 0.8 m is gone within a second.
TEST(WorldOverlap, BallsComeApartWithoutSpeed) {
    for (const double overlap : {0.05, 0.2, 0.8}) {
        OverlappingPair pair(overlap);
        const double middle = pair.middle();
        run(pair.world, 1, kDt, [&] {
            EXPECT_LT(length(pair.world.linearVelocity(pair.a)), 1e-5f);
            EXPECT_NEAR(pair.middle(), middle, 1e-5);
        });
        EXPECT_NEAR(pair.apart(), 1, 1e-3) << overlap;
    }
}

// A push ends no faster than ½ √(g s), with which a body goes on by v²/(2 g) = s/8, and rows slow it down near the
// surface: a crate of size s comes out of the floor, or of another crate, and hops by a hundredth of its size at most,
// however short the steps are. Pushed by a share of its size per step it was thrown by five sizes at 480 Hz.
TEST(WorldOverlap, WhatComesOutOfDeepIsNotThrownHoweverShortTheStepsAre) {
    for (const double rate : {60.0, 120.0, 240.0, 480.0, 960.0})
        for (const double size : {0.1, 0.5, 2.0}) {
            World world(withoutSleep());
            addFloor(world, surface(0.5f));
            const float s = static_cast<float>(size);
            const auto crate = [&](double height) {
                return world.create(bodyDef(Box{{s, s, s}}, {0, height, 0}, surface(0.5f)));
            };
            crate(size);
            const BodyId upper = crate(size * 1.2);
            double top = 0;
            run(world, 1.5, 1 / rate, [&] { top = std::max(top, world.pose(upper).position.y); });
            EXPECT_LT(top, 3.02 * size) << rate << " Hz, " << size << " m";
        }
}

// Rows ask for a relative speed of u = pushOut · size / (s_m dt) at most, s_m = a₂/(1 + a₂): planes of a lattice that
// all go apart as fast move with u (i − c) along each axis, if nothing is taken back. With n planes that is a kinetic
// energy of 3/2 u² (n² − 1)/12 per kg, however deep the boxes begin. Without the bound on pushing it was ten times as
// much.
TEST(WorldOverlap, ALatticeOfBoxesFliesNoFasterThanItsRowsArePushed) {
    constexpr int kSide = 6;
    const WorldSettings settings = floating();
    const double turn = 2 * 3.14159265 * asDouble(settings.contactFrequency);
    const double a2 = turn * (2 * asDouble(settings.contactDamping) + turn), massScale = a2 / (1 + a2);
    const double u = asDouble(settings.pushOut) * 0.5 / kDt / massScale;
    for (const double overlap : {0.1, 0.25, 0.5}) {
        World world(settings);
        std::vector<BodyId> boxes;
        for (int i = 0; i < kSide * kSide * kSide; ++i) {
            const double x = i % kSide, y = i / kSide % kSide, z = i / kSide / kSide;
            boxes.push_back(world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, (1 - overlap) * DVec3{x, y, z})));
        }
        double most = 0;
        run(world, 1.5, kDt, [&] {
            double energy = 0;
            for (const BodyId box : boxes) {
                const Vec3 v = world.linearVelocity(box);
                energy += 0.5 * asDouble(dot(v, v));
            }
            most = std::max(most, energy / static_cast<double>(boxes.size()));
        });
        EXPECT_LT(most, 1.5 * u * u * (kSide * kSide - 1) / 12) << overlap;
    }
}

TEST(WorldOverlap, PushingNeedsASpeed) {
    WorldSettings settings;
    settings.pushOut = 0;
    EXPECT_NE(whyInvalid(settings).find("pushOut is 0"), std::string::npos) << whyInvalid(settings);
}

}  // namespace
}  // namespace ragtop
