#include "base/pool.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>

#include "ragtop/id.h"

namespace ragtop {
namespace {

using TestPool = Pool<int, BodyId>;

TEST(Pool, IdsOfTheErasedNameNothingEverAgain) {
    TestPool pool(std::pmr::get_default_resource());
    const BodyId first = pool.insert(1);
    EXPECT_FALSE(first.isNull());
    EXPECT_FALSE(pool.isValid(BodyId{}));
    EXPECT_FALSE(pool.isValid(BodyId{7, 1}));
    pool.erase(first);
    EXPECT_FALSE(pool.isValid(first));
    const BodyId second = pool.insert(2);
    EXPECT_EQ(second.index, first.index);
    EXPECT_NE(second.generation, first.generation);
    EXPECT_FALSE(pool.isValid(first));
    EXPECT_EQ(pool[second], 2);
}

TEST(Pool, SlotsFreedLastAreUsedFirst) {
    TestPool pool(std::pmr::get_default_resource());
    const BodyId a = pool.insert(1), b = pool.insert(2), c = pool.insert(3);
    pool.erase(a);
    pool.erase(c);
    EXPECT_EQ(pool.insert(4).index, c.index);
    EXPECT_EQ(pool.insert(5).index, a.index);
    EXPECT_EQ(pool.insert(6).index, 3u);
    EXPECT_TRUE(pool.isValid(b));
    EXPECT_EQ(pool.size(), 4u);
}

TEST(Pool, AgreesWithAMapThroughManyChanges) {
    TestPool pool(std::pmr::get_default_resource());
    std::map<BodyId, int> model;
    std::mt19937 random(3);
    for (int i = 0; i < 20000; ++i) {
        if (model.empty() || random() % 5 < 3) {
            const BodyId id = pool.insert(i);
            ASSERT_TRUE(model.emplace(id, i).second);
        } else {
            auto it = model.begin();
            std::advance(it, static_cast<long>(random() % std::min<std::size_t>(model.size(), 50)));
            pool.erase(it->first);
            ASSERT_FALSE(pool.isValid(it->first));
            model.erase(it);
        }
        ASSERT_EQ(pool.size(), model.size());
    }
    std::map<BodyId, int> seen;
    pool.forEach([&](std::uint32_t index, int value) { seen[pool.idOf(index)] = value; });
    EXPECT_EQ(seen, model);
}

TEST(Pool, RestoredPoolGivesTheSameIdsAndKnowsNoLaterOnes) {
    TestPool pool(std::pmr::get_default_resource());
    std::vector<BodyId> ids;
    for (int i = 0; i < 10; ++i) ids.push_back(pool.insert(i));
    pool.erase(ids[3]);
    pool.erase(ids[8]);
    const auto header = pool.header();
    const std::vector<int> values(pool.values().begin(), pool.values().end());
    const std::vector<std::uint32_t> generations(pool.generations().begin(), pool.generations().end());
    const std::vector<std::uint32_t> links(pool.links().begin(), pool.links().end());

    std::vector<BodyId> later;
    for (int i = 0; i < 5; ++i) later.push_back(pool.insert(100 + i));
    pool.restore(header, values, generations, links);
    for (const BodyId id : later) EXPECT_FALSE(pool.isValid(id));
    EXPECT_EQ(pool[ids[4]], 4);
    for (const BodyId id : later) EXPECT_EQ(pool.insert(0), id);
}

TEST(Pool, ErasedObjectsLetGoOfWhatTheyHold) {
    Pool<std::shared_ptr<int>, JointId> pool(std::pmr::get_default_resource());
    const auto held = std::make_shared<int>(1);
    const JointId id = pool.insert(held);
    EXPECT_EQ(held.use_count(), 2);
    pool.erase(id);
    EXPECT_EQ(held.use_count(), 1);
}

TEST(Pool, ReservedSlotsTakeNoMoreMemory) {
    std::byte buffer[4096];
    std::pmr::monotonic_buffer_resource memory(buffer, sizeof buffer, std::pmr::null_memory_resource());
    TestPool pool(&memory);
    pool.reserve(200);
    for (int i = 0; i < 200; ++i) pool.insert(i);
    EXPECT_EQ(pool.size(), 200u);
}

}  // namespace
}  // namespace ragtop
