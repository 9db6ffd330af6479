#include "base/stage_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory_resource>

#include "counted_memory.h"

namespace ragtop {
namespace {

using test::CountedMemory;

std::size_t wanted(std::size_t doubles, std::size_t bytes) {
    return StageMemory::bytesOf<double>(doubles) + StageMemory::bytesOf<std::uint8_t>(bytes);
}

TEST(StageMemory, ArraysOfOneStageShareNothing) {
    StageMemory memory(std::pmr::get_default_resource());
    memory.begin(wanted(100, 33));
    auto numbers = memory.take<double>(100);
    auto marks = memory.take<std::uint8_t>(33);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(marks.data()) % 64, 0u);
    for (int i = 0; i < 100; ++i) numbers.push(i);
    marks.resizeForOverwrite(33);
    for (std::uint8_t& mark : marks) mark = 0xff;
    ASSERT_EQ(numbers.size(), 100u);
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(numbers[i], static_cast<double>(i));
}

TEST(StageMemory, HoldsWhatTheGreediestStageWantsAndAsksForItOnce) {
    CountedMemory resource;
    StageMemory memory(&resource);
    memory.begin(wanted(1000, 0));
    const std::size_t held = resource.held;
    EXPECT_GE(held, 1000 * sizeof(double));
    EXPECT_LT(held, 2 * 1000 * sizeof(double));
    const long calls = resource.calls;
    for (const std::size_t count : {10u, 1000u, 0u, 999u}) {
        memory.begin(wanted(count, 0));
        EXPECT_EQ(memory.take<double>(count).room(), count);
        EXPECT_TRUE(memory.capacity() >= count * sizeof(double));
    }
    EXPECT_EQ(resource.calls, calls);
    EXPECT_EQ(resource.held, held);
}

TEST(StageMemory, GivesUpWhatItHeldBeforeItAsksForMore) {
    CountedMemory resource;
    StageMemory memory(&resource);
    memory.begin(1 << 20);
    memory.begin(4 << 20);
    EXPECT_EQ(resource.held, memory.capacity());
}

}  // namespace
}  // namespace ragtop
