#include "base/paged_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "counted_memory.h"

namespace ragtop {
namespace {

using test::CountedMemory;

struct alignas(64) Item {
    std::uint64_t number = 7;
};
using Array = PagedArray<Item>;

TEST(PagedArray, ElementsKeepTheirValuesAsItGrows) {
    CountedMemory memory;
    {
        Array array(&memory);
        for (std::size_t i = 0; i < 5 * Array::kPage + 3; ++i) {
            array.resize(i + 1, {});
            ASSERT_EQ(array[i].number, 7u);
            array[i].number = i;
        }
        for (std::size_t i = 0; i < array.size(); ++i) ASSERT_EQ(array[i].number, i);
    }
    EXPECT_EQ(memory.held, 0u);
}

TEST(PagedArray, GrowsWithoutCopiesAndWithLittleToSpare) {
    CountedMemory memory;
    Array array(&memory);
    array.resize(Array::kPage, {});
    const Item* first = &array[0];
    memory.peak = 0;
    for (std::size_t pages = 1; pages <= 40; ++pages) array.resize(pages * Array::kPage + 1, {});
    EXPECT_EQ(first, &array[0]);
    EXPECT_LE(array.capacity(), 42 * Array::kPage);
    // Beside the pages, no more than the table of their places and its copy as it grows.
    EXPECT_LE(memory.peak, 42 * Array::kPage * sizeof(Item) + 2 * 64 * sizeof(Item*));
}

TEST(PagedArray, SmallOnesTakeLittle) {
    CountedMemory memory;
    Array array(&memory);
    array.resize(20, {});
    EXPECT_LE(memory.held, 32 * sizeof(Item) + 16 * sizeof(Item*));
}

TEST(PagedArray, PartsAndRestoreAreTheElementsInOrder) {
    Array array(std::pmr::get_default_resource()), copy(std::pmr::get_default_resource());
    array.resize(2 * Array::kPage + 5, {});
    for (std::size_t i = 0; i < array.size(); ++i) array[i].number = i * i;
    std::vector<std::byte> bytes;
    array.forEachPart([&](const void* from, std::size_t count) {
        const auto* part = static_cast<const std::byte*>(from);
        bytes.insert(bytes.end(), part, part + count);
    });
    ASSERT_EQ(bytes.size(), array.size() * sizeof(Item));
    copy.resize(3, {});
    copy.restore(bytes.data(), array.size());
    ASSERT_EQ(copy.size(), array.size());
    for (std::size_t i = 0; i < array.size(); ++i) ASSERT_EQ(copy[i].number, i * i);
    copy.restore(bytes.data(), 2);
    EXPECT_EQ(copy.size(), 2u);
}

}  // namespace
}  // namespace ragtop
