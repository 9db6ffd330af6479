#include <gtest/gtest.h>

#include <cstdint>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "ragtop/tasks.h"
#include "scenes.h"
#include "solve/kernel_table.h"

namespace ragtop {
namespace {

using scenes::Scenario;

/// An emulated or sanitized processor takes an eighth of the steps.
#if defined(__aarch64__) || defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr int kShare = 8;
#else
constexpr int kShare = 1;
#endif

std::uint64_t hashAfter(const Scenario& scenario, const WorldConfig& config, int steps) {
    World world({}, config);
    scenario.build(world, {});
    for (int i = 0; i < steps; ++i) scenes::advance(world, scenario);
    return world.hash();
}

/// Digests after an eighth of the steps, and after all of them: equal in debug and release builds, from every compiler,
/// on every processor. They change when the method does, and only then.
struct Golden {
    std::uint64_t early, late;
};
constexpr Golden kGolden[] = {
    {0x1967b00e8e61c517u, 0x8f24942048d93387u},  // tower
    {0xb05c084b37cd0787u, 0x234ebc5537adb501u},  // wall
    {0x7a6704830d2bcf10u, 0x5c86525dabb5e684u},  // hills
    {0xc43d88959e803095u, 0x0168ffdb35638c6fu},  // bowl
    {0xe0b0612291853f01u, 0xb5a3aefdcb28a0cbu},  // joints
    {0xf4b4444586bd530fu, 0x851edbb589a4fb25u},  // spinners
    {0xefa6f2b1da44b200u, 0x010b013794c1c4afu},  // chains
    {0x2eff9bfa1dc49a02u, 0x50c661b6da42a24fu},  // house
};
static_assert(std::size(kGolden) == std::size(scenes::kScenarios));

class Determinism : public testing::TestWithParam<std::size_t> {
protected:
    const Scenario& scenario() const { return scenes::kScenarios[GetParam()]; }
};

std::string text(std::uint64_t hash) {
    std::ostringstream out;
    out << "0x" << std::hex << std::setw(16) << std::setfill('0') << hash;
    return out.str();
}

TEST_P(Determinism, SceneGivesTheSameBitsOnEveryPlatform) {
    World world;
    scenario().build(world, {});
    const int early = scenario().steps / 8;
    for (int i = 0; i < early; ++i) scenes::advance(world, scenario());
    EXPECT_EQ(text(world.hash()), text(kGolden[GetParam()].early));
    if (kShare > 1) return;
    for (int i = early; i < scenario().steps; ++i) scenes::advance(world, scenario());
    EXPECT_EQ(text(world.hash()), text(kGolden[GetParam()].late));
}

TEST_P(Determinism, LanesDoNotMatter) {
    const int steps = scenario().steps / kShare;
    const std::uint64_t expected = hashAfter(scenario(), {.lanes = 4}, steps);
    EXPECT_EQ(hashAfter(scenario(), {.lanes = 8}, steps), expected);
    EXPECT_EQ(hashAfter(scenario(), {.lanes = 16}, steps), expected);
}

/// The kernels of processors that have less than this one.
TEST_P(Determinism, InstructionsDoNotMatter) {
    const int steps = scenario().steps / 8;
    const std::uint64_t expected = hashAfter(scenario(), {.lanes = 4}, steps);
    const Instructions widest = usableInstructions();
    for (const Instructions most : {Instructions::baseline, Instructions::avx2}) {
        if (most >= widest) continue;
        limitInstructions(most);
        for (const int lanes : {4, 8, 16})
            EXPECT_EQ(hashAfter(scenario(), {.lanes = lanes}, steps), expected) << static_cast<int>(most);
        limitInstructions(widest);
    }
}

TEST_P(Determinism, ThreadsDoNotMatter) {
    const int steps = scenario().steps / kShare;
    const std::uint64_t expected = hashAfter(scenario(), {}, steps);
    for (const int workers : {2, 4}) {
        EXPECT_EQ(hashAfter(scenario(), {.tasks = threadTasks(workers)}, steps), expected) << workers << " threads";
        EXPECT_EQ(hashAfter(scenario(), {.tasks = tbbTasks(workers)}, steps), expected) << workers << " TBB threads";
    }
    EXPECT_EQ(hashAfter(scenario(), {.tasks = threadTasks(4), .lanes = 4}, steps), expected);
}

TEST_P(Determinism, MemorySetAsideDoesNotMatter) {
    const int steps = scenario().steps / 8;
    EXPECT_EQ(hashAfter(scenario(), {.expectedBodies = 5000}, steps), hashAfter(scenario(), {}, steps));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Determinism, testing::Range(std::size_t{0}, std::size(scenes::kScenarios)),
                         [](const auto& param) { return std::string(scenes::kScenarios[param.param].name); });

/// Two worlds in one process share nothing.
TEST(Determinism, WorldsDoNotDisturbEachOther) {
    const Scenario& scenario = scenes::kScenarios[3];
    World first, second;
    scenario.build(first, {});
    for (int i = 0; i < 20; ++i) scenes::advance(first, scenario);
    scenario.build(second, {});
    for (int i = 0; i < 20; ++i) {
        scenes::advance(second, scenario);
        scenes::advance(first, scenario);
    }
    EXPECT_EQ(second.hash(), hashAfter(scenario, {}, 20));
    EXPECT_EQ(first.hash(), hashAfter(scenario, {}, 40));
}

TEST(Determinism, FarFromTheOriginStillTheSameForAllThreadsAndLanes) {
    const auto run = [](const WorldConfig& config) {
        World world({}, config);
        world.create(StaticBody{.shape = Box{{64, 1, 64}}, .position = {65536, -1, 65536}});
        for (int i = 0; i < 20; ++i)
            world.create(DynamicBody{.shape = Box{{0.5f, 0.25f, 0.5f}},
                                     .position = {65536 + 0.125 * (i % 3), 0.25 + 0.75 * i, 65536}});
        for (int i = 0; i < 100; ++i) world.step(1.0 / 60);
        return world.hash();
    };
    const std::uint64_t expected = run({.lanes = 4});
    EXPECT_EQ(run({.tasks = threadTasks(4), .lanes = 16}), expected);
}

/// Contacts with what is fixed are solved without its rows where a bundle has no others. Four at a time, these fill bundles
/// of their own; eight or sixteen share them with contacts of a floor that could move. The impulses are the same.
TEST(Determinism, GroundThatIsAloneInABundleGivesTheSameBits) {
    const auto run = [](const WorldConfig& config) {
        World world({}, config);
        constexpr int kPlaces = 48, kTogether = 4;
        const Shape shapes[] = {Box{{0.4f, 0.4f, 0.4f}}, Sphere{0.4f}, Capsule{0.3f, 0.2f}, Box{{0.5f, 0.2f, 0.3f}}};
        const std::vector<Vec3> corners{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}};
        const std::vector<Triangle> halves{{0, 1, 2}, {0, 2, 3}};
        const TriangleMesh floor(corners, halves);
        for (int i = 0; i < kPlaces; ++i) {
            const DVec3 at{4.0 * (i % 8 - 3.5), 0, 4.0 * (i / 8 - 2.5)};
            const bool fixed = i / kTogether % 2 == 0, turned = i % 3 != 0, thrown = i % 5 != 0;
            world.create(BodyDef{.type = fixed ? BodyType::fixed : BodyType::kinematic,
                                 .shapes = {ShapeDef{.geometry = floor}},
                                 .pose = {at, {}}});
            world.create(DynamicBody{.shape = shapes[i % 4],
                                     .position = at + Vec3{0, 0.7f, 0},
                                     .rotation = turned ? normalized(Quat{0.3f, -0.2f, 0.4f, 1}) : Quat{},
                                     .linearVelocity = thrown ? Vec3{0.5f, 0, i % 2 == 0 ? -0.5f : 0} : Vec3{}});
        }
        for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
        return world.hash();
    };
    const std::uint64_t expected = run({.lanes = 4});
    EXPECT_EQ(run({.lanes = 8}), expected);
    EXPECT_EQ(run({.lanes = 16}), expected);
}

/// A step may begin or end any number of contacts on any thread; what is told of them has one order.
TEST(Determinism, EventsComeInOneOrder) {
    const auto told = [](const WorldConfig& config) {
        World world({}, config);
        scenes::addWallAndBall(world);
        std::vector<ContactEvent> events;
        for (int i = 0; i < 120 / kShare; ++i) {
            world.step(1.0 / 60);
            events.insert(events.end(), world.contactBegins().begin(), world.contactBegins().end());
            events.insert(events.end(), world.contactEnds().begin(), world.contactEnds().end());
        }
        return events;
    };
    const std::vector<ContactEvent> expected = told({});
    EXPECT_FALSE(expected.empty());
    EXPECT_TRUE(told({.tasks = threadTasks(4), .lanes = 4}) == expected);
}

}  // namespace
}  // namespace ragtop
