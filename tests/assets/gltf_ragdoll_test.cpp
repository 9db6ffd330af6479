#include <array>
#include <iterator>

#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/gltf_ragdoll.h"
#include "ragtop/ragdoll_file.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

/// A ragdoll as the text of its file, which has each of its numbers.
std::string textOf(const RagdollDef& def) {
    const fs::path path = temporaryPath("text.ragdoll.json");
    saveRagdoll(def, path);
    std::ifstream stream(path);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    fs::remove(path);
    return text;
}

void expectEqualAfterGltf(const RagdollDef& def) {
    for (const char* name : {"round_trip.gltf", "round_trip.glb"}) {
        const TemporaryFile file(name, "");
        saveGltfRagdoll(def, file.path());
        EXPECT_TRUE(hasGltfRagdoll(file.path()));
        EXPECT_EQ(textOf(loadGltfRagdoll(file.path()).ragdoll), textOf(def)) << name;
    }
}

RagdollDef chainOf(std::vector<JointDef> joints) {
    RagdollDef def;
    const std::array<Vec3, 5> corners{Vec3{}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}, {0.1f, 0.1f, 0.1f}};
    const std::array<Shape, 4> shapes{Sphere{0.1f}, Capsule{0.05f, 0.1f}, Box{{0.1f, 0.2f, 0.3f}}, ConvexHull(corners)};
    for (int i = 0; i <= static_cast<int>(joints.size()); ++i) {
        const std::string name = "part " + std::to_string(i);
        RagdollPart part{.name = name, .bone = i, .shape = shapes[static_cast<std::size_t>(i) % shapes.size()]};
        part.bind = {{0.3f * static_cast<float>(i), 1, 0}, rotationAbout({1, 2, 3}, 0.1f * static_cast<float>(i))};
        part.frame.position = {0, 0.01f * static_cast<float>(i), 0};
        part.mass = 1.1f + static_cast<float>(i);
        part.material.friction = 0.1f * static_cast<float>(i);
        part.material.slidingShare = 0.7f;
        def.parts.push_back(part);
        def.bones.push_back({"bone of " + name, i - 1, i, {}});
    }
    def.bones.push_back({"tip", static_cast<int>(joints.size()), 0, {{0, 0.25f, 0}, {}}});
    for (int i = 0; JointDef & joint : joints) {
        std::visit(
            [&](auto& kind) {
                kind.bodies.frameA = {{0.15f, 0, 0}, rotationAbout({0, 1, 0}, 0.3f)};
                kind.bodies.frameB = {{-0.15f, 0, 0}, rotationAbout({0, 0, 1}, 0.2f)};
                kind.bodies.collide = i % 2 == 0;
                kind.bodies.breakForce = i % 4 == 0 ? 1500.0f : kNoForceLimit;
            },
            joint);
        def.joints.push_back({i, i + 1, joint});
        ++i;
    }
    def.note = "a chain";
    for (int i = 2; i < static_cast<int>(def.parts.size()); i += 3) def.ignored.push_back({i - 2, i});
    return def;
}

TEST(GltfRagdoll, OfAnyJointIsReadBackEqual) {
    const Spring spring{.stiffness = 40, .damping = 3, .maxForce = 100};
    const AxisDef axis{.limit = Range{-0.3f, 0.4f}, .spring = spring, .target = 0.1f, .friction = 2};
    const Range range{-0.5f, 0.7f};
    expectEqualAfterGltf(chainOf({
        BallDef{.swingLimit = 0.9f, .twistLimit = range, .friction = 0.4f},
        BallDef{.swingEllipse = SwingEllipse{0.4f, 0.8f}, .stop = {.stiffness = 50, .damping = 2}, .spring = spring},
        BallDef{.swingPyramid = SwingPyramid{{-0.2f, 0.3f}, {-0.4f, 0.5f}}, .twistLimit = range},
        HingeDef{.limit = range, .stop = {.restitution = 0.2f}, .motor = Motor{1, 20}, .friction = 0.1f},
        HingeDef{.spring = Spring{.frequency = 3, .dampingRatio = 0.7f}, .target = 0.3f},
        SliderDef{.limit = range, .bearing = Bearing{.viscous = 2}},
        FixedDef{},
        DistanceDef{.limit = Range{0, 0.5f}},
        CylindricalDef{.turn = axis, .travel = axis},
        UniversalDef{.first = axis, .second = axis},
        PlaneDef{.y = axis, .turn = axis},
        ScrewDef{.pitch = 0.02f, .turn = axis},
        SixDofDef{.x = axis, .twist = axis, .swingZ = axis},
    }));
}

TEST(GltfRagdoll, OfABodyThatPassesThroughItselfIsReadBackEqual) {
    RagdollDef def = chainOf({FixedDef{}, FixedDef{}, FixedDef{}});
    def.ignored.clear();
    def.selfCollision = false;
    expectEqualAfterGltf(def);
}

TEST(GltfRagdoll, OfAFittedHumanIsReadBackEqual) {
    const fs::path rig = fs::path(RAGTOP_SOURCE_DIR) / "tests" / "data" / "rigs" / "human.gltf";
    expectEqualAfterGltf(makeRagdoll(loadCharacter(rig)));
    expectEqualAfterGltf(loadRagdoll(fs::path(RAGTOP_SOURCE_DIR) / "assets/data/ragdolls/mannequin.ragdoll.json"));
}

/// Two boxes, the second hinged to the first about its z axis from its own side, as other programs write it.
constexpr const char* kDoor = R"({
 "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}],
 "nodes": [
  {"name": "frame", "children": [1], "extensions": {"KHR_physics_rigid_bodies": {
   "motion": {"mass": 20}, "collider": {"geometry": {"shape": 0}}}}},
  {"name": "hinge of the frame", "translation": [0.5, 0, 0]},
  {"name": "door", "translation": [1, 0, 0], "children": [3], "extensions": {"KHR_physics_rigid_bodies": {
   "motion": {"mass": 5}, "collider": {"geometry": {"shape": 0}}}}},
  {"name": "hinge of the door", "translation": [-0.5, 0, 0], "extensions": {"KHR_physics_rigid_bodies": {
   "joint": {"connectedNode": 1, "joint": 0}}}}],
 "extensions": {"KHR_implicit_shapes": {"shapes": [{"type": "box", "box": {"size": [0.8, 2, 0.1]}}]},
  "KHR_physics_rigid_bodies": {"physicsJoints": [{"limits": [
   {"linearAxes": [0, 1, 2], "min": 0, "max": 0}, {"angularAxes": [0, 1], "min": 0, "max": 0},
   {"angularAxes": [2], "min": -0.2, "max": 1.5}], "drives": [
   {"type": "angular", "mode": "force", "axis": 2, "stiffness": 30, "damping": 4, "positionTarget": 0.5}]}]}}})";

TEST(GltfRagdoll, SeenFromTheOtherBodyTurnsTheOtherWay) {
    const TemporaryFile file("door.gltf", kDoor);
    const RagdollDef def = loadGltfRagdoll(file.path()).ragdoll;
    ASSERT_EQ(def.parts.size(), 2u);
    EXPECT_EQ(std::get<Box>(def.parts[1].shape).halfExtents, (Vec3{0.4f, 1, 0.05f}));
    ASSERT_EQ(def.joints.size(), 1u);
    const auto& hinge = std::get<HingeDef>(def.joints[0].joint);
    EXPECT_FLOAT_EQ(hinge.limit->lower, -1.5f);
    EXPECT_FLOAT_EQ(hinge.limit->upper, 0.2f);
    EXPECT_FLOAT_EQ(hinge.target, -0.5f);
    EXPECT_FLOAT_EQ(hinge.spring->stiffness, 30);
    const Vec3 axis = rotate(hinge.bodies.frameA.rotation, {1, 0, 0});
    EXPECT_NEAR(axis.z, 1, 1e-6f);
    EXPECT_EQ(hinge.bodies.frameA.position, (Vec3{0.5f, 0, 0}));
    EXPECT_EQ(hinge.bodies.frameB.position, (Vec3{-0.5f, 0, 0}));
}

TEST(GltfRagdoll, NamesThePlaceOfWhatIsWrong) {
    const auto error = [](std::string from, const std::string& to) {
        std::string text = kDoor;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos);
        text.replace(at, from.size(), to);
        const TemporaryFile file("wrong.gltf", text);
        return importError(file.path(), [&] { loadGltfRagdoll(file.path()); });
    };
    using testing::HasSubstr;
    EXPECT_THAT(error("\"connectedNode\": 1", "\"connectedNode\": 9"), HasSubstr("is 9, must be one of 4 nodes"));
    EXPECT_THAT(error("\"joint\": 0", "\"joint\": 3"), HasSubstr("is 3, must be one of 1 joints"));
    EXPECT_THAT(error("\"shape\": 0", "\"shape\": 2"), HasSubstr("is 2, must be one of 1 shapes"));
    EXPECT_THAT(error("\"children\": [3]", "\"children\": [2]"), HasSubstr("lead back to node 2"));
    EXPECT_THAT(error("\"mass\": 20", "\"mass\": -1"), HasSubstr("/motion/mass is -1, must be"));
    EXPECT_THAT(error("\"type\": \"angular\"", "\"type\": \"round\""),
                HasSubstr("must be one of \"linear\", \"angular\""));
    EXPECT_THAT(error("\"linearAxes\": [0, 1, 2]", "\"linearAxes\": [0, 1, 3]"), HasSubstr("is 3, must be"));
}

}  // namespace
}  // namespace ragtop
