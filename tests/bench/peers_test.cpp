#include <gtest/gtest.h>

#include <algorithm>

#include "scenery.h"
#include "trial.h"

// The engines that Ragtop is compared with are what their names say.
namespace ragtop::stability {
namespace {

/// Null where this program was built without it.
const EngineKind* built(const std::string& name) {
    const auto kinds = engineKinds();
    const auto found = std::ranges::find(kinds, name, &EngineKind::name);
    return found != kinds.end() && found->make ? &*found : nullptr;
}

/// A hundred times its weight on a box: how far it sinks in a second, m.
double sinks(const EngineKind& kind) {
    Trial trial({"peers", "heavy on light", &kind, 1.0 / 60, {}});
    Scene scene;
    addFloor(scene, surface(0.5f));
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, surface(0.5f)));
    const int heavy = add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 1.5, 0}, 100, surface(0.5f)));
    stability::Run run = trial.start(scene);
    run.advance(1);
    return 1.5 - run.height(heavy);
}

TEST(Peers, BulletWithFiftyIterationsHoldsFiveTimesAsWell) {
    const EngineKind *ten = built("bullet"), *fifty = built("bullet-50");
    if (!ten || !fifty) GTEST_SKIP() << "built without Bullet";
    EXPECT_LT(5 * sinks(*fifty), sinks(*ten));
}

/// Five links that fall from the side: the widest that a joint is open, m.
double opens(const EngineKind& kind) {
    Trial trial({"peers", "five links", &kind, 1.0 / 60, {}});
    Scene scene;
    int before = kWorld;
    for (int i = 0; i < 5; ++i) {
        const double at = 0.4 * i;
        const int link = add(scene, solidBody(Box{{0.2f, 0.02f, 0.02f}}, {at + 0.2, 0, 0}, 1, surface(0)));
        scene.bodies[static_cast<std::size_t>(link)].def.shapes[0].filter.mask = 0;
        addBall(scene, before, link, {at, 0, 0});
        before = link;
    }
    stability::Run run = trial.start(scene);
    double most = 0;
    run.advance(1, [&] {
        most = std::max(most, run.jointGap());
        return true;
    });
    return most;
}

TEST(Peers, MujocosOwnTreesOfJointsNeverOpen) {
    const EngineKind *free = built("mujoco"), *trees = built("mujoco-trees");
    if (!free || !trees) GTEST_SKIP() << "built without MuJoCo";
    // Poses of bodies are read in single precision.
    EXPECT_LT(opens(*trees), 1e-6);
    EXPECT_GT(opens(*free), 1e-4);
}

TEST(Peers, MujocoIsHeardToPutAStateBack) {
    for (const char* name : {"mujoco", "mujoco-trees"}) {
        const EngineKind* kind = built(name);
        if (!kind) GTEST_SKIP() << "built without MuJoCo";
        Trial trial({"peers", "too fast", kind, 1.0 / 60, {}});
        Scene scene;
        const int ball = add(scene, solidBody(Sphere{1}, {}, 1, {}));
        stability::Run run = trial.start(scene);
        run.step();
        EXPECT_EQ(run.engine().complaint(), "");
        run.engine().setVelocity(ball, {1e12f, 0, 0}, {});
        run.step();
        EXPECT_NE(run.engine().complaint(), "") << name;
        trial.expectAtMost("nothing", 0, 1, "m");
        EXPECT_EQ(trial.rows().at(0).verdict, Verdict::fails) << name;
    }
}

}  // namespace
}  // namespace ragtop::stability
