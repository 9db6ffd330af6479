#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragtop/scene.h"
#include "ragtop/scene_tuning.h"
#include "ragtop/world.h"
#include "scene_play.h"

namespace ragtop {
namespace {

using testing::HasSubstr;

TEST(SceneCloths, HangFromTheRowThatIsHeld) {
    const Scene scene = sceneOfMembers(R"("cloths": [{"name": "flag", "position": [1, 3, 0],
        "sheet": {"columns": 5, "rows": 7, "across": [0.8, 0, 0], "down": [0, -1.2, 0]},
        "holds": [{"row": 0}], "density": 0.3}])");
    ScenePlay play(scene);
    const Cloth& flag = play.instance.cloths[0];
    ASSERT_EQ(flag.pointCount(), 35);
    EXPECT_EQ(flag.def().density, 0.3f);
    play.until(3);
    for (int column = 0; column < 5; ++column) {
        EXPECT_NEAR(flag.point(column).x, 1 + 0.2 * column, 1e-6);
        EXPECT_NEAR(flag.point(column).y, 3, 1e-6);
        // Its weight stretches it by ½ ρ g L²/K, 0.1 mm.
        EXPECT_NEAR(flag.point(30 + column).y, 1.8, 2e-3);
    }
}

TEST(SceneCloths, GoWithTheBodiesPartsAndCarsThatHoldThem) {
    const Scene scene = sceneOfMembers(R"("settings": {"gravity": [0, 0, 0]},
        "bodies": [{"name": "box", "shape": {"box": {}}, "position": [0, 0, 0], "linearVelocity": [2, 0, 0]}],
        "robots": [{"name": "dog", "position": [0, 5, 0], "file": ")" RAGTOP_SOURCE_DIR
                                       R"(/assets/data/robots/dog.xml"}],
        "cloths": [{"rope": {"points": 5, "along": [0, 0, 1]}, "position": [0.5, 0, 0], "holds": [{"to": "box", "points": [0]}]},
                   {"rope": {"points": 5, "along": [0, 0, 1]}, "position": [0, 5, 0], "holds": [{"to": "dog/trunk", "points": [4]}]}])");
    ScenePlay play(scene);
    play.until(1);
    const BodyId box = play.instance.bodies[0];
    const DVec3 at = transformPoint(play.world.pose(box), Vec3{0.5f, 0, 0});
    EXPECT_NEAR(play.instance.cloths[0].point(0).x, at.x, 1e-4);
    EXPECT_NEAR(play.instance.cloths[0].point(0).z, at.z, 1e-4);
    EXPECT_GT(at.x, 1);
    EXPECT_EQ(scene.cloths[1].holds[0].part.owner, ScenePart::Owner::robot);
}

TEST(SceneCloths, StrapsFollowTheirPathWithAllPointsAsNearAsTold) {
    const Scene scene = sceneOfMembers(R"("cloths": [{"strap": {"path": [[0, 0, 0], [1, 0, 0], [1, 1, 0]], "width": 0.1,
        "spacing": 0.1, "columns": 3, "facing": [0, 0, 1]}}])");
    const ClothDef& def = scene.cloths[0].def;
    ASSERT_EQ(def.points.size(), 21u * 3u);
    EXPECT_EQ(def.faces.size(), 20u * 2u);
    EXPECT_NEAR(length(def.points[1] - Vec3{0, 0, 0}), 0, 1e-6);
    EXPECT_NEAR(length(def.points[3 * 10 + 1] - Vec3{1, 0, 0}), 0, 1e-5);
    EXPECT_NEAR(length(def.points[3 * 20 + 1] - Vec3{1, 1, 0}), 0, 1e-5);
    EXPECT_NEAR(length(def.points[2] - def.points[0]), 0.1, 1e-6);
    // Faces look where they are told.
    const ClothFace& face = def.faces[0];
    const auto point = [&](int i) { return def.points[static_cast<std::size_t>(i)]; };
    EXPECT_GT(cross(point(face.b) - point(face.a), point(face.c) - point(face.a)).z, 0);
}

TEST(SceneCloths, MoveInTheWindThatIsTuned) {
    Scene scene =
        sceneOfMembers(R"("cloths": [{"name": "flag", "sheet": {"columns": 5, "rows": 5}, "position": [0, 3, 0],
        "holds": [{"row": 0}]}], "tuning": {"cloths.flag.wind": [0, 0, 6]})");
    EXPECT_EQ(scene.cloths[0].wind.z, 6);
    ScenePlay play(scene);
    play.until(2);
    EXPECT_GT(play.instance.cloths[0].point(22).z, 0.1);
    Scene still = scene;
    const std::vector<TunedValue> values{{"cloths.flag.wind", DVec3{}}};
    const TunedParts parts = tune(still, values);
    RunningScene running{&play.world, {}, {}, {}, {}, {}, {&play.instance.cloths[0]}};
    apply(still, parts, running);
    EXPECT_EQ(play.instance.cloths[0].wind(), (Vec3{}));
    EXPECT_TRUE(sameStructure(scene, still));
}

TEST(SceneCloths, GoOnAsBeforeFromASavedState) {
    const Scene scene = loadScene(findScene("cape"));
    ScenePlay play(scene), other(scene);
    play.until(0.5);
    std::vector<std::byte> state(play.world.saveSize());
    state.resize(play.world.save(state));
    play.until(1);
    other.world.restore(state);
    other.until(1);
    EXPECT_EQ(other.world.hash(), play.world.hash());
    EXPECT_EQ(other.instance.cloths[0].point(40).y, play.instance.cloths[0].point(40).y);
}

/// How far parts get from where they began in the car, m.
double farthestInCar(bool belted) {
    Scene scene = loadScene(findScene("dummy"));
    if (!belted) scene.cloths.clear();
    ScenePlay play(scene);
    const BodyId pelvis = play.instance.ragdolls[0].bodies()[0];
    const auto inCar = [&] {
        return inverseTransformPoint(play.world.pose(play.instance.vehicles[0].chassis()),
                                     play.world.pose(pelvis).position);
    };
    const Vec3 start = inCar();
    double farthest = 0;
    while (play.world.time() < 1.5) {
        play.until(play.world.time() + scene.step);
        farthest = std::max(farthest, static_cast<double>(length(inCar() - start)));
        for (const JointId joint : play.world.joints())
            EXPECT_LT(play.world.state(joint).gap, 2e-3f) << play.world.time();
    }
    return farthest;
}

/// The belts give way by 2 m · F/EA, with 75 kg at 12.7 g on four of their ends and EA = 50 kN 0.1 m, besides their
/// slack.
TEST(SceneCloths, BeltsKeepTheDummyOnItsSeat) {
    EXPECT_LT(farthestInCar(true), 0.4);
    EXPECT_GT(farthestInCar(false), 1);
}

TEST(SceneCloths, ACapeStaysOnTheShouldersAndAsLongAsItIs) {
    const Scene scene = loadScene(findScene("cape"));
    ScenePlay play(scene);
    const Cloth& cape = play.instance.cloths[0];
    const BodyId chest = play.instance.ragdolls[0].bodies()[2];
    const Vec3 held = inverseTransformPoint(play.world.pose(chest), cape.point(10));
    while (play.world.time() < 10) {
        play.until(play.world.time() + 0.1);
        EXPECT_LT(length(inverseTransformPoint(play.world.pose(chest), cape.point(10)) - held), 1e-3f);
        for (int i = 0; i < cape.pointCount(); ++i) {
            const DVec3 point = cape.point(i);
            ASSERT_GT(point.y, -0.02) << play.world.time();
            // The diagonal of it and a fiftieth.
            ASSERT_LT(length(relative(point, cape.point(10))), 1.02f * 1.24f) << play.world.time();
        }
    }
}

TEST(SceneCloths, TellWhatIsWrong) {
    const auto sheet = [](const std::string& members) {
        return R"("cloths": [{"sheet": {"columns": 4, "rows": 3})" + members + "}]";
    };
    EXPECT_THAT(faultOfMembers(R"("cloths": [{"name": "none"}])"),
                HasSubstr("/cloths/0 has 0 of \"sheet\", \"rope\" and \"strap\", must have exactly one"));
    EXPECT_THAT(faultOfMembers(sheet(R"(, "rope": {})")), HasSubstr("has 2 of"));
    EXPECT_THAT(faultOfMembers(sheet(R"(, "density": -1)")), HasSubstr("/cloths/0/density is -1, must be a number in"));
    EXPECT_THAT(faultOfMembers(sheet(R"(, "holds": [{"row": 3}])")),
                HasSubstr("/cloths/0/holds/0/row is 3, must be one of the 3 rows"));
    EXPECT_THAT(faultOfMembers(sheet(R"(, "holds": [{"points": [0, 12]}])")),
                HasSubstr("/cloths/0/holds/0/points/1 is 12, must be one of the 12 points"));
    EXPECT_THAT(faultOfMembers(sheet(R"(, "holds": [{"to": "nobody", "row": 0}])")),
                HasSubstr("/holds/0/to is \"nobody\""));
    EXPECT_THAT(faultOfMembers(sheet(R"(, "holds": [{"row": 0, "first": 3, "last": 1}])")),
                HasSubstr("behind its last one"));
    EXPECT_THAT(faultOfMembers(R"("cloths": [{"rope": {}, "holds": [{"row": 0}]}])"), HasSubstr("a rope has no rows"));
    EXPECT_THAT(faultOfMembers(R"("cloths": [{"strap": {"path": [[0, 0, 0]]}}])"),
                HasSubstr("/cloths/0/strap/path has 1 points, must have 2 or more"));
    EXPECT_THAT(faultOfMembers(R"("cloths": [{"strap": {"path": [[0, 0, 0], [0, 0, 0]]}}])"),
                HasSubstr("/path/1 is the point before it"));
}

TEST(SceneRagdolls, BeginInThePoseOfTheirFile) {
    const std::string body = R"("file": ")" RAGTOP_SOURCE_DIR R"(/assets/data/ragdolls/mannequin.ragdoll.json")";
    const Scene scene = sceneOfMembers(R"("ragdolls": [{)" + body +
                                       R"(, "pose": [{"role": "upperArm", "side": "left", "flexion": 1.5708}]}])");
    const ScenePlay play(scene);
    const Ragdoll& person = play.instance.ragdolls[0];
    const DVec3 chest = play.world.pose(person.bodies()[2]).position;
    const DVec3 raised = play.world.pose(person.bodies()[5]).position,
                hanging = play.world.pose(person.bodies()[10]).position;
    EXPECT_GT(raised.z, chest.z + 0.35);  // the forearm stretched forwards
    EXPECT_LT(hanging.y, chest.y - 0.2);
    EXPECT_THAT(faultOfMembers(R"("ragdolls": [{)" + body + R"(, "pose": [{"role": "tail"}]}])"),
                HasSubstr("must have the role and side of a part of the ragdoll"));
}

}  // namespace
}  // namespace ragtop
