#include <gtest/gtest.h>

#include <random>

#include "direct/island_system.h"
#include "direct/newton.h"
#include "joint_rig.h"

namespace ragtop::test {
namespace {

/// Boxes on hinges and balls, in loops too, many of them beyond their stops or held by friction and motors, that have
/// been struck.
class Tangle {
public:
    Tangle(std::uint32_t seed, int count) : random_(seed) {
        for (int i = 0; i < count; ++i) {
            RigBody body = box(std::exp(between(-2, 2)), {0.1f, 0.2f, 0.1f}, DVec3(anywhere(1)));
            body.rotation = normalized(Quat{between(-1, 1), between(-1, 1), between(-1, 1), 1});
            body.v = {between(-3, 3), between(-3, 3), between(-3, 3)};
            body.w = {between(-9, 9), between(-9, 9), between(-9, 9)};
            rig_.add(body);
        }
        for (int i = 0; i < count; ++i) join(i == 0 ? 0 : 1 + pick(i), i + 1);
        for (int i = 0; i < count / 4; ++i) {
            const int b = 1 + pick(count), a = 1 + pick(count);
            join(a, b);
        }
    }
    /// In units of its impulses, what the answer of a substep leaves of M (v − v_free) = Jᵀ λ, with the λ that its
    /// speeds ask for: the potential is strictly convex, so that zero is the one answer.
    double residual() {
        rig_.begin();
        const JointContext joints = rig_.context();
        std::vector<JointSim*> sims;
        std::vector<std::uint32_t> bodies, localOf(rig_.bodies.size());
        for (JointSim& joint : rig_.joints) {
            prepareJoint(joint, rig_.atStep(joint), rig_.states(), rig_.inertia(), joints);
            sims.push_back(&joint);
        }
        for (std::uint32_t i = 1; i < rig_.bodies.size(); ++i) bodies.push_back(i);
        const BodyArrays arrays{rig_.states(), rig_.inertia(), nullptr, nullptr};
        direct::IslandParts parts;
        parts.bodies = bodies.data(), parts.bodyCount = bodies.size();
        parts.joints = sims.data(), parts.jointCount = sims.size();
        parts.localOf = localOf.data();
        direct::IslandSystem system{std::pmr::get_default_resource()};
        system.begin(parts, arrays, {});
        system.beginSubstep(arrays, joints);
        direct::Equations& equations = system.equations();
        equations.velocityOfLoads(equations.velocity.data());
        direct::SolveReport report;
        bool factored = false;
        EXPECT_TRUE(direct::pivot(equations, factored, report));
        const direct::Residual left = equations.evaluate(equations.velocity.data(), equations.scratch.gradient.data());
        EXPECT_GT(left.scale, 0);
        return left.norm / left.scale;
    }

private:
    Vec3 anywhere(float size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
    float between(float a, float b) { return std::uniform_real_distribution<float>(a, b)(random_); }
    int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
    void join(int a, int b) {
        if (a == b) return;
        const RigBody &bodyA = rig_.bodies[static_cast<std::size_t>(a)],
                      &bodyB = rig_.bodies[static_cast<std::size_t>(b)];
        // Nearly together, as the step before has left them.
        const Vec3 at = toVec3(0.5 * (bodyA.position + bodyB.position));
        const Quat axis = normalized(Quat{between(-1, 1), between(-1, 1), between(-1, 1), 1});
        const auto frameIn = [&](const RigBody& body, float error) {
            return Frame{inverseRotate(body.rotation, at - toVec3(body.position)) + anywhere(error),
                         conjugate(body.rotation) * axis * rotationAbout({1, 0, 0}, between(-1, 1))};
        };
        JointBodies bodies;
        bodies.frameA = frameIn(bodyA, 0), bodies.frameB = frameIn(bodyB, 0.01f);
        const auto end = [](int i) { return static_cast<std::uint32_t>(i); };
        const float lower = between(-2, 1);
        const Range range{lower, lower + between(0, 1)};
        if (pick(2) == 0) {
            HingeDef def{.bodies = bodies, .limit = range};
            def.friction = std::exp(between(-5, 3));
            if (pick(3) == 0) def.motor = Motor{.targetSpeed = between(-5, 5), .maxForce = 1};
            rig_.join(end(a), end(b), def);
        } else {
            BallDef def{.bodies = bodies, .swingLimit = between(0.1f, 2)};
            def.twistLimit = range;
            def.friction = std::exp(between(-5, 3));
            rig_.join(end(a), end(b), def);
        }
    }

    std::mt19937 random_;
    Rig rig_;
};

TEST(Pivoting, AnswersWhateverIsHeldByStopsFrictionAndMotors) {
    for (std::uint32_t seed = 0; seed < 1000; ++seed) {
        SCOPED_TRACE(seed);
        const int count = 2 + static_cast<int>(seed % 30);
        EXPECT_LT(Tangle(seed, count).residual(), 1e-6);
    }
}

}  // namespace
}  // namespace ragtop::test
