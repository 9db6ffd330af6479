#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

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

/// Bodies of which some are locked in some movements, in a tree of rows that push and turn along any directions.
class Rows {
public:
    explicit Rows(std::uint32_t seed) : random_(seed) {
        const std::uint32_t count = 2 + seed % 6;
        std::vector<direct::BlockPair> coupled;
        for (std::uint32_t i = 0; i < count; ++i) addBody();
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::int32_t other = i == 0 ? direct::kFixed : static_cast<std::int32_t>(pick(i));
            addPair(other, static_cast<std::int32_t>(i));
            if (i > 0) coupled.push_back({static_cast<std::uint32_t>(other), i});
        }
        equations_.hessian.update(count, coupled.data(), coupled.size());
        for (direct::SystemPair& pair : equations_.pairs)
            if (pair.a != direct::kFixed)
                pair.block = equations_.hessian.ordering().blockOf(static_cast<std::uint32_t>(pair.a),
                                                                   static_cast<std::uint32_t>(pair.b));
        for (AlignedArray<double>* numbers : {&equations_.velocity, &equations_.free, &equations_.scratch.gradient})
            for (std::size_t k = 0; k < equations_.unknowns(); ++k) numbers->push(between(-1, 1));
    }
    /// What one step of Newton's method leaves, in units of the impulses.
    double residualAfterAStep() {
        double *v = equations_.velocity.data(), *gradient = equations_.scratch.gradient.data();
        equations_.evaluate(v, gradient);
        EXPECT_TRUE(equations_.factorize());
        equations_.solve(gradient);
        for (std::size_t k = 0; k < equations_.unknowns(); ++k) v[k] -= gradient[k];
        const direct::Residual left = equations_.evaluate(v, gradient);
        EXPECT_GT(left.scale, 0);
        return left.norm / left.scale;
    }
    /// Does no locked movement take part?
    bool keepsLocked() const {
        for (std::size_t i = 0; i < equations_.bodies.size(); ++i)
            for (std::uint32_t k = 0; k < 6; ++k)
                if (((equations_.bodies[i].locks >> k) & 1) != 0 &&
                    std::fabs(equations_.velocity[6 * i + k] - equations_.free[6 * i + k]) > 1e-12)
                    return false;
        return true;
    }

private:
    double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
    std::uint32_t pick(std::uint32_t count) {
        return std::uniform_int_distribution<std::uint32_t>(0, count - 1)(random_);
    }
    DVec3 anywhere() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
    void addBody() {
        direct::SystemBody body;
        body.locks = pick(3) == 0 ? pick(64) : 0;
        const double mass = between(0.5, 2);
        double moment[3];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const bool locked = ((body.locks >> k) & 1) != 0;
            body.mass[k] = locked ? 1 : mass, body.inverseMass[k] = locked ? 0 : 1 / mass;
            moment[k] = ((body.locks >> (k + 3)) & 1) != 0 ? 0 : between(0.5, 2);
        }
        body.inverseInertia = {moment[0], 0, 0, moment[1], 0, moment[2]};
        const auto inverse = [](double x) { return x > 0 ? 1 / x : 1; };
        body.inertia = {inverse(moment[0]), 0, 0, inverse(moment[1]), 0, inverse(moment[2])};
        body.inverseTaut = body.inverseInertia;
        equations_.bodies.push(body);
    }
    void addPair(std::int32_t a, std::int32_t b) {
        direct::SystemPair pair;
        pair.a = a, pair.b = b, pair.armA = anywhere(), pair.armB = anywhere();
        pair.first = static_cast<std::uint32_t>(equations_.rows.size()), pair.count = 1 + pick(6);
        for (std::uint32_t i = 0; i < pair.count; ++i) {
            direct::SystemRow row;
            const std::uint32_t way = pick(4);
            row.shape = way < 2    ? direct::RowShape::whole
                        : way == 2 ? direct::RowShape::turning
                                   : direct::RowShape::alongY;
            row.linear = way < 2 ? anywhere() : way == 2 ? DVec3{} : DVec3{0, 1, 0};
            row.turn = way == 0 || way == 2 ? anywhere() : DVec3{};
            row.load = between(-1, 1), row.target = between(-1, 1), row.resistance = std::exp(between(-7, 0));
            row.lower = -1e9, row.upper = 1e9;
            equations_.rows.push(row);
        }
        equations_.pairs.push(pair);
    }

    std::mt19937 random_;
    direct::Equations equations_{std::pmr::get_default_resource()};
};

/// Rows without bounds ask for a linear answer, which the matrix of Newton's method gives at once; resistances reach
/// to a thousandth of masses, and 1e-10 is some thousand roundings of what they multiply.
TEST(Equations, OfRowsWithoutBoundsAreSolvedByOneStep) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        SCOPED_TRACE(seed);
        Rows rows(seed);
        EXPECT_LT(rows.residualAfterAStep(), 1e-10);
        EXPECT_TRUE(rows.keepsLocked());
    }
}

}  // namespace
}  // namespace ragtop::test
