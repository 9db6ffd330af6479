#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory_resource>

#include "constraints/constraint_graph.h"
#include "constraints/lane_view.h"
#include "counted_memory.h"

namespace ragtop {
namespace {

/// Contacts of one colour; number i has i · 5 mod 6 points where that is below five, and else none.
class Groups : public testing::TestWithParam<int> {
protected:
    static constexpr std::uint32_t kContacts = 75;
    ConstraintGraph graph{GetParam(), std::pmr::get_default_resource()};
    std::map<std::uint32_t, GraphPlace> places;

    static std::uint32_t pointsOf(std::uint32_t i) { return i * 5 % 6 < 5 ? i * 5 % 6 : 0; }
    static float valueOf(std::uint32_t i, int field) { return static_cast<float>(1000 * i) + static_cast<float>(field); }
    LaneView lane(GraphPlace place) { return {graph.lane(place), graph.lanes()}; }
    void SetUp() override {
        for (std::uint32_t i = 0; i < kContacts; ++i) {
            places[i] = graph.insertContact(i, 2 * i + 1, true, 2 * i + 2, true, ConstraintGraph::By::iteration);
            ASSERT_EQ(places[i].color, 0u);
            for (int field = 0; field < contact::kFields; ++field) lane(places[i]).at(field) = valueOf(i, field);
            lane(places[i]).setBits(contact::kPointCount, pointsOf(i));
        }
    }
    int group() {
        int moved = 0;
        graph.groupByPoints(0, [&](std::uint32_t manifold, std::uint32_t slot) { places[manifold].slot = slot, ++moved; });
        return moved;
    }
    std::uint32_t pointsAt(std::uint32_t slot) {
        std::uint32_t count;
        std::memcpy(&count, &lane({0, slot}).at(contact::kPointCount), sizeof count);
        return count;
    }
};

// Few contacts need a second colour, and of them more or fewer in every step: they ask for memory once.
TEST(ConstraintGraph, ColoursOfFewContactsGrowByAllContacts) {
    constexpr std::uint32_t kMany = 16384;
    ConstraintGraph graph(8, std::pmr::get_default_resource());
    for (std::uint32_t i = 0; i < kMany; ++i)
        graph.insertContact(i, 2 * i + 1, true, 2 * i + 2, true, ConstraintGraph::By::iteration);
    const auto addSecond = [&](std::uint32_t i) {
        return graph.insertContact(kMany + i, 4 * i + 1, true, 4 * i + 3, true, ConstraintGraph::By::iteration);
    };
    ASSERT_EQ(addSecond(0).color, 1u);
    const ConstraintGraph::Color& color = graph.color(1);
    const float* bundles = color.bundles.data();
    for (std::uint32_t i = 1; i < kMany / 64; ++i) ASSERT_EQ(addSecond(i).color, 1u);
    EXPECT_EQ(color.bundles.data(), bundles);
    EXPECT_GE(color.points.capacity(), color.manifolds.size());
}

// A structure that is laid at once has all its contacts in one step.
TEST(ConstraintGraph, TakesAllContactsOfAStructureInFewSteps) {
    constexpr std::uint32_t kMany = 16384;
    test::CountedMemory memory;
    ConstraintGraph graph(8, &memory);
    graph.expectContacts(kMany);
    for (std::uint32_t i = 0; i < kMany; ++i)
        graph.insertContact(i, 2 * i + 1, true, 2 * i + 2, true, ConstraintGraph::By::iteration);
    graph.expectContacts(0);
    constexpr long kDoublings = 9, kArrays = 4;  // from 64; of a colour, and of its bodies
    EXPECT_LE(memory.calls, kArrays * kDoublings + kDoublings);
    EXPECT_LE(graph.color(0).manifolds.capacity(), kMany + kMany / 64) << "and no more room than they need";

    graph.expectContacts(0, kMany);
    const long before = memory.calls;
    for (std::uint32_t i = 0; i < kMany; ++i)
        graph.insertContact(kMany + i, 2 * i + 1, true, 2 * i + 2, true, ConstraintGraph::By::direct);
    EXPECT_EQ(memory.calls, before);
    EXPECT_EQ(graph.color(ConstraintGraph::kDirect).manifolds.capacity(), kMany);
}

// A few more in every step ask for memory seldom.
TEST(ConstraintGraph, FewMoreDirectContactsAtATimeGrowTheirListBySharesOfIt) {
    constexpr std::uint32_t kMany = 1024;
    test::CountedMemory memory;
    ConstraintGraph graph(8, &memory);
    for (std::uint32_t i = 0; i < kMany; ++i) {
        graph.expectContacts(0, 1);
        graph.insertContact(i, 2 * i + 1, true, 2 * i + 2, true, ConstraintGraph::By::direct);
    }
    constexpr long kDoublings = 5, kArrays = 3;  // from 64, which is one more
    EXPECT_LE(memory.calls, kArrays * (kDoublings + 1));
}

TEST_P(Groups, StandInTheOrderOfTheirPointsAndStaySo) {
    EXPECT_GT(group(), 0);
    for (std::uint32_t slot = 1; slot < kContacts; ++slot) EXPECT_LE(pointsAt(slot), pointsAt(slot - 1));
    EXPECT_EQ(group(), 0);
}

TEST_P(Groups, KeepWhatOutlivesAStep) {
    group();
    for (const auto& [i, place] : places) {
        EXPECT_EQ(graph.color(0).manifolds[place.slot], i);
        EXPECT_EQ(pointsAt(place.slot), pointsOf(i));
        for (const int field : {int{contact::kBodyA}, int{contact::kBodyB}, int{contact::kRecordB}, int{contact::kFriction},
                                int{contact::kSize}, int{contact::kFrictionImpulse}, contact::kStick + 2,
                                int{contact::kRestitution}, contact::kSurface + 2, int{contact::kShifted}})
            EXPECT_EQ(lane(place).at(field), valueOf(i, field)) << field;
        for (int j = 0; j < static_cast<int>(pointsOf(i)); ++j)
            for (const int field : {contact::kImpulse, contact::kLoad})
                EXPECT_EQ(lane(place).at(j, field), valueOf(i, contact::kPoints + j * contact::kPointFields + field));
    }
}

/// One that changes its points costs no more than an exchange per kind that it passes.
TEST_P(Groups, MoveLittleWhenLittleChanges) {
    group();
    lane(places[6]).setBits(contact::kPointCount, 4);
    EXPECT_LE(group(), 2 * contact::kMaxPoints);
    EXPECT_EQ(pointsAt(places[6].slot), 4u);
}

INSTANTIATE_TEST_SUITE_P(Lanes, Groups, testing::Values(4, 8, 16));

}  // namespace
}  // namespace ragtop
