#include "tire.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

constexpr float kLoad = 4000;  // N
constexpr float kGravity = 9.81f;

TireDef tireDef() {
    TireDef def;
    def.longitudinalFriction = 1.1f;
    def.lateralFriction = 0.9f;
    return def;
}

struct Rig {
    TireSpec spec = makeTireSpec(tireDef(), kLoad, kGravity);
    TireGround ground;
    float transport = 0, tread = 0;
    Vec2 u;
    Vec2 force;

    /// A substep at a given slip velocity: the ground is immovable and so is the wheel.
    void step(const Vec2& slip, float h) {
        const TireLaw law = tireLaw(spec, ground, {{slip.x + tread, slip.y}, tread}, kLoad, transport);
        TireLine line = tireLine(law, u);
        TireVisit visit;
        for (int i = 0; i < 40; ++i) {
            visit = solveTire(law, line, u, transport, kLoad * h, h, {}, slip);
            line = lineAfter(law, deflectionAfter(law, line, u, visit, slip, transport, kLoad * h, h), visit.sliding);
        }
        force = {visit.impulse.x / h, visit.impulse.y / h};
        u = withinPatch(law, visit.sliding ? deflectionAfter(law, line, u, visit, slip, transport, kLoad * h, h)
                                           : rolledDeflection(law, u, slip, transport, h));
    }
};

/// Maximum dissipation on the ellipse of the locked wheel: the support point against the slip, F = −N (μx² sx, μy²
/// sy)/|(μx sx, μy sy)|.
TEST(Tire, SkidsAtTheEllipsePointOfMostDissipationIn36Directions) {
    const TireDef def = tireDef();
    const double mx = def.slidingShare * def.longitudinalFriction, my = def.slidingShare * def.lateralFriction;
    for (int k = 0; k < 36; ++k) {
        const double angle = static_cast<double>(k) * 3.14159265358979 / 18;
        const double sx = 2 * std::cos(angle), sy = 2 * std::sin(angle);
        Rig rig;
        for (int i = 0; i < 240; ++i) rig.step({static_cast<float>(sx), static_cast<float>(sy)}, 1.0f / 240);
        const double scale = -kLoad / std::hypot(mx * sx, my * sy);
        EXPECT_NEAR(rig.force.x, scale * mx * mx * sx, 1e-3 * kLoad) << k;
        EXPECT_NEAR(rig.force.y, scale * my * my * sy, 1e-3 * kLoad) << k;
        EXPECT_NEAR(std::hypot(rig.force.x / mx, rig.force.y / my), kLoad, 1e-5 * kLoad) << k;
    }
}

/// Rolling with small slip: F = −C s/V N, less the share of the parabola, 1 − x + x²/3 with x = C s/(3 μ V).
TEST(Tire, RollsWithTheBrushCurve) {
    const double speed = 20;
    for (const double slip : {0.001, 0.01, 0.03, 0.06, 0.1}) {
        Rig rig;
        rig.transport = rig.tread = static_cast<float>(speed);
        for (int i = 0; i < 240; ++i) rig.step({0, static_cast<float>(slip * speed)}, 1.0f / 240);
        const double x = rig.spec.def.corneringStiffness * slip / (3 * rig.spec.def.lateralFriction);
        const double expected = -kLoad * rig.spec.def.lateralFriction * (3 * x - 3 * x * x + x * x * x);
        EXPECT_NEAR(rig.force.y, expected, 1e-4 * kLoad) << slip;
        EXPECT_NEAR(rig.force.x, 0, 1e-6 * kLoad);
    }
}

/// Braked from 20 m/s with a fixed slip: the brush's curve up to where all of it slides, κ/(1 − κ) = 3 μ/C, and
/// friction that falls on a line from κ = 3 μ/C to slidingShare of it at the locked wheel. At right angles the locked
/// wheel's too.
TEST(Tire, LosesFrictionFromSlidingToLocked) {
    const double travel = 20;
    for (const double slip : {0.05, 0.1, 0.2, 0.35, 0.6, 1.0}) {
        Rig rig;
        const double tread = (1 - slip) * travel;
        rig.transport = rig.tread = static_cast<float>(tread);
        for (int i = 0; i < 2400; ++i) rig.step({static_cast<float>(slip * travel), 0}, 1.0f / 240);
        const TireDef& def = rig.spec.def;
        const double z = def.slipStiffness * slip / (3 * def.longitudinalFriction);
        const double share = slip >= 1 ? 1 : std::max(0.0, (z - 1) / (z / slip - 1));
        const double friction = def.longitudinalFriction * (1 - (1 - def.slidingShare) * share);
        const double x = slip < 1 ? std::min(z / (1 - slip), 1.0) : 1;
        EXPECT_NEAR(rig.force.x, -kLoad * friction * (3 * x - 3 * x * x + x * x * x), 1e-3 * kLoad) << slip;
    }
    Rig across;
    for (int i = 0; i < 240; ++i) across.step({0, 15}, 1.0f / 240);
    EXPECT_NEAR(across.force.y, -kLoad * across.spec.def.slidingShare * across.spec.def.lateralFriction, 1e-3 * kLoad);
}

TEST(Tire, GripsInProportionToTheGroundOrAsItsTableSays) {
    TireDef def = tireDef();
    def.surfaces = {{.surface = 7, .grip = 0.1f, .stiffness = 0.5f, .drag = 0.04f}};
    for (const float friction : {0.05f, 0.3f, 0.6f, 1.2f})
        EXPECT_FLOAT_EQ(tireGround(def, friction, 0).grip, friction / def.referenceSurface);
    const TireSpec spec = makeTireSpec(def, kLoad, kGravity);
    const TireLaw ice = tireLaw(spec, tireGround(def, 0.6f, 7), {}, kLoad, 10);
    EXPECT_FLOAT_EQ(ice.friction.x, 0.1f * def.longitudinalFriction);
    EXPECT_FLOAT_EQ(ice.stiffness.y, 0.5f * spec.stiffness.y);
    EXPECT_FLOAT_EQ(tireGround(def, 0.6f, 7).drag, 0.04f);
}

/// After one relaxation length the bristles of an undamped tire are 1 − 1/e bent; backward Euler is late by h V/(2 σ).
TEST(Tire, GrowsItsForceOverTheRelaxationLength) {
    Rig rig;
    rig.spec.standingDamping = 0;
    const float speed = 5, slip = 0.001f;
    rig.transport = speed;
    const int steps = 600;
    const float h = rig.spec.def.relaxationLength / speed / steps;
    for (int i = 0; i < steps; ++i) rig.step({0, slip * speed}, h);
    const double steady = slip * rig.spec.def.relaxationLength;
    EXPECT_NEAR(-rig.u.y / steady, 1 - std::exp(-1.0), 1.0 / steps);
}

/// Under a slip that grows evenly, a t, the bristles are at −(σ/V) (a t − a σ/V), which backward Euler has exactly; the
/// force of a substep is that of its middle, but for the share (θ − ½)/½ < x/6 of half a substep.
TEST(Tire, PushesByTheMeanForceOfASubstep) {
    Rig rig;
    rig.spec.standingDamping = 0;
    const double speed = 20, growth = 0.02, h = 1.0 / 240, way = rig.spec.def.relaxationLength;
    rig.transport = rig.tread = static_cast<float>(speed);
    for (int i = 1; i <= 24; ++i) rig.step({0, static_cast<float>(growth * i * h)}, static_cast<float>(h));
    const double slope = kLoad * static_cast<double>(rig.spec.stiffness.y) * way / speed * growth;
    const double middle = -slope * (23.5 * h - way / speed), late = 0.5 * h * slope;
    EXPECT_NEAR(rig.force.y, middle, (speed * h / way / 6 + 0.05) * late);
}

/// At rest the law is a spring: what moved the patch there and back leaves no force.
TEST(Tire, IsASpringAtStandstill) {
    Rig rig;
    const float h = 1.0f / 240, speed = 0.01f;
    for (int i = 0; i < 24; ++i) rig.step({speed, speed}, h);
    const Vec2 bent = rig.u;
    for (int i = 0; i < 2400; ++i) rig.step({0, 0}, h);
    EXPECT_NEAR(rig.u.x, bent.x, 1e-6f * std::abs(bent.x));
    EXPECT_NEAR(-bent.x, 24 * h * speed, 1e-5 * 24 * h * speed);
    for (int i = 0; i < 24; ++i) rig.step({-speed, -speed}, h);
    for (int i = 0; i < 240; ++i) rig.step({0, 0}, h);
    EXPECT_NEAR(rig.force.x, 0, 1e-4 * kLoad);
    EXPECT_NEAR(rig.force.y, 0, 1e-4 * kLoad);
}

/// More load presses on the ground what is not bent: the force stays, and comes back to where it was with the load.
/// With any load no more is held than before.
TEST(Tire, HoldsNoMoreWhenItsLoadSways) {
    TireDef curves = tireDef();
    curves.slipCurves.emplace();
    for (const TireDef& def : {tireDef(), curves}) {
        const TireSpec spec = makeTireSpec(def, kLoad, kGravity);
        const auto lawUnder = [&](float load) { return tireLaw(spec, {}, {}, load, 0); };
        for (const float size : {1e-4f, 0.3f, 1.0f}) {
            const TireLaw law = lawUnder(kLoad);
            const Vec2 bent = beforePeak(law, withinPatch(law, {0.1f * size, -0.2f * size}));
            const double first = static_cast<double>(kLoad) * bentEnergy(law, bent);
            const Tread tread{bent, bent, kLoad, kLoad};
            for (const float load : {0.2f * kLoad, kLoad, 1.5f * kLoad, 10 * kLoad}) {
                const Tread now = underLoad(tread, load), back = underLoad(now, kLoad);
                const double held = static_cast<double>(load) * bentEnergy(lawUnder(load), now.mean);
                EXPECT_LE(held, (1 + 1e-5) * first);
                const float pressed = std::min(load, kLoad);  // of what was bent
                EXPECT_NEAR(load * now.mean.y, pressed * bent.y, 1e-6f * kLoad * std::abs(bent.y));
                EXPECT_NEAR(kLoad * back.mean.y, pressed * bent.y, 1e-5f * kLoad * std::abs(bent.y));
            }
            // Bent on under more load, with that less of it: edge and core by as much.
            Tread more = underLoad(tread, 2 * kLoad);
            for (Vec2* part : {&more.mean, &more.core}) *part = {part->x + bent.x, part->y + bent.y};
            EXPECT_NEAR(meanUnder(more, 1.5f * kLoad).x, (2 + 0.5f) / 1.5f * bent.x, 1e-5f * std::abs(bent.x));
            EXPECT_NEAR(meanUnder(more, kLoad).x, 2 * bent.x, 1e-5f * std::abs(bent.x));
        }
    }
    EXPECT_EQ(underLoad({}, kLoad).mean, Vec2{});
}

TEST(Tire, GivesNothingWithoutLoadOrGrip) {
    const TireSpec spec = makeTireSpec(tireDef(), kLoad, kGravity);
    const TireLaw law = tireLaw(spec, {}, {}, 0, 1);
    EXPECT_EQ(solveTire(law, tireLine(law, {}), {0.01f, 0.01f}, 1, 0, 1.0f / 240, {}, {1, 1}).impulse, Vec2{});
    Rig rig;
    rig.spec.def.referenceSurface = 0.6f;
    const TireLaw ice = tireLaw(spec, tireGround(spec.def, 0, 0), {}, kLoad, 0);
    const TireVisit visit = solveTire(ice, tireLine(ice, {}), {0, 0}, 0, kLoad, 1.0f / 240, {}, {1, 0});
    EXPECT_LT(std::abs(visit.impulse.x), 1e-5f * kLoad);
}

}  // namespace
}  // namespace ragtop
