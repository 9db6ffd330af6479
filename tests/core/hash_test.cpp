#include "base/hash.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <limits>
#include <set>

namespace ragtop {
namespace {

template <class... T>
std::uint64_t hashOf(const T&... values) {
    StateHash hash;
    (hash.add(values), ...);
    return hash.value();
}

TEST(StateHash, EqualStatesHaveEqualDigests) {
    EXPECT_EQ(hashOf(0.0f), hashOf(-0.0f));
    EXPECT_EQ(hashOf(0.0), hashOf(-0.0));
    EXPECT_EQ(hashOf(Vec3{0, 1, -0.0f}), hashOf(Vec3{-0.0f, 1, 0}));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(hashOf(nan), hashOf(-nan));
}

TEST(StateHash, EveryBitCounts) {
    std::set<std::uint64_t> digests{hashOf(std::uint64_t{0})};
    for (int bit = 0; bit < 64; ++bit) digests.insert(hashOf(std::uint64_t{1} << bit));
    EXPECT_EQ(digests.size(), 65u);
    digests.clear();
    const Quat q{0.1f, 0.2f, 0.3f, 0.4f};
    for (int i = 0; i < 4; ++i) {
        auto words = std::bit_cast<std::array<std::uint32_t, 4>>(q);
        for (int bit = 0; bit < 32; ++bit) {
            words[static_cast<std::size_t>(i)] ^= 1u << bit;
            digests.insert(hashOf(std::bit_cast<Quat>(words)));
            words[static_cast<std::size_t>(i)] ^= 1u << bit;
        }
    }
    EXPECT_EQ(digests.size(), 128u);
    EXPECT_FALSE(digests.contains(hashOf(q)));
}

TEST(StateHash, OrderAndNumberOfValuesCount) {
    EXPECT_NE(hashOf(1.0f, 2.0f), hashOf(2.0f, 1.0f));
    EXPECT_NE(hashOf(std::uint32_t{0}), hashOf(std::uint32_t{0}, std::uint32_t{0}));
    EXPECT_NE(hashOf(BodyId{1, 2}), hashOf(BodyId{2, 1}));
    const std::array<std::byte, 9> zeros{};
    EXPECT_NE(hashOf(std::span(zeros).first(7)), hashOf(std::span(zeros).first(8)));
    EXPECT_NE(hashOf(std::span(zeros).first(8)), hashOf(std::span(zeros).first(9)));
}

TEST(StateHash, OneChangedBitFlipsHalfOfTheDigest) {
    // 64 · 64 nearly fair coins: mean 32 per digest, standard error of the mean 4 / 8 = 0.5; five of them.
    int flipped = 0;
    for (int bit = 0; bit < 64; ++bit) {
        const std::uint64_t word = 12345;
        flipped += std::popcount(hashOf(word) ^ hashOf(word ^ (std::uint64_t{1} << bit)));
    }
    EXPECT_NEAR(flipped / 64.0, 32, 2.5);
}

TEST(StateHash, DigestIsTheSameOnEveryPlatform) {
    // From the definition, evaluated with big integers in another language.
    EXPECT_EQ(hashOf(Pose{{1.5, -2, 3e7}, {0, 0.6f, 0, 0.8f}}, std::uint32_t{7}, true), 203307260661815335u);
}

}  // namespace
}  // namespace ragtop
