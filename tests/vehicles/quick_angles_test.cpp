#include "quick_angles.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "four_angles.h"

namespace ragtop {
namespace {

constexpr float kWithin = 3e-7f;

TEST(QuickAngles, AreWithinARoundingOfTheTruth) {
    for (int i = -31416; i <= 31416; ++i) {
        const float x = 1e-4f * static_cast<float>(i);
        const auto truth = static_cast<double>(x);
        ASSERT_NEAR(quickSin(x), std::sin(truth), kWithin) << x;
        ASSERT_NEAR(quickCos(x), std::cos(truth), kWithin) << x;
        ASSERT_NEAR(quickArcTan(x), std::atan(truth), kWithin) << x;
        ASSERT_NEAR(quickArcTan(1000 * x), std::atan(static_cast<double>(1000 * x)), kWithin) << x;
        const double angle = 0.5 * truth;
        ASSERT_NEAR(quickArcSin(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle))), angle,
                    kWithin);
    }
}

/// Small ones keep their digits: slopes of laws at rest are made of them.
TEST(QuickAngles, KeepTheirSlopeAtZero) {
    for (const float x : {1e-3f, 1e-6f, -1e-9f, 1e-30f}) {
        EXPECT_FLOAT_EQ(quickSin(x), static_cast<float>(std::sin(static_cast<double>(x))));
        EXPECT_FLOAT_EQ(quickArcTan(x), static_cast<float>(std::atan(static_cast<double>(x))));
    }
}

TEST(QuickAngles, AreTheSameForFour) {
    const std::vector<float> some{-2e4f, -700, -3.2f, -1, -0.3f, -0.0f, 1e-20f, 0.7f, 1, 1.0000001f, 2.5f, 90, 1e30f};
    const auto same = [](float a, float b) {
        return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
    };
    for (std::size_t i = 0; i + 4 <= some.size(); ++i) {
        const FourFloats x{some[i], some[i + 1], some[i + 2], some[i + 3]};
        const FourFloats arc = quickArcTan(x), wave = quickSinOrCos(x, FourInts{-1, 0, -1, 0});
        for (int k = 0; k < 4; ++k) {
            EXPECT_TRUE(same(arc[k], quickArcTan(x[k]))) << x[k];
            EXPECT_TRUE(same(wave[k], k % 2 == 0 ? quickCos(x[k]) : quickSin(x[k]))) << x[k];
        }
    }
    const FourFloats none = quickSinOrCos(FourFloats{NAN, 1, INFINITY, 0}, FourInts{0, 0, -1, -1});
    EXPECT_TRUE(std::isnan(none[0]) && std::isnan(none[2]));
    EXPECT_EQ(none[3], 1);
}

TEST(QuickAngles, StayBoundedFarAwayAndTellWhatIsNoNumber) {
    for (const float x : {20.0f, 9999.0f, 1e6f, -3e30f}) {
        EXPECT_LE(std::abs(quickSin(x)), 1.0001f);
        EXPECT_LE(std::abs(quickCos(x)), 1.0001f);
        EXPECT_NEAR(std::abs(quickArcTan(x)), std::atan(std::abs(static_cast<double>(x))), kWithin);
    }
    for (const float x : {NAN, INFINITY}) EXPECT_TRUE(std::isnan(quickSin(x)) && std::isnan(quickCos(x)));
    EXPECT_TRUE(std::isnan(quickArcTan(NAN)));
    EXPECT_FLOAT_EQ(quickArcTan(-INFINITY), -1.57079633f);
}

}  // namespace
}  // namespace ragtop
