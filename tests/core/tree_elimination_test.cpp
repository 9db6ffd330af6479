#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "dense.h"
#include "tree_rig.h"

namespace ragtop {
namespace {

using direct::TreeJoint;
using direct::TreeKernels;
using direct::TreeLink;
using test::TreeRig;
using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

constexpr float kH = 1.0f / 240;

Vector eigen(const Vec3& a) { return {a.x, a.y, a.z}; }
Vector eigen(const float* a) { return {a[0], a[1], a[2]}; }
Vector rotated(const Quat& q, const float* v) { return eigen(rotate(q, Vec3{v[0], v[1], v[2]})); }

/// Everything that joints can be, branching, from the world or free.
std::vector<TreeLink> mixed(bool held) {
    return {{-1, held ? TreeJoint::hinge : TreeJoint::free, 1, {0, 0}},
            {0, TreeJoint::ball, 1, {0, 0}},
            {0, TreeJoint::hinge, 0, {0, 0}},
            {1, TreeJoint::fixed, 1, {0, 0}},
            {1, TreeJoint::hinge, 1, {0, 0}},
            {2, TreeJoint::ball, 0, {0, 0}},
            {5, TreeJoint::ball, 1, {0, 0}}};
}

/// Balls alone, each link from one of the three before it.
std::vector<TreeLink> randomBalls(bool held, std::uint64_t seed) {
    scenes::Dice dice(seed);
    std::vector<TreeLink> links{{-1, held ? TreeJoint::ball : TreeJoint::free, 1, {0, 0}}};
    for (int l = 1; l < 12; ++l) {
        const int back = 1 + static_cast<int>(dice.between(0, 2.99f));
        links.push_back({std::max(0, l - back), TreeJoint::ball, static_cast<std::uint8_t>(l % 2), {0, 0}});
    }
    return links;
}

/// The turn by h w.
Matrix turn(const Vector& w) {
    const double angle = static_cast<double>(kH) * w.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, w.normalized()).toRotationMatrix() : Matrix::Identity();
}

/// M Δ = Jᵀ λ, J Δ + R λ = target − J v by a dense factorization, for gaps that shall close at the rate β after a
/// substep through which bodies turn as in `about`.
struct Dense {
    using Numbers = std::vector<double>;
    Numbers velocity;  ///< of one link after the other, and turning
    std::vector<Vector> forces;
    double condition;

    static Vector three(const Numbers& of, int from) {
        const double* at = of.data() + from;
        return {at[0], at[1], at[2]};
    }
    static void put(Numbers& into, int from, const Vector& v) {
        for (int k = 0; k < 3; ++k) into[static_cast<std::size_t>(from + k)] = v[k];
    }
    static double product(const Numbers& a, const Numbers& b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    }

    Dense(TreeRig& rig, int tree, double beta, const Numbers& about) {
        const int n = rig.linkCount();
        const double h = static_cast<double>(kH);
        std::vector<Numbers> rows;
        Numbers wanted;
        std::vector<double> inverseMasses;
        std::vector<Matrix> inverseInertias;
        velocity.resize(static_cast<std::size_t>(6 * n));
        std::vector<int> firstRow;
        for (int l = 0; l < n; ++l) {
            const BodyState& s = rig.before(tree, l);
            const BodyInertia& i = rig.inertia(tree, l);
            put(velocity, 6 * l, eigen(s.v));
            put(velocity, 6 * l + 3, eigen(s.w));
            inverseMasses.push_back(s.invMass);
            inverseInertias.emplace_back();
            inverseInertias.back() << i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz;
        }
        for (int l = 0; l < n; ++l) {
            const TreeLink& link = rig.links()[static_cast<std::size_t>(l)];
            firstRow.push_back(static_cast<int>(rows.size()));
            if (link.joint == TreeJoint::free) continue;
            const direct::TreeJointRow& joint = rig.joint(tree, l);
            const BodyState c = rig.before(tree, l);
            const BodyState p = link.parent < 0 ? BodyState{} : rig.before(tree, link.parent);
            const Vector rC = rotated(c.dq, joint.anchorC), rP = rotated(p.dq, joint.anchorP);
            const Vector gap = eigen(joint.offset) + eigen(c.dp) - eigen(p.dp) + rC - rP;
            const Vector armC = rC - 0.5 * gap, armP = rP + 0.5 * gap;
            const Vector wC = three(about, 6 * l + 3);
            const Vector wP = link.parent < 0 ? Vector(0, 0, 0) : three(about, 6 * link.parent + 3);
            const auto curving = [h](const Vector& w, const Vector& r) -> Vector {
                return (turn(w) * r - r) / h - w.cross(r);
            };
            const Vector still = curving(wP, rP) - curving(wC, rC) - (0.5 * (wC + wP)).cross(gap);
            const auto add = [&](const Vector& linear, const Vector& turn, double speed) {
                Numbers row(static_cast<std::size_t>(6 * n));
                put(row, 6 * l, linear);
                put(row, 6 * l + 3, armC.cross(linear) + turn);
                if (link.parent >= 0) {
                    put(row, 6 * link.parent, -linear);
                    put(row, 6 * link.parent + 3, -armP.cross(linear) - turn);
                }
                rows.push_back(row);
                wanted.push_back(speed);
            };
            for (int k = 0; k < 3; ++k) add(Vector::Unit(k), Vector::Zero(), still[k] - beta * gap[k]);
            if (link.joint == TreeJoint::ball) continue;
            const auto frame = [](const float* q) { return Quat{q[0], q[1], q[2], q[3]}; };
            const Quat qC = c.dq * frame(joint.frameC), qP = p.dq * frame(joint.frameP);
            const Vector xC = eigen(rotate(qC, {1, 0, 0})), xP = eigen(rotate(qP, {1, 0, 0}));
            if (link.joint == TreeJoint::hinge) {
                const Vector x = link.childIsB ? xC : xP, y = x.unitOrthogonal(), z = x.cross(y);
                const auto errorOf = [](const Vector& parent, const Vector& child) -> Vector {
                    return parent.cross(child) * std::sqrt(2 / (1 + parent.dot(child)));
                };
                const Vector error = errorOf(xP, xC), ahead = errorOf(turn(wP) * xP, turn(wC) * xC);
                const Vector speed = wC - wP - (ahead - error) / h - beta * error;
                for (const Vector& d : {y, z}) add(Vector::Zero(), d, d.dot(speed));
            } else {
                const auto eigenOf = [](const Quat& q) {
                    return Eigen::Quaterniond(static_cast<double>(q.w), static_cast<double>(q.x),
                                              static_cast<double>(q.y), static_cast<double>(q.z));
                };
                const auto errorOf = [](const Eigen::Quaterniond& q) -> Vector {
                    return (q.w() < 0 ? -2.0 : 2.0) * q.vec();
                };
                const Eigen::Quaterniond c0 = eigenOf(qC), p0 = eigenOf(qP);
                const Vector error = errorOf(c0 * p0.conjugate());
                const Vector ahead = errorOf(Eigen::Quaterniond(turn(wC)) * c0 * p0.conjugate() *
                                             Eigen::Quaterniond(turn(wP)).conjugate());
                const Vector speed = wC - wP - (ahead - error) / h - beta * error;
                for (int k = 0; k < 3; ++k) add(Vector::Zero(), Vector::Unit(k), speed[k]);
            }
        }
        std::vector<Numbers> responses = rows;  // M⁻¹ Jᵀ
        for (Numbers& response : responses)
            for (int l = 0; l < n; ++l) {
                const auto link = static_cast<std::size_t>(l);
                put(response, 6 * l, inverseMasses[link] * three(response, 6 * l));
                put(response, 6 * l + 3, inverseInertias[link] * three(response, 6 * l + 3));
            }
        test::DenseMatrix w(rows.size(), rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            wanted[i] -= product(rows[i], velocity);
            for (std::size_t k = 0; k < rows.size(); ++k) w(i, k) = product(rows[i], responses[k]);
        }
        // Points give way by 10⁻⁶ of their inverse masses, the mean of all directions.
        for (int l = 0; l < n; ++l)
            if (const auto i = static_cast<std::size_t>(firstRow[static_cast<std::size_t>(l)]);
                rig.links()[static_cast<std::size_t>(l)].joint != TreeJoint::free) {
                const double give = 1e-6 / 3 * (w(i, i) + w(i + 1, i + 1) + w(i + 2, i + 2));
                for (std::size_t k = i; k < i + 3; ++k) w(k, k) += give;
            }
        const auto [least, most] = std::ranges::minmax(test::eigenvalues(w));
        condition = most / least;
        const Numbers impulse = test::solved(w, wanted);
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t k = 0; k < velocity.size(); ++k) velocity[k] += impulse[i] * responses[i][k];
        for (int l = 0; l < n; ++l)
            forces.push_back(rig.links()[static_cast<std::size_t>(l)].joint == TreeJoint::free
                                 ? Vector(0, 0, 0)
                                 : three(impulse, firstRow[static_cast<std::size_t>(l)]));
    }
};

void stopSpins(TreeRig& rig, int trees) {
    for (int tree = 0; tree < trees; ++tree)
        for (int l = 0; l < rig.linkCount(); ++l) rig.state(tree, l).w = {};
    rig.keep();
}

/// Largest difference from the dense solution, in units of its largest speed and of `condition` if that is asked for.
/// Leapfrog solves twice, the second time
/// for the turns that it has found.
double worstError(TreeRig& rig, int trees, double beta, bool twice, bool perCondition = false) {
    double worst = 0;
    for (int tree = 0; tree < trees; ++tree) {
        Dense dense(rig, tree, beta, Dense::Numbers(static_cast<std::size_t>(6 * rig.linkCount())));
        if (twice) dense = Dense(rig, tree, beta, Dense::Numbers(dense.velocity));
        double scale = 0;
        for (const double speed : dense.velocity) scale = std::max(scale, std::abs(speed));
        if (perCondition) scale *= dense.condition;
        const auto off = [scale](const Vector& a, const Vector& b) { return (a - b).cwiseAbs().maxCoeff() / scale; };
        for (int l = 0; l < rig.linkCount(); ++l) {
            const BodyState& s = rig.state(tree, l);
            worst = std::max(worst, off(eigen(s.v), Dense::three(dense.velocity, 6 * l)));
            worst = std::max(worst, off(eigen(s.w), Dense::three(dense.velocity, 6 * l + 3)));
            worst = std::max(worst, off(eigen(rig.impulse(tree, l).force), dense.forces[static_cast<std::size_t>(l)]));
        }
    }
    return worst;
}

TEST(TreeElimination, AgreesWithADenseFactorization) {
    for (const bool held : {true, false}) {
        const direct::TreeTables& tables = direct::selectTreeKernels(8);
        for (const TreeKernels* kernels : {&tables.single, &tables.doublePrecision}) {
            TreeRig rig(*kernels, mixed(held), 11);
            stopSpins(rig, 11);
            rig.begin();
            rig.solve({kH, 40});
            // Arms and frames of the reference are rounded to single precision; masses and arms make a condition of
            // some hundreds, which in single precision comes in twice.
            const double rounding = kernels == &tables.single ? 3e-4 : 1e-5;
            EXPECT_LT(worstError(rig, 11, 40, kernels->leapfrog), rounding) << kernels->lanes << held;
        }
    }
}

TEST(TreeElimination, LimbsAgreeWithTheGeneralWayAndADenseFactorization) {
    const direct::TreeTables& tables = direct::selectTreeKernels(8);
    for (const TreeKernels* kernels : {&tables.single, &tables.doublePrecision})
        for (std::uint64_t seed = 1; seed <= 6; ++seed)
            for (const bool limbs : {false, true}) {
                const std::vector<TreeLink> links = randomBalls(seed % 2 == 0, seed);
                TreeRig rig(*kernels, limbs ? test::limbed(links) : links, 11);
                stopSpins(rig, 11);
                rig.begin();
                rig.solve({kH, 40});
                // Impulses and what they are made of are rounded, and the rounding grows by the condition of the rows;
                // in doubles the reference's arms are rounded to single precision, which moves rows by as much.
                EXPECT_LT(worstError(rig, 11, 40, kernels->leapfrog, true), 8 * std::pow(2.0, -24))
                    << kernels->lanes << ' ' << seed << ' ' << limbs;
            }
}

TEST(TreeElimination, SameBitsInAnyLaneOfAnyWidth) {
    constexpr int kTrees = 19;
    for (const bool doublePrecision : {false, true}) {
        const std::vector<TreeLink> links = test::limbed(mixed(true));
        std::vector<BodyState> expected;
        for (const int lanes : {4, 8, 16}) {
            const direct::TreeTables& tables = direct::selectTreeKernels(lanes);
            const TreeKernels& kernels = doublePrecision ? tables.doublePrecision : tables.single;
            TreeRig rig(kernels, links, kTrees, 100);
            rig.begin();
            rig.solve({kH, 40});
            rig.relax({kH, 40, true, true});
            std::vector<BodyState> found;
            for (int tree = 0; tree < kTrees; ++tree)
                for (int l = 0; l < rig.linkCount(); ++l) found.push_back(rig.state(tree, l));
            if (expected.empty()) expected = found;
            EXPECT_EQ(0, std::memcmp(found.data(), expected.data(), found.size() * sizeof(BodyState))) << lanes;
            // The first alone: all other lanes repeat it.
            TreeRig alone(kernels, links, 1, 100);
            alone.begin();
            alone.solve({kH, 40});
            alone.relax({kH, 40, true, true});
            for (int l = 0; l < alone.linkCount(); ++l)
                EXPECT_EQ(0,
                          std::memcmp(&alone.state(0, l), &expected[static_cast<std::size_t>(l)], sizeof(BodyState)));
        }
    }
}

TEST(TreeElimination, FreeTreeKeepsItsMomentum) {
    const direct::TreeTables& tables = direct::selectTreeKernels(8);
    for (const TreeKernels* kernels : {&tables.single, &tables.doublePrecision}) {
        TreeRig rig(*kernels, test::limbed(mixed(false)), 8);
        rig.begin();
        rig.solve({kH, 40});
        for (int tree = 0; tree < 8; ++tree) {
            Vector change = Vector::Zero();
            double size = 0;
            for (int l = 0; l < rig.linkCount(); ++l) {
                const BodyState &now = rig.state(tree, l), &before = rig.before(tree, l);
                const Vector gained = (eigen(now.v) - eigen(before.v)) / static_cast<double>(before.invMass);
                change += gained;
                size += gained.norm();
            }
            EXPECT_LT(change.norm(), 1e-5 * size) << tree;  // a few roundings of single velocities per body
        }
    }
}

TEST(TreeElimination, ErrorsVanishWhenTheSubstepEnds) {
    const TreeKernels& kernels = direct::selectTreeKernels(8).doublePrecision;
    TreeRig rig(kernels, test::limbed(test::figure(4, 4)), 4);
    rig.begin();
    rig.solve({kH, 1 / kH});
    for (int tree = 0; tree < 4; ++tree)
        for (int l = 1; l < rig.linkCount(); ++l) {
            const int parent = rig.links()[static_cast<std::size_t>(l)].parent;
            const direct::TreeJointRow& joint = rig.joint(tree, l);
            const auto moved = [](const BodyState& s, const float* anchor) {
                const Vec3 half = 0.5f * kH * s.w;
                const Quat dq = normalized(Quat{half.x, half.y, half.z, 1} * s.dq);
                return Vector(eigen(s.dp) + static_cast<double>(kH) * eigen(s.v) + rotated(dq, anchor));
            };
            const Vector gap = eigen(joint.offset) + moved(rig.state(tree, l), joint.anchorC) -
                               moved(rig.state(tree, parent), joint.anchorP);
            // What remains is of second order in the change of spin within the substep: 0.3 m · (0.1 rad)² / 2 at most.
            EXPECT_LT(gap.norm(), 2e-3) << tree << ' ' << l;
        }
}

TEST(TreeElimination, WhatHasNoAnswerIsLeftAlone) {
    const TreeKernels& kernels = direct::selectTreeKernels(8).single;
    TreeRig rig(kernels, test::limbed(test::figure(2, 3)), 8);
    rig.state(3, 2).w = {NAN, 0, 0};
    rig.keep();
    rig.begin();
    rig.solve({kH, 40});
    EXPECT_EQ(rig.groupOf(3).failed, 1u << (3 % kernels.lanes));
    for (int l = 0; l < rig.linkCount(); ++l) {
        EXPECT_EQ(rig.state(3, l).v, rig.before(3, l).v);
        EXPECT_NE(rig.state(4, l).v, rig.before(4, l).v);
    }
}

/// What is measured alone has an answer, and leaves bodies as they are.
TEST(TreeElimination, FactorsAgainWhatASolveHasLeft) {
    const direct::TreeTables& tables = direct::selectTreeKernels(8);
    for (const TreeKernels* kernels : {&tables.single, &tables.doublePrecision}) {
        TreeRig rig(*kernels, test::limbed(test::figure(4, 4)), 11);
        rig.begin();
        rig.solve({kH, 40});
        rig.keep();
        rig.factor();
        for (int tree = 0; tree < 11; ++tree) {
            EXPECT_EQ(rig.groupOf(tree).failed, 0u);
            for (int l = 0; l < rig.linkCount(); ++l)
                EXPECT_EQ(std::memcmp(&rig.state(tree, l), &rig.before(tree, l), sizeof(BodyState)), 0);
        }
    }
}

}  // namespace
}  // namespace ragtop
