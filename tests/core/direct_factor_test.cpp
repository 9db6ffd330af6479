#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory_resource>
#include <random>
#include <set>
#include <vector>

#include "dense.h"
#include "direct/contact_cone.h"
#include "direct/factor.h"
#include "solve/kernel_table.h"

namespace ragtop::direct {
namespace {

/// M + Jᵀ J over the pairs, which is positive definite.
test::DenseMatrix fill(BlockFactor& factor, const std::vector<BlockPair>& pairs, std::uint32_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1, 1);
    test::DenseMatrix dense(6 * count, 6 * count);
    for (std::uint32_t i = 0; i < 6 * count; ++i) dense(i, i) = 1;
    for (const BlockPair& pair : pairs)
        for (int r = 0; r < 4; ++r) {
            std::vector<double> row(6 * count);
            for (std::uint32_t c = 0; c < 6; ++c)
                row[6 * pair.a + c] = number(random), row[6 * pair.b + c] = number(random);
            for (std::uint32_t i = 0; i < 6 * count; ++i)
                for (std::uint32_t k = 0; k < 6 * count; ++k) dense(i, k) += row[i] * row[k];
        }
    factor.setZero();
    const auto copy = [&](Block6& block, std::uint32_t rows, std::uint32_t columns) {
        for (std::uint32_t c = 0; c < 6; ++c)
            for (std::uint32_t r = 0; r < 6; ++r) block.at[6 * c + r] = dense(6 * rows + r, 6 * columns + c);
    };
    for (std::uint32_t v = 0; v < count; ++v) copy(factor.diagonal(v), v, v);
    for (const BlockPair& pair : pairs) {
        Block6& block = factor.coupling(factor.ordering().blockOf(pair.a, pair.b));
        if (factor.rowsAreOf(pair.a, pair.b))
            copy(block, pair.a, pair.b);
        else
            copy(block, pair.b, pair.a);
    }
    return dense;
}

/// From −1 to 1 in equal steps.
std::vector<double> rightSide(std::uint32_t count) {
    std::vector<double> right(6 * count);
    for (std::size_t i = 0; i < right.size(); ++i)
        right[i] = 2 * static_cast<double>(i) / static_cast<double>(right.size() - 1) - 1;
    return right;
}

TEST(BlockFactor, SolvesAsDenseEliminationDoes) {
    const std::vector<BlockPair> pairs = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {3, 4}, {4, 5}, {5, 6}, {6, 1}, {2, 6}};
    constexpr std::uint32_t kCount = 7;
    BlockFactor factor(std::pmr::get_default_resource());
    ASSERT_TRUE(factor.update(kCount, pairs.data(), pairs.size()));
    EXPECT_FALSE(factor.update(kCount, pairs.data(), pairs.size())) << "the same pattern is no new one";
    const test::DenseMatrix dense = fill(factor, pairs, kCount);
    ASSERT_TRUE(factor.factorize());
    std::vector<double> x = rightSide(kCount);
    const std::vector<double> expected = test::solved(dense, x);
    factor.solve(x.data());
    double off = 0, whole = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        off = std::hypot(off, x[i] - expected[i]);
        whole = std::hypot(whole, expected[i]);
    }
    EXPECT_LT(off, 1e-12 * whole);
}

/// Pairs of neighbours in a wall of bricks, and some across it.
std::vector<BlockPair> wallOf(std::uint32_t width, std::uint32_t height) {
    std::vector<BlockPair> pairs;
    std::mt19937 random(11);
    for (std::uint32_t v = 0; v < width * height; ++v) {
        if (v % width + 1 < width) pairs.push_back({v, v + 1});
        if (v + width < width * height) pairs.push_back({v, v + width});
        if (v % 5 == 0) pairs.push_back({v, static_cast<std::uint32_t>(random() % (width * height))});
    }
    std::erase_if(pairs, [](const BlockPair& pair) { return pair.a == pair.b; });
    return pairs;
}

TEST(BlockFactor, GivesTheSameBitsWithEveryInstructionSet) {
    constexpr std::uint32_t kWidth = 9, kCount = kWidth * 7;
    const std::vector<BlockPair> pairs = wallOf(kWidth, kCount / kWidth);
    const auto solved = [&](Instructions most) {
        limitInstructions(most);
        BlockFactor factor(std::pmr::get_default_resource());
        factor.update(kCount, pairs.data(), pairs.size());
        fill(factor, pairs, kCount);
        EXPECT_TRUE(factor.factorize());
        std::vector<double> x = rightSide(kCount);
        factor.solve(x.data());
        return x;
    };
    const std::vector<double> baseline = solved(Instructions::baseline);
    for (const Instructions wider : {Instructions::avx2, Instructions::avx512}) EXPECT_EQ(solved(wider), baseline);
}

/// Eliminating a variable joins its neighbours; the next is the first of those that have fewest then.
TEST(BlockFactor, EliminatesWhatHasFewestNeighboursFirst) {
    constexpr std::uint32_t kWidth = 17, kCount = kWidth * 11;
    const std::vector<BlockPair> pairs = wallOf(kWidth, kCount / kWidth);
    BlockFactor factor(std::pmr::get_default_resource());
    factor.update(kCount, pairs.data(), pairs.size());
    std::vector<std::set<std::uint32_t>> neighbours(kCount);
    for (const BlockPair& pair : pairs) neighbours[pair.a].insert(pair.b), neighbours[pair.b].insert(pair.a);
    std::set<std::uint32_t> left;
    for (std::uint32_t v = 0; v < kCount; ++v) left.insert(v);
    for (std::uint32_t k = 0; k < kCount; ++k) {
        const std::uint32_t next = *std::min_element(left.begin(), left.end(), [&](std::uint32_t a, std::uint32_t b) {
            return neighbours[a].size() < neighbours[b].size();
        });
        ASSERT_EQ(factor.ordering().place(next), k);
        ASSERT_EQ(factor.ordering().columnBegin(k + 1) - factor.ordering().columnBegin(k), neighbours[next].size());
        left.erase(next);
        for (const std::uint32_t a : neighbours[next]) {
            neighbours[a].insert(neighbours[next].begin(), neighbours[next].end());
            neighbours[a].erase(a);
            neighbours[a].erase(next);
        }
    }
}

TEST(BlockFactor, TreesGetNoFill) {
    std::vector<BlockPair> pairs;
    for (std::uint32_t i = 1; i < 40; ++i) pairs.push_back({(i - 1) / 2, i});
    BlockFactor factor(std::pmr::get_default_resource());
    factor.update(40, pairs.data(), pairs.size());
    EXPECT_EQ(factor.ordering().blockCount(), 39u);
}

TEST(BlockFactor, RefusesWhatIsNotPositiveDefinite) {
    BlockFactor factor(std::pmr::get_default_resource());
    factor.update(1, nullptr, 0);
    factor.setZero();
    EXPECT_FALSE(factor.factorize());
}

TEST(ContactCone, SlopeIsTheDerivativeOfTheProjection) {
    const double points[][3] = {{2, 0.3, -0.4}, {0.5, 1, 2}, {-0.3, 2, 1}, {-5, 1, 0.5}};
    constexpr double kFriction = 0.6, kStep = 1e-6;
    constexpr int kPlace[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (const auto& y : points) {
        double slope[6];
        projectionSlope(y, kFriction, project(y, kFriction).region, slope);
        for (int j = 0; j < 3; ++j) {
            double ahead[3] = {y[0], y[1], y[2]}, behind[3] = {y[0], y[1], y[2]};
            ahead[j] += kStep, behind[j] -= kStep;
            const ConePoint a = project(ahead, kFriction), b = project(behind, kFriction);
            for (int i = 0; i < 3; ++i)
                EXPECT_NEAR(slope[kPlace[i][j]], (a.impulse[i] - b.impulse[i]) / (2 * kStep), 1e-8);
        }
    }
}

TEST(ContactCone, ProjectionIsNearestAndWithin) {
    const double y[3] = {0.5, 1, 2};
    const ConePoint p = project(y, 0.6);
    EXPECT_NEAR(std::hypot(p.impulse[1], p.impulse[2]), 0.6 * p.impulse[0], 1e-15);
    // What is left is perpendicular to the cone's ray.
    double along = 0;
    for (int i = 0; i < 3; ++i) along += p.impulse[i] * (y[i] - p.impulse[i]);
    EXPECT_NEAR(along, 0, 1e-15);
}

}  // namespace
}  // namespace ragtop::direct
