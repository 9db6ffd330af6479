#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "base/nonzero_bytes.h"

namespace ragtop {
namespace {

/// What the words of eight leave out is what one look at each byte leaves out, at every place and length.
TEST(NonzeroBytes, AreVisitedInOrderAndOnce) {
    for (std::size_t count = 0; count < 35; ++count)
        for (std::size_t step = 1; step < 20; ++step) {
            std::vector<std::uint8_t> bytes(count, 0);
            std::vector<std::size_t> set, found;
            for (std::size_t i = step - 1; i < count; i += step) bytes[i] = 255, set.push_back(i);
            forEachNonzero(bytes.data(), count, [&](std::size_t i) { found.push_back(i); });
            EXPECT_EQ(found, set) << count << " bytes, every " << step;
        }
}

TEST(NonzeroBytes, ZerosAreNotVisited) {
    const std::vector<std::uint8_t> bytes(100, 0);
    forEachNonzero(bytes.data(), bytes.size(), [](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace ragtop
