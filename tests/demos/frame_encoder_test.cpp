#include "serve/frame_encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>

namespace ragtop {
namespace {

template <class T>
T at(const FrameBytes& frame, std::size_t offset) {
    T value{};
    EXPECT_LE(offset + sizeof value, frame->size());
    if (offset + sizeof value <= frame->size()) std::memcpy(&value, frame->data() + offset, sizeof value);
    return value;
}

std::uint32_t word(const FrameBytes& frame, std::size_t index) { return at<std::uint32_t>(frame, 4 * index); }

/// The nodes of a frame of poses, and where they are.
std::map<std::uint32_t, Frame> posesOf(const FrameBytes& frame) {
    std::map<std::uint32_t, Frame> poses;
    EXPECT_EQ(word(frame, 0), 1u);
    const std::size_t count = word(frame, 3);
    EXPECT_EQ(frame->size(), 32 + 32 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto values = at<std::array<float, 7>>(frame, 32 + 32 * i + 4);
        poses[word(frame, 8 + 8 * i)] = {{values[0], values[1], values[2]},
                                         {values[3], values[4], values[5], values[6]}};
    }
    return poses;
}

std::vector<std::uint32_t> nodesOf(const FrameBytes& frame) {
    std::vector<std::uint32_t> nodes;
    for (const auto& [node, pose] : posesOf(frame)) nodes.push_back(node);
    return nodes;
}

using Nodes = std::vector<std::uint32_t>;

NodePose nodeAt(std::uint32_t node, double x) { return {node, {{x, 0, 0}, {}}}; }

TEST(FrameEncoder, WritesWhatTheFormatSays) {
    FrameEncoder encoder({1000, 0, -5});
    const Quat turned = rotationAbout({0, 1, 0}, 0.3f);
    encoder.update(std::vector<NodePose>{{7, {{1001.5, 2, -6}, turned}}}, 42, 0.7);
    const FrameBytes frame = encoder.encode(0);
    ASSERT_EQ(frame->size(), 64u);
    EXPECT_EQ(word(frame, 0), 1u);
    EXPECT_EQ(word(frame, 1), 1u);
    EXPECT_EQ(word(frame, 2), 42u);
    EXPECT_EQ(word(frame, 3), 1u);
    EXPECT_EQ(at<double>(frame, 16), 0.7);
    EXPECT_EQ(at<double>(frame, 24), 0.0);
    EXPECT_EQ(posesOf(frame).at(7), (Frame{{1.5f, 2, -1}, turned}));
}

TEST(FrameEncoder, SendsOnlyWhatHasChanged) {
    FrameEncoder encoder;
    encoder.update(std::vector{nodeAt(0, 0), nodeAt(1, 0), nodeAt(2, 0)}, 1, 0);
    EXPECT_EQ(nodesOf(encoder.encode(0)), (Nodes{0, 1, 2}));
    encoder.update(std::vector{nodeAt(0, 0), nodeAt(1, 1), nodeAt(2, 0)}, 2, 0);
    EXPECT_EQ(nodesOf(encoder.encode(1)), Nodes{1});
    encoder.update(std::vector{nodeAt(0, 0), nodeAt(1, 1), nodeAt(2, 0)}, 3, 0);
    EXPECT_EQ(nodesOf(encoder.encode(2)), Nodes{});
    EXPECT_EQ(nodesOf(encoder.encode(0)), (Nodes{0, 1, 2}));
}

TEST(FrameEncoder, PageThatSkippedFramesGetsEveryLaterChange) {
    FrameEncoder encoder;
    encoder.update(std::vector{nodeAt(0, 0), nodeAt(1, 0), nodeAt(2, 0)}, 1, 0);
    const std::uint32_t got = encoder.sequence();
    encoder.update(std::vector{nodeAt(0, 5), nodeAt(1, 0), nodeAt(2, 0)}, 2, 0);
    encoder.update(std::vector{nodeAt(0, 5), nodeAt(1, 6), nodeAt(2, 0)}, 3, 0);
    const auto poses = posesOf(encoder.encode(got));
    ASSERT_EQ(poses.size(), 2u);
    EXPECT_EQ(poses.at(0).position.x, 5);
    EXPECT_EQ(poses.at(1).position.x, 6);
}

// Pages apply the frames they get, in any pattern of skips, and always end up with what the encoder was told.
TEST(FrameEncoder, EveryPatternOfSkipsEndsAtTheSamePoses) {
    for (unsigned pattern = 0; pattern < 64; ++pattern) {
        FrameEncoder encoder;
        std::map<std::uint32_t, Frame> drawn;
        std::uint32_t got = 0;
        for (unsigned step = 0; step < 7; ++step) {
            std::vector<NodePose> poses;
            for (std::uint32_t node = 0; node < 5; ++node) poses.push_back(nodeAt(node, step * (node + step) % 3));
            encoder.update(poses, step, step);
            if (step < 6 && (pattern >> step & 1)) continue;
            for (const auto& [node, pose] : posesOf(encoder.encode(got))) drawn[node] = pose;
            got = encoder.sequence();
            for (const NodePose& pose : poses) {
                ASSERT_EQ(drawn.at(pose.node).position, toVec3(pose.pose.position)) << pattern << " step " << step;
            }
        }
    }
}

TEST(FrameEncoder, ChangesBelowSinglePrecisionAreNone) {
    FrameEncoder encoder;
    encoder.update(std::vector{nodeAt(0, 1000)}, 1, 0);
    encoder.update(std::vector{nodeAt(0, 1000 + 1e-9)}, 2, 0);
    EXPECT_EQ(nodesOf(encoder.encode(1)), Nodes{});
}

TEST(FrameEncoder, NotANumberIsNoChangeForever) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    FrameEncoder encoder;
    encoder.update(std::vector{nodeAt(0, nan)}, 1, 0);
    encoder.update(std::vector{nodeAt(0, nan)}, 2, 0);
    EXPECT_EQ(nodesOf(encoder.encode(1)), Nodes{});
}

TEST(FrameEncoder, NodesThatGoAreNotSentAndThoseThatComeBackAre) {
    FrameEncoder encoder;
    encoder.update(std::vector{nodeAt(0, 0), nodeAt(9, 1)}, 1, 0);
    encoder.update(std::vector{nodeAt(0, 0)}, 2, 0);
    EXPECT_EQ(nodesOf(encoder.encode(0)), Nodes{0});
    encoder.update(std::vector{nodeAt(0, 0), nodeAt(9, 1)}, 3, 0);
    EXPECT_EQ(nodesOf(encoder.encode(2)), Nodes{9});
    EXPECT_EQ(nodesOf(encoder.encode(1)), Nodes{9});
}

TEST(FrameEncoder, PagesAtTheSameUpdateShareTheBytes) {
    FrameEncoder encoder;
    encoder.update(std::vector{nodeAt(0, 0)}, 1, 0);
    const FrameBytes first = encoder.encode(0);
    EXPECT_EQ(encoder.encode(0), first);
    encoder.update(std::vector{nodeAt(0, 1)}, 2, 0);
    EXPECT_NE(encoder.encode(0), first);
    EXPECT_EQ(encoder.encode(1), encoder.encode(1));
    EXPECT_NE(encoder.encode(1), encoder.encode(0));
}

TEST(FrameEncoder, EmptySceneGivesAFrameOfItsTime) {
    FrameEncoder encoder;
    encoder.update({}, 5, 0.25);
    const FrameBytes frame = encoder.encode(0);
    EXPECT_EQ(frame->size(), 32u);
    EXPECT_EQ(word(frame, 3), 0u);
    EXPECT_EQ(at<double>(frame, 16), 0.25);
}

TEST(FrameEncoder, LinesAndColorsFollowTheFormat) {
    const FrameBytes lines = encodeLines(std::vector<LineSegment>{{{1, 2, 3}, {4, 5, 6}, 0xff8000}, {}}, 9);
    ASSERT_EQ(lines->size(), 16u + 2 * 28u);
    EXPECT_EQ(word(lines, 0), 2u);
    EXPECT_EQ(word(lines, 1), 9u);
    EXPECT_EQ(word(lines, 2), 2u);
    EXPECT_EQ(word(lines, 3), 0u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(at<float>(lines, 16 + 4 * i), static_cast<float>(i + 1));
    EXPECT_EQ(word(lines, 10), 0xff8000u);

    const FrameBytes colors = encodeColors(std::vector<NodeColor>{{3, 0x123456}, {4, NodeColor::kOwn}}, 9);
    ASSERT_EQ(colors->size(), 16u + 2 * 8u);
    EXPECT_EQ(word(colors, 0), 3u);
    EXPECT_EQ(word(colors, 2), 2u);
    EXPECT_EQ(word(colors, 4), 3u);
    EXPECT_EQ(word(colors, 5), 0x123456u);
    EXPECT_EQ(word(colors, 7), 0xffffffffu);
    EXPECT_EQ(encodeLines({}, 0)->size(), 16u);
}

}  // namespace
}  // namespace ragtop
