#include "red_rows.h"

#include <gtest/gtest.h>

#include <limits>

namespace ragtop::stability {
namespace {

Row rowOf(double value) { return {"rolling", "ball: speed", "ragtop", value, 10, 1, "m/s", Verdict::fails, 0, ""}; }

TEST(RedRows, AreWorseOnceTheyAreTwiceAsFarOff) {
    const RedRow red{"rolling/ball: speed", 2};
    EXPECT_FALSE(isWorse(rowOf(12), red));
    EXPECT_FALSE(isWorse(rowOf(6.1), red));
    EXPECT_TRUE(isWorse(rowOf(14.1), red));
    EXPECT_TRUE(isWorse(rowOf(5.9), red));
    EXPECT_TRUE(isWorse(rowOf(std::numeric_limits<double>::quiet_NaN()), red));
}

TEST(RedRows, AreThoseOfRagtopThatAreListed) {
    Row row = rowOf(0);
    EXPECT_EQ(redRowOf(row), nullptr);
    for (const RedRow& red : kRedRows) {
        const std::size_t slash = red.name.find('/');
        row.family = red.name.substr(0, slash);
        row.name = red.name.substr(slash + 1);
        row.engine = "ragtop";
        EXPECT_EQ(redRowOf(row), &red);
        row.engine = "bullet";
        EXPECT_EQ(redRowOf(row), nullptr);
    }
}

}  // namespace
}  // namespace ragtop::stability
