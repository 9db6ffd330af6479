#include "direct/mechanism.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace ragtop::direct {
namespace {

constexpr double kGravity = 9.81;

/// Bars of 1 kg and their joints, without a world.
struct Rig {
    struct Bar {
        MechanismBody body;
        MechanismPose pose;
    };
    struct Link {
        MechanismJointKind kind;
        int a, b;  ///< bars; −1: the world
        DVec3 at, axis;
    };
    std::vector<Bar> bars;
    std::vector<Link> links;
    Mechanism mechanism{std::pmr::get_default_resource()};

    /// From one point to another; turns about `pivot` with w.
    int addBar(const DVec3& from, const DVec3& to, const DVec3& w = {}, const DVec3& pivot = {}) {
        Bar bar;
        const DVec3 way = to - from;
        bar.pose.x = 0.5 * (from + to);
        bar.pose.q = toDouble(rotationBetween({1, 0, 0}, toVec3(way)));
        bar.body.inverseMass = 1;
        const double across = dot(way, way) / 12 + 1e-3;
        bar.body.moments = {2e-3, across, 1.1 * across};
        bar.body.inverseMoments = {1 / 2e-3, 1 / across, 1 / (1.1 * across)};
        bar.body.acceleration = {0, -kGravity, 0};
        bar.body.w = w;
        bar.body.v = cross(w, bar.pose.x - pivot);
        bar.body.momentum = inWorld(bar.pose.q, bar.body.moments) * w;
        bars.push_back(bar);
        return static_cast<int>(bars.size()) - 1;
    }
    void join(MechanismJointKind kind, int a, int b, const DVec3& at, const DVec3& axis = {0, 0, 1}) {
        links.push_back({kind, a, b, at, axis});
    }
    void begin() {
        const std::size_t held =
            static_cast<std::size_t>(std::count_if(links.begin(), links.end(), [](const Link& l) { return l.a < 0; }));
        mechanism.resize(bars.size(), held, links.size());
        for (std::size_t i = 0; i < bars.size(); ++i)
            mechanism.body(i) = bars[i].body, mechanism.pose(i) = bars[i].pose;
        std::size_t next = bars.size();
        for (std::size_t j = 0; j < links.size(); ++j) {
            const Link& link = links[j];
            MechanismJoint& joint = mechanism.joint(j);
            joint = {};
            joint.kind = link.kind;
            const DQuat frame = toDouble(rotationBetween({1, 0, 0}, toVec3(link.axis)));
            const auto place = [&](int bar, DVec3& anchor, DQuat& inBody) {
                if (bar < 0) {
                    mechanism.body(next) = {};
                    mechanism.pose(next) = {link.at, {}};
                    anchor = {}, inBody = frame;
                    return static_cast<std::uint32_t>(next++);
                }
                const MechanismPose& pose = bars[static_cast<std::size_t>(bar)].pose;
                anchor = inverseRotate(pose.q, link.at - pose.x);
                inBody = conjugate(pose.q) * frame;
                return static_cast<std::uint32_t>(bar);
            };
            joint.a = place(link.a, joint.anchorA, joint.frameA);
            joint.b = place(link.b, joint.anchorB, joint.frameB);
        }
        mechanism.begin();
    }
    bool run(int substeps, double h) {
        for (int i = 0; i < substeps; ++i)
            if (!mechanism.advance(h, 0.5)) return false;
        return true;
    }
    double energy() {
        double sum = 0;
        for (std::size_t i = 0; i < bars.size(); ++i) {
            const MechanismBody& body = mechanism.body(i);
            sum += 0.5 * dot(body.v, body.v) + 0.5 * dot(body.w, body.momentum) -
                   dot(body.acceleration, mechanism.pose(i).x);
        }
        return sum;
    }
    double gap() {
        double largest = 0;
        for (std::size_t j = 0; j < links.size(); ++j) {
            const MechanismJoint& joint = mechanism.joint(j);
            const MechanismPose &a = mechanism.pose(joint.a), &b = mechanism.pose(joint.b);
            largest = std::max(largest, length(b.x + rotate(b.q, joint.anchorB) - a.x - rotate(a.q, joint.anchorA)));
        }
        return largest;
    }
};

/// Two posts and a beam of 1 m on four hinges, pushed aside.
void buildFourBar(Rig& rig, double push = 1) {
    const DVec3 w{0, 0, -push};
    const int left = rig.addBar({0, 0, 0}, {0, 1, 0}, w), right = rig.addBar({1, 0, 0}, {1, 1, 0}, w, {1, 0, 0});
    const int beam = rig.addBar({0, 1, 0}, {1, 1, 0});
    rig.bars[static_cast<std::size_t>(beam)].body.v = {push, 0, 0};
    rig.join(MechanismJointKind::hinge, -1, left, {0, 0, 0});
    rig.join(MechanismJointKind::hinge, -1, right, {1, 0, 0});
    rig.join(MechanismJointKind::hinge, left, beam, {0, 1, 0});
    rig.join(MechanismJointKind::hinge, beam, right, {1, 1, 0});
    rig.begin();
}

/// A hexagon of bars that tumbles, on balls, hinges and fixed joints in turn.
void buildRing(Rig& rig, int offset) {
    const auto corner = [](int i) {
        const double angle = std::numbers::pi / 3 * i;
        return DVec3{std::cos(angle), 0.1 * (i % 2), std::sin(angle)};
    };
    const DVec3 w{1, 2, -1.5};
    for (int i = 0; i < 6; ++i) rig.addBar(corner(i), corner(i + 1), w);
    for (int i = 0; i < 6; ++i)
        rig.join(static_cast<MechanismJointKind>((i + offset) % 3), i, (i + 1) % 6, corner(i + 1), {0.3, 1, 0.2});
    rig.begin();
}

TEST(MechanismLaw, FreeRingsKeepMomentumAndAngularMomentumAboutAnyPoint) {
    for (int offset = 0; offset < 3; ++offset) {
        Rig rig;
        buildRing(rig, offset);
        for (std::size_t i = 0; i < 6; ++i) rig.mechanism.body(i).acceleration = {};
        const auto momenta = [&] {
            std::pair<DVec3, DVec3> sum;
            for (std::size_t i = 0; i < 6; ++i) {
                const MechanismBody& body = rig.mechanism.body(i);
                sum.first = sum.first + body.v;
                sum.second = sum.second + cross(rig.mechanism.pose(i).x, body.v) + body.momentum;
            }
            return sum;
        };
        const auto before = momenta();
        ASSERT_TRUE(rig.run(2000, 1.0 / 240));
        const auto after = momenta();
        // Impulses act at one point but for the gap, of 1e-9 arms.
        EXPECT_LT(length(after.first - before.first), 1e-9);
        EXPECT_LT(length(after.second - before.second), 1e-7 * length(before.second));
        EXPECT_LT(rig.gap(), 2e-9);
    }
}

TEST(MechanismLaw, MotionRunsBackwardsTheWayItCame) {
    Rig rig;
    buildRing(rig, 1);
    const DVec3 start = rig.mechanism.pose(3).x, turned = axisX(rig.mechanism.pose(3).q);
    ASSERT_TRUE(rig.run(240, 1.0 / 240));
    EXPECT_GT(length(rig.mechanism.pose(3).x - start), 1);
    for (std::size_t i = 0; i < 6; ++i) {
        MechanismBody& body = rig.mechanism.body(i);
        rig.mechanism.changeVelocity(i, -2.0 * body.v, -2.0 * body.w);
    }
    ASSERT_TRUE(rig.run(240, 1.0 / 240));
    EXPECT_LT(length(rig.mechanism.pose(3).x - start), 1e-6);
    EXPECT_LT(length(axisX(rig.mechanism.pose(3).q) - turned), 1e-6);
}

TEST(MechanismLaw, EnergyComesBackThroughSingularPoses) {
    Rig rig;
    buildFourBar(rig);
    const double before = rig.energy(), fall = 4 * kGravity;
    double worst = 0;
    for (int i = 0; i < 240 * 20; ++i) {
        ASSERT_TRUE(rig.run(1, 1.0 / 240));
        worst = std::max(worst, std::abs(rig.energy() - before));
    }
    // (hω)²/24 with ω = 7 rad/s.
    EXPECT_LT(worst, 1e-4 * fall);
    EXPECT_LT(rig.gap(), 1e-7);
}

TEST(MechanismConvergence, ErrorFallsByFourWhenTheStepHalves) {
    const auto angleAfter = [](int substeps) {
        Rig rig;
        buildFourBar(rig, 2);
        EXPECT_TRUE(rig.run(substeps, 0.5 / substeps));
        const DVec3 top = rig.mechanism.pose(0).x;
        return std::atan2(top.x, top.y);
    };
    const double exact = angleAfter(6400);
    const double coarse = angleAfter(100) - exact, fine = angleAfter(200) - exact, finer = angleAfter(400) - exact;
    EXPECT_NEAR(coarse / fine, 4, 0.1);
    EXPECT_NEAR(fine / finer, 4, 0.1);
    EXPECT_LT(std::abs(coarse), 1e-4);
}

TEST(MechanismPace, FastMechanismsDivideTheSubstepAndSlowOnesDoNot) {
    Rig slow, fast;
    buildFourBar(slow, 1);
    buildFourBar(fast, 100);  // 0.4 rad in 1/240 s
    const double before = fast.energy();
    ASSERT_TRUE(slow.run(240, 1.0 / 240));
    ASSERT_TRUE(fast.run(240, 1.0 / 240));
    EXPECT_EQ(slow.mechanism.pace(), 1);
    EXPECT_GE(fast.mechanism.pace(), 4);
    EXPECT_NEAR(fast.energy(), before, 2e-3 * before);
}

/// A door of 20 kg: the least loads that carry it are the same at every hinge.
TEST(MechanismLoads, HingesOfADoorShareItsWeightEvenly) {
    for (const int hinges : {2, 3, 4}) {
        Rig rig;
        const int door = rig.addBar({0, 1, 0}, {1, 1, 0}, {0, 2, 0});
        rig.bars[static_cast<std::size_t>(door)].body.v = {0, 0, -1};
        for (int i = 0; i < hinges; ++i)
            rig.join(MechanismJointKind::hinge, -1, door, {0, 0.2 + 1.6 * i / (hinges - 1), 0}, {0, 1, 0});
        rig.begin();
        const double h = 1.0 / 240;
        ASSERT_TRUE(rig.run(2400, h));
        rig.mechanism.findLoads();
        DVec3 sum;
        for (int i = 0; i < hinges; ++i) {
            const DVec3 force = (1 / h) * rig.mechanism.joint(static_cast<std::size_t>(i)).force;
            EXPECT_NEAR(force.y, kGravity / hinges, 1e-4 * kGravity);
            sum = sum + force;
        }
        // And together they keep it on its circle.
        EXPECT_NEAR(std::hypot(sum.x, sum.z), 4 * 0.5, 1e-3);
        EXPECT_NEAR(rig.mechanism.body(0).w.y, 2, 1e-7);
    }
}

TEST(MechanismFailure, WhatHasNoAnswerIsGivenUp) {
    Rig torn;  // a bar of 1 m between points that are 3 m apart
    const int bar = torn.addBar({0, 0, 0}, {1, 0, 0});
    torn.join(MechanismJointKind::ball, -1, bar, {0, 0, 0});
    torn.join(MechanismJointKind::ball, -1, bar, {1, 0, 0});
    torn.begin();
    torn.mechanism.pose(2).x = {3, 0, 0};
    EXPECT_FALSE(torn.run(1, 1.0 / 240));

    Rig folded;  // axes that point away from each other
    buildFourBar(folded);
    folded.mechanism.joint(2).frameA = DQuat{0, 1, 0, 0} * folded.mechanism.joint(2).frameA;
    EXPECT_FALSE(folded.run(1, 1.0 / 240));

    for (const double wrong :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e9}) {
        Rig rig;
        buildFourBar(rig);
        rig.mechanism.changeVelocity(0, {}, {0, 0, wrong});
        EXPECT_FALSE(rig.run(1, 1.0 / 240)) << wrong;
    }
}

TEST(Rotation, FreeTurnKeepsEnergyAndMomentumOfAFlippingBody) {
    const DVec3 inverse{1, 0.5, 1.0 / 3}, momentum{0.02, 4, 0.01};  // moments 1, 2, 3
    const auto energyOf = [&](const DQuat& q) {
        const DVec3 p = inverseRotate(q, momentum);
        return 0.5 * (p.x * p.x * inverse.x + p.y * p.y * inverse.y + p.z * p.z * inverse.z);
    };
    DQuat q;
    const double before = energyOf(q);
    double worst = 0, tipped = 1;
    for (int i = 0; i < 20000; ++i) {
        q = turnFreely(q, momentum, inverse, 0.01);
        worst = std::max(worst, std::abs(energyOf(q) - before));
        tipped = std::min(tipped, axisY(q).y);
    }
    EXPECT_LT(tipped, -0.99);         // it flips about its middle axis
    EXPECT_LT(worst, 1e-4 * before);  // second order, bounded
}

}  // namespace
}  // namespace ragtop::direct
