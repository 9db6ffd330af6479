#include "trial.h"

#include <gtest/gtest.h>

#include <limits>

#include "extremes.h"
#include "scenery.h"

namespace ragtop::stability {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A body that stays where it is, until it is lost or the engine complains after two steps.
struct Still : Engine {
    void step(double) override { ++steps; }
    BodyMotion motion(int) const override {
        BodyMotion motion;
        if (lost && steps > 2) motion.pose.position.x = kNan;
        return motion;
    }
    void setVelocity(int, const Vec3&, const Vec3&) override {}
    void push(int, const Vec3&, const DVec3&) override {}
    void remove(int) override {}
    double normalForce(int, int) const override { return 0; }
    std::string complaint() const override { return complains && steps > 2 ? "full" : ""; }

    int steps = 0;
    bool lost = false, complains = false;
};

struct Lost : Still {
    Lost() { lost = true; }
};
struct Complaining : Still {
    Complaining() { complains = true; }
};

/// What a trial tells of a body that should be where it was, and whose value says that it is.
template <class Kind>
Row rowAfter(double seconds) {
    const EngineKind kind{"test", [](const Scene&) -> std::unique_ptr<Engine> { return std::make_unique<Kind>(); }};
    Trial trial({"family", "case", &kind, 1.0 / 60, {}});
    Scene scene;
    add(scene, solidBody(Sphere{1}, {}, 1, {}));
    Run run = trial.start(scene);
    run.advance(seconds);
    trial.expectAtMost("nothing", 0, 1, "m");
    return trial.rows().at(0);
}

TEST(Extremes, KeepWhatIsNoNumber) {
    EXPECT_EQ(larger(1.0, 2.0), 2);
    EXPECT_EQ(smaller(1.0, 2.0), 1);
    EXPECT_TRUE(std::isnan(larger(1.0, kNan)));
    EXPECT_TRUE(std::isnan(larger(kNan, 1.0)));
    EXPECT_TRUE(std::isnan(smaller(1.0, kNan)));
    EXPECT_TRUE(std::isnan(smaller(kNan, 1.0)));
}

TEST(Trial, PassesWhenTheValueIsWithinItsBound) {
    const Row row = rowAfter<Still>(1);
    EXPECT_EQ(row.verdict, Verdict::holds);
    EXPECT_EQ(row.note, "");
}

TEST(Trial, FailsOnceABodyIsNowhereWhateverTheValue) {
    EXPECT_EQ(rowAfter<Lost>(0.02).verdict, Verdict::holds);
    const Row row = rowAfter<Lost>(1);
    EXPECT_EQ(row.verdict, Verdict::fails);
    EXPECT_EQ(row.note, "body 0 is nowhere after 0.05 s");
}

TEST(Trial, FailsOnceTheEngineComplainsWhateverTheValue) {
    const Row row = rowAfter<Complaining>(1);
    EXPECT_EQ(row.verdict, Verdict::fails);
    EXPECT_EQ(row.note, "full");
}

TEST(Trial, TakesAGapThatIsNoNumberForTheLargest) {
    const EngineKind kind{"test", [](const Scene&) -> std::unique_ptr<Engine> { return std::make_unique<Lost>(); }};
    Trial trial({"family", "case", &kind, 1.0 / 60, {}});
    Scene scene;
    add(scene, solidBody(Sphere{1}, {}, 1, {}));
    add(scene, fixedBody(Sphere{1}, {}, {}));
    addBall(scene, 0, kWorld, {});
    addBall(scene, kWorld, kWorld, {});
    stability::Run run = trial.start(scene);
    run.advance(1);
    EXPECT_TRUE(std::isnan(run.jointGap()));
}

}  // namespace
}  // namespace ragtop::stability
