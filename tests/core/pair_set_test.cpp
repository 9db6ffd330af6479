#include "base/pair_set.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace ragtop {
namespace {

TEST(PairSet, KeyOfAPairDoesNotDependOnItsOrder) {
    EXPECT_EQ(pairKey(3, 9), pairKey(9, 3));
    EXPECT_NE(pairKey(3, 9), pairKey(3, 10));
    EXPECT_NE(pairKey(0, 1), pairKey(1, 1));
}

TEST(PairSet, AgreesWithAMapThroughManyChanges) {
    PairSet set(std::pmr::get_default_resource());
    std::map<std::uint64_t, std::uint32_t> model;
    std::mt19937_64 random(5);
    for (std::uint32_t i = 0; i < 100000; ++i) {
        const std::uint64_t key =
            pairKey(static_cast<std::uint32_t>(random() % 64), static_cast<std::uint32_t>(random() % 64));
        if (random() % 2 == 0) {
            ASSERT_EQ(set.insert(key, i), model.emplace(key, i).second);
        } else {
            ASSERT_EQ(set.erase(key), model.erase(key) == 1);
        }
        ASSERT_EQ(set.size(), model.size());
        const std::uint64_t other =
            pairKey(static_cast<std::uint32_t>(random() % 64), static_cast<std::uint32_t>(random() % 64));
        const auto it = model.find(other);
        const std::uint32_t* found = set.find(other);
        ASSERT_EQ(found != nullptr, it != model.end());
        if (found != nullptr) {
            ASSERT_EQ(*found, it->second);
        }
    }
    for (const auto& [key, value] : model) ASSERT_EQ(*set.find(key), value);
}

TEST(PairSet, AnyKeyIsAKey) {
    PairSet set(std::pmr::get_default_resource());
    EXPECT_EQ(set.find(0), nullptr);
    EXPECT_FALSE(set.erase(0));
    EXPECT_TRUE(set.insert(0, 7));
    EXPECT_TRUE(set.insert(~std::uint64_t{0}, 8));
    EXPECT_FALSE(set.insert(0, 9));
    EXPECT_EQ(*set.find(0), 7u);
    *set.find(0) = 10;
    EXPECT_EQ(*set.find(0), 10u);
    set.clear();
    EXPECT_TRUE(set.empty());
    EXPECT_FALSE(set.contains(0));
}

TEST(PairSet, NeighbouringIndicesSpreadOut) {
    // Pairs of neighbours in rows, the usual case. With evenly spread keys the longest cluster of a table of n entries
    // at load α is about ln n / (α − 1 − ln α) = 46 long; consecutive homes would make one of thousands.
    PairSet set(std::pmr::get_default_resource());
    for (std::uint32_t i = 0; i < 10000; ++i) {
        set.insert(pairKey(i, i + 1), i);
        set.insert(pairKey(i, i + 100), i);
        set.insert(pairKey(0, i + 20000), i);
    }
    std::size_t longest = 0, run = 0;
    for (const PairSet::Entry& entry : set.entries()) {
        run = entry.used() ? run + 1 : 0;
        longest = std::max(longest, run);
    }
    EXPECT_LT(longest, 100u);
}

TEST(PairSet, RestoredTableIsTheSavedOne) {
    PairSet set(std::pmr::get_default_resource());
    for (std::uint32_t i = 0; i < 100; ++i) set.insert(pairKey(i, 2 * i + 1), i);
    const std::vector<PairSet::Entry> saved(set.entries().begin(), set.entries().end());
    for (std::uint32_t i = 0; i < 60; ++i) set.erase(pairKey(i, 2 * i + 1));
    for (std::uint32_t i = 0; i < 500; ++i) set.insert(pairKey(i, i + 7), i);
    set.restore(saved.data(), saved.size());
    EXPECT_EQ(set.size(), 100u);
    for (std::uint32_t i = 0; i < 100; ++i) ASSERT_EQ(*set.find(pairKey(i, 2 * i + 1)), i);
    EXPECT_FALSE(set.contains(pairKey(450, 457)));
}

TEST(PairSet, ReservedTableTakesNoMoreMemory) {
    alignas(16) std::byte buffer[16 * 1024 + 64];
    std::pmr::monotonic_buffer_resource memory(buffer, sizeof buffer, std::pmr::null_memory_resource());
    PairSet set(&memory);
    set.reserve(512);
    for (int round = 0; round < 10; ++round) {
        for (std::uint32_t i = 0; i < 512; ++i) set.insert(pairKey(i, i + 1), i);
        for (std::uint32_t i = 0; i < 512; ++i) ASSERT_TRUE(set.erase(pairKey(i, i + 1)));
    }
    EXPECT_TRUE(set.empty());
}

}  // namespace
}  // namespace ragtop
