#include "sabotage.h"

#include <gtest/gtest.h>

#include <cmath>

#include "report.h"
#include "scenery.h"

namespace ragtop::stability {
namespace {

const EngineKind kSaboteurs{"saboteurs", nullptr};

std::vector<Row> sabotaged(const std::function<void(Trial&)>& run) {
    return sabotage({"case", run}, {"family", "case", &kSaboteurs, 1.0 / 60, {}});
}

Scene boxOnFloor() {
    Scene scene;
    addFloor(scene, surface(0.5f));
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, surface(0.5f)));
    return scene;
}

TEST(Sabotage, NamesThoseThatARowFailsFor) {
    const std::vector<Row> rows = sabotaged([](Trial& trial) {
        stability::Run run = trial.start(boxOnFloor());
        run.advance(1);
        trial.expectAtMost("sinks", 0.5 - run.height(1), 0.01, "m");
    });
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].verdict, Verdict::holds);
    EXPECT_EQ(rows[0].note, "hollow, nan");
}

/// A bound from one side, which what stands still or falls keeps too.
TEST(Sabotage, TakesAwayTheLimitsThatARowIsAbout) {
    const std::vector<Row> rows = sabotaged([](Trial& trial) {
        Scene scene;
        scene.settings.gravity = {};
        const int wheel = add(scene, solidBody(Sphere{0.2f}, {}, 1, {}));
        scene.bodies[static_cast<std::size_t>(wheel)].def.angularVelocity = {0.5f, 0, 0};
        addHinge(scene, kWorld, wheel, {}, {1, 0, 0}).limit = Range{-1, 0.1f};
        stability::Run run = trial.start(scene);
        run.advance(1);
        trial.expectAtLeast("stays before its stop",
                            0.101 - 2 * std::asin(static_cast<double>(run.motion(wheel).pose.rotation.x)), 0, "rad");
    });
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].note, "limitless, nan");
}

TEST(Sabotage, KeepsARowThatFailsForNanAloneApart) {
    const std::vector<Row> rows = sabotaged([](Trial& trial) {
        stability::Run run = trial.start(boxOnFloor());
        run.advance(0.1);
        trial.expectAtMost("nothing", 0, 1, "m");
    });
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].note, "nan");
}

TEST(Sabotage, SkipsARowThatRunsNoEngine) {
    const std::vector<Row> rows = sabotaged([](Trial& trial) { trial.expectAtMost("nothing", 0, 1, "m"); });
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].verdict, Verdict::skipped);
}

TEST(Report, TellsRowsThatWereSkippedFromThoseThatFailed) {
    std::vector<Row> rows(3);
    rows[0].verdict = Verdict::holds;
    rows[1].verdict = Verdict::fails;
    rows[2].verdict = Verdict::skipped;
    rows[2].note = "why";
    const std::vector<Row> read = rowsFromJson(toJson(rows));
    ASSERT_EQ(read.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(read[i].verdict, rows[i].verdict);
    EXPECT_EQ(read[2].note, "why");
}

}  // namespace
}  // namespace ragtop::stability
