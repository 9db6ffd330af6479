#include <gtest/gtest.h>

#include <cstring>

#include "live_support.h"
#include "ragtop/world.h"

namespace ragtop::live {
namespace {

template <class T>
T wordOf(const FrameBytes& frame, std::size_t index) {
    T value{};
    std::memcpy(&value, frame->data() + 4 * index, sizeof value);
    return value;
}

/// A flag that hangs, and a rope that lies in no wind.
std::string flagScene() {
    return R"({
  "settings": {"gravity": [0, -9.81, 0]},
  "bodies": [{"name": "post", "type": "fixed", "shape": {"box": {}}}],
  "cloths": [{"name": "flag", "color": "#102030", "position": [0, 5, 0], "sheet": {"columns": 3, "rows": 4},
              "holds": [{"row": 0}], "wind": [0, 0, 3]},
             {"name": "rope", "position": [4, 5, 0], "rope": {"points": 4}, "holds": [{"points": [0]}]}]
})";
}

TEST_F(SessionTest, ClothsAreToldWithTheirPointsFacesAndLines) {
    open(folder_.write("flag.json", flagScene()).string());
    const Json cloths = pages_.last(kPage, "scene")["cloths"];
    ASSERT_EQ(cloths.size(), 2u);
    EXPECT_EQ(cloths[0]["name"], "flag");
    EXPECT_EQ(cloths[0]["color"], 0x102030);
    EXPECT_EQ(cloths[0]["positions"].size(), 3u * 12u);
    EXPECT_EQ(cloths[0]["positions"][1], 5);
    EXPECT_EQ(cloths[0]["indices"].size(), 3u * 2u * 6u);
    EXPECT_EQ(cloths[0]["lines"].size(), 0u);
    EXPECT_EQ(cloths[1]["indices"].size(), 0u);
    EXPECT_EQ(cloths[1]["lines"], Json({0, 1, 1, 2, 2, 3}));
}

/// A page that is slow gets the points of the latest step, and what stands still is not sent again.
TEST_F(SessionTest, FramesOfPointsFollowThePosesOfTheirStep) {
    open(folder_.write("flag.json", flagScene()).string());
    session_->advance(0);
    pages_.frames[kPage].clear();
    session_->advance(0);
    EXPECT_TRUE(pages_.frames[kPage].empty());
    pages_.slow[kPage] = true;
    steps(1);
    steps(29);
    EXPECT_TRUE(pages_.frames[kPage].empty());
    pages_.slow[kPage] = false;
    session_->advance(0);
    ASSERT_EQ(pages_.frames[kPage].size(), 2u);
    const FrameBytes& poses = pages_.frames[kPage][0];
    const FrameBytes& points = pages_.frames[kPage][1];
    EXPECT_EQ(wordOf<std::uint32_t>(poses, 0), 1u);
    EXPECT_EQ(wordOf<std::uint32_t>(points, 0), 4u);
    EXPECT_EQ(wordOf<std::uint32_t>(points, 1), 30u);
    EXPECT_EQ(wordOf<std::uint32_t>(points, 2), 16u);
    ASSERT_EQ(points->size(), 4u * (4u + 3u * 16u));
    const DVec3 corner = session_->stage().cast().cloths[0].cloth->point(11);
    EXPECT_FLOAT_EQ(wordOf<float>(points, 4 + 3 * 11 + 2), static_cast<float>(corner.z));
    EXPECT_GT(corner.z, 0.01);
}

TEST_F(SessionTest, ClothsGoBackInTimeToTheBit) {
    open(folder_.write("flag.json", flagScene()).string());
    steps(40);
    const std::string there = hash();
    const DVec3 corner = session_->stage().cast().cloths[0].cloth->point(11);
    steps(20);
    expectOk({{"do", "seek"}, {"step", 40}});
    EXPECT_EQ(hash(), there);
    EXPECT_EQ(session_->stage().cast().cloths[0].cloth->point(11).z, corner.z);
    expectOk({{"do", "tune"}, {"path", "cloths.flag.wind"}, {"value", Json::array({0, 0, -3})}});
    steps(60);
    EXPECT_LT(session_->stage().cast().cloths[0].cloth->point(11).z, 0);
}

}  // namespace
}  // namespace ragtop::live
