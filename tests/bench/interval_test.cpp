#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "chart/interval.h"

namespace ragtop::chart {
namespace {

std::vector<double> timesOf(std::size_t count, double spread, std::mt19937& random) {
    std::lognormal_distribution<double> draw(0, spread);
    std::vector<double> times(count);
    for (double& t : times) t = draw(random);
    return times;
}

/// 4,000 draws are off by 3 √(0.95 · 0.05/4000) = 1 %; medians of few times vary less than the bound that intervals
/// assume, by up to a quarter for three [Kenney, Keeping, 1962], so that more may be within.
TEST(TimeInterval, HoldsTheMiddleOfNineteenOfTwentyOtherRuns) {
    std::mt19937 random(1);
    constexpr int kDraws = 4000;
    for (const std::size_t count : {3u, 5u, 9u, 15u})
        for (const double spread : {0.01, 0.3}) {
            SCOPED_TRACE(count);
            int within = 0;
            for (int i = 0; i < kDraws; ++i) {
                const TimeInterval interval = intervalOf(timesOf(count, spread, random));
                const double other = intervalOf(timesOf(count, spread, random)).middle;
                within += interval.low <= other && other <= interval.high;
            }
            EXPECT_GE(within, 0.94 * kDraws);
            EXPECT_LE(within, 0.99 * kDraws);
        }
}

TEST(TimeInterval, ScalesWithTheUnit) {
    const TimeInterval one = intervalOf({3, 1, 2}), thousand = intervalOf({3000, 1000, 2000});
    EXPECT_EQ(one.middle, 2);
    constexpr double kRounding = 1e-12;
    EXPECT_NEAR(thousand.low / one.low, 1000, 1000 * kRounding);
    EXPECT_NEAR(thousand.high / one.high, 1000, 1000 * kRounding);
}

TEST(TimeInterval, KnowsNothingOfASingleTime) {
    EXPECT_TRUE(std::isnan(intervalOf({2}).low));
    EXPECT_TRUE(std::isnan(intervalOf({2}).high));
    EXPECT_THROW(intervalOf({}), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop::chart
