#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes.h"
#include "shape_support.h"

/// With gravity and densities as they are, lengths × s² and times × s leave every equation of motion as it is (Froude
/// similarity), and scaling by powers of two rounds nothing. So the scaled scene moves alike to the last bit unless
/// some tolerance is an absolute number: a length, a speed, a mass, a time.
namespace ragtop {
namespace {

using scenes::Scale;
using scenes::Scenario;

WorldSettings settingsFor(const Scale& scale) {
    WorldSettings settings;
    settings.sleepTime = scale.time(settings.sleepTime);
    return settings;
}

void expectAlike(const World& unit, const World& scaled, const Scale& scale, int step) {
    ASSERT_EQ(unit.bodies().size(), scaled.bodies().size()) << "step " << step;
    for (std::size_t i = 0; i < unit.bodies().size(); ++i) {
        const BodyId a = unit.bodies()[i], b = scaled.bodies()[i];
        ASSERT_EQ(a, b);
        const Pose pose = unit.pose(a), other = scaled.pose(b);
        ASSERT_EQ(double{scale.s} * scale.s * pose.position, other.position) << "body " << a.index << " step " << step;
        ASSERT_EQ(pose.rotation, other.rotation) << "body " << a.index << " step " << step;
        ASSERT_EQ(scale.velocity(unit.linearVelocity(a)), scaled.linearVelocity(b))
            << "body " << a.index << " step " << step;
        ASSERT_EQ(scale.spin(unit.angularVelocity(a)), scaled.angularVelocity(b))
            << "body " << a.index << " step " << step;
        ASSERT_EQ(unit.isAwake(a), scaled.isAwake(b)) << "body " << a.index << " step " << step;
    }
    ASSERT_EQ(unit.stats().contacts, scaled.stats().contacts) << "step " << step;
    ASSERT_EQ(unit.stats().touching, scaled.stats().touching) << "step " << step;
}

void expectSameMotion(const Scenario& scenario, const Scale& scale, int steps) {
    World unit(settingsFor({})), scaled(settingsFor(scale));
    scenario.build(unit, {});
    scenario.build(scaled, scale);
    for (int i = 0; i < steps; ++i) {
        scenes::advance(unit, scenario);
        scenes::advance(scaled, scenario, scale);
        expectAlike(unit, scaled, scale, i);
        if (testing::Test::HasFatalFailure()) return;
    }
}

class ScalingLaw : public testing::TestWithParam<std::size_t> {
protected:
    const Scenario& scenario() const { return scenes::kScenarios[GetParam()]; }
};

TEST_P(ScalingLaw, FourTimesAsLargeMovesAlikeInTwiceTheTime) {
    expectSameMotion(scenario(), {2}, scenario().steps / 2);
}
TEST_P(ScalingLaw, OneSixteenthAsLargeMovesAlikeInAQuarterOfTheTime) {
    expectSameMotion(scenario(), {0.25f}, scenario().steps / 4);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ScalingLaw, testing::Range(std::size_t{0}, std::size(scenes::kScenarios)),
                         [](const auto& param) { return std::string(scenes::kScenarios[param.param].name); });

/// No hull where the library was built without Qhull.
std::optional<ConvexHull> hullOf(const std::vector<Vec3>& points) {
    try {
        return ConvexHull(points);
    } catch (const std::invalid_argument& error) {
        if (std::string(error.what()).find("no Qhull") == std::string::npos) throw;
        return {};
    }
}

TEST(ScalingLaw, HoldsForHulls) {
    if (!hullOf(spherePoints(2, 0.5f))) GTEST_SKIP() << "hulls take Qhull";
    constexpr Scenario kHulls{"hulls",
                              [](World& world, const Scale& scale) {
                                  const ConvexHull hull = *hullOf(spherePoints(2, scale.length(0.5f)));
                                  scenes::addBowl(world, scale);
                                  scenes::addMixedShapes(world, scale, 40, &hull);
                              },
                              true, 200};
    expectSameMotion(kHulls, {2}, kHulls.steps);
}

/// The test can fail: a time that is not scaled with the scene shows.
TEST(ScalingLaw, AbsoluteTimeShows) {
    World unit, scaled;
    scenes::addTower(unit, {}, 2);
    scenes::addTower(scaled, {2}, 2);
    int unitSteps = 0, scaledSteps = 0;
    for (int i = 0; i < 400; ++i) {
        unit.step(static_cast<double>(scenes::kStep));
        scaled.step(static_cast<double>(2 * scenes::kStep));
        unitSteps += unit.isAwake(unit.bodies()[1]);
        scaledSteps += scaled.isAwake(scaled.bodies()[1]);
    }
    EXPECT_LT(scaledSteps, unitSteps);
}

}  // namespace
}  // namespace ragtop
