#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "world_support.h"

namespace ragtop::test {
namespace {

enum class StiffJoint { ball, hinge };

/// A tree of boxes in space that hang on springs of z = h² k w, w the inverse inertia of a joint's bodies about the
/// axis about which they turn most easily, and that spin at random.
class Tree {
public:
    Tree(std::uint32_t seed, int count, StiffJoint kind, double z, double dampingRatio)
        : world_(inSpace()), random_(seed) {
        const double h = kDt / inSpace().substeps;
        for (int i = 0; i < count; ++i) {
            parents_.push_back(i == 0 ? 0 : i - 1 - pick(i < 3 ? 1 : 2));
            const double above = i == 0 ? 0 : world_.pose(bodies_[parent(i)]).position.y;
            BodyDef def = bodyDef(Box{{0.05f, 0.2f, 0.05f}}, {0, above - 0.45, 0});
            def.shapes[0].density = 1000 * std::exp(between(-1, 1));
            def.shapes[0].filter.mask = 0;
            def.angularVelocity = {between(-3, 3), between(-3, 3), between(-3, 3)};
            bodies_.push_back(world_.create(def));
            if (i == 0) continue;
            JointBodies joined{.a = bodies_[parent(i)], .b = bodies_.back()};
            const Quat axis = kind == StiffJoint::hinge ? rotationAbout({0, 0, 1}, 0.5f * kPi) : Quat{};
            joined.frameA = {{0, -0.225f, 0}, axis}, joined.frameB = {{0, 0.225f, 0}, axis};
            const double w = 1 / easiest(joined.a) + 1 / easiest(joined.b), k = z / (h * h * w);
            const Spring spring{.stiffness = static_cast<float>(k),
                                .damping = static_cast<float>(2 * dampingRatio * std::sqrt(k / w))};
            stiffness_.push_back(k);
            if (kind == StiffJoint::hinge)
                world_.create(HingeDef{.bodies = joined, .spring = spring});
            else
                world_.create(BallDef{.bodies = joined, .spring = spring});
        }
    }
    /// The most by which its energy grows in two seconds, over that of its motion.
    double growth() {
        world_.step(kDt);
        const double start = energy();
        double most = 0;
        for (int i = 0; i < 120; ++i) {
            world_.step(kDt);
            most = std::max(most, energy() - start);
        }
        return most / start;
    }

private:
    static WorldSettings inSpace() {
        WorldSettings settings = withoutSleep();
        settings.gravity = {};
        return settings;
    }
    float between(float a, float b) { return std::uniform_real_distribution<float>(a, b)(random_); }
    int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
    std::size_t parent(int i) const { return static_cast<std::size_t>(parents_[static_cast<std::size_t>(i)]); }
    double easiest(BodyId body) const {
        const auto& inertia = world_.mass(body).inertia;
        return static_cast<double>(std::min({inertia.cx.x, inertia.cy.y, inertia.cz.z}));
    }
    double energy() const {
        double sum = 0;
        for (const BodyId body : bodies_) sum += kineticEnergy(world_, body);
        for (int i = 1; i < static_cast<int>(bodies_.size()); ++i) {
            const Quat turn = conjugate(world_.pose(bodies_[parent(i)]).rotation) *
                              world_.pose(bodies_[static_cast<std::size_t>(i)]).rotation;
            const double sine = static_cast<double>(length(Vec3{turn.x, turn.y, turn.z}));
            const double angle = 2 * std::atan2(sine, std::fabs(static_cast<double>(turn.w)));
            sum += 0.5 * stiffness_[static_cast<std::size_t>(i - 1)] * angle * angle;
        }
        return sum;
    }

    World world_;
    std::mt19937 random_;
    std::vector<BodyId> bodies_;
    std::vector<int> parents_;
    std::vector<double> stiffness_;
};

/// A spring of ω h up to 1 trades a few hundredths of its energy within a period; the guard lets no group have a tenth
/// more.
TEST(StiffSprings, GiveTreesNoEnergyHoweverStiffTheyAre) {
    constexpr double kMost = 0.11;
    for (const StiffJoint kind : {StiffJoint::ball, StiffJoint::hinge})
        for (const int count : {2, 5, 12})
            for (const double dampingRatio : {0.0, 0.1, 1.0})
                for (const double z : {0.01, 0.1, 1.0, 10.0, 1e3, 1e5})
                    EXPECT_LT(Tree(1, count, kind, z, dampingRatio).growth(), kMost)
                        << count << " bodies, z " << z << ", damping ratio " << dampingRatio;
}

/// Each hinge of a beam turns by the moment of the weights beyond it over its stiffness.
TEST(StiffSprings, BeamsSagAsTheirStiffnessSays) {
    constexpr int kCount = 6;
    constexpr double kSpringStiffness = 2e4, kLength = 0.5;
    World world(withoutSleep());
    std::vector<JointId> hinges;
    double mass = 0;
    BodyId last{};
    for (int i = 0; i < kCount; ++i) {
        BodyDef def = bodyDef(Box{{0.24f, 0.05f, 0.05f}}, {kLength * (i + 0.5), 5, 0});
        def.shapes[0].filter.mask = 0;
        const BodyId body = world.create(def);
        mass = static_cast<double>(world.mass(body).mass);
        const Quat alongZ = rotationBetween({1, 0, 0}, {0, 0, 1});
        JointBodies joined{.a = last, .b = body};
        joined.frameA = {i == 0 ? Vec3{0, 5, 0} : Vec3{0.25f, 0, 0}, alongZ};
        joined.frameB = {{-0.25f, 0, 0}, alongZ};
        const Spring spring{.stiffness = static_cast<float>(kSpringStiffness), .damping = 300};
        hinges.push_back(world.create(HingeDef{.bodies = joined, .spring = spring}));
        last = body;
    }
    run(world, 4);
    for (int i = 0; i < kCount; ++i) {
        const int beyond = kCount - i;
        const double moment = mass * static_cast<double>(kGravity) * kLength * 0.5 * beyond * beyond;
        const double angle = static_cast<double>(world.state(hinges[static_cast<std::size_t>(i)]).coordinate);
        EXPECT_NEAR(angle / (-moment / kSpringStiffness), 1, 0.01) << i;
    }
}

}  // namespace
}  // namespace ragtop::test
