#include "ragtop/visual.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>

#include "assimp_scene.h"
#include "import_support.h"
#include "ragtop/scene.h"
#include "ragtop/vehicle_file.h"

namespace ragtop {
namespace {

std::string textOf(const std::vector<std::byte>& bytes) {
    std::string text(bytes.size(), '\0');
    std::memcpy(text.data(), bytes.data(), bytes.size());
    return text;
}

/// The cooked file as another importer reads it.
ImportedScene readBack(const Visual& visual) {
    const TemporaryFile file("cooked.glb", textOf(visual.glb));
    return importScene(file.path(), ImportedDetail::looks);
}

int nodeNamed(const ImportedScene& scene, const std::string& name) {
    int found = -1, count = 0;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].name == name) found = static_cast<int>(i), ++count;
    }
    EXPECT_EQ(count, 1) << name;
    return found;
}

/// Where the skin puts its vertices when the nodes stand as they do.
std::vector<Vec3> skinned(const ImportedScene& scene, const std::vector<Affine>& globals) {
    std::vector<Vec3> points;
    for (const ImportedMesh& mesh : scene.meshes) {
        std::vector<Vec3> moved(mesh.vertices.size());
        for (const ImportedBone& bone : mesh.bones) {
            const int node = nodeNamed(scene, bone.name);
            if (node < 0) continue;
            const Affine map = globals[static_cast<std::size_t>(node)] * bone.offset;
            for (const ImportedWeight& w : bone.weights)
                moved[w.vertex] += w.weight * transformPoint(map, mesh.vertices[w.vertex]);
        }
        points.insert(points.end(), moved.begin(), moved.end());
    }
    return points;
}

using Cell = std::array<long, 3>;
/// The distinct points, to the tolerance.
std::map<Cell, int> cellsOf(const std::vector<Vec3>& points, float size) {
    std::map<Cell, int> cells;
    for (const Vec3& p : points) ++cells[{std::lround(p.x / size), std::lround(p.y / size), std::lround(p.z / size)}];
    return cells;
}

/// Every point of one has a point of the other near.
int strays(const std::vector<Vec3>& points, const std::vector<Vec3>& among, float size) {
    const auto cells = cellsOf(among, size);
    int count = 0;
    for (const auto& [cell, ignored] : cellsOf(points, size)) {
        bool near = false;
        for (long x = -1; x <= 1; ++x)
            for (long y = -1; y <= 1; ++y)
                for (long z = -1; z <= 1; ++z) near = near || cells.count({cell[0] + x, cell[1] + y, cell[2] + z});
        count += !near;
    }
    return count;
}

struct Cooked {
    Character character;
    RagdollDef ragdoll;
    Visual visual;
    ImportedScene scene;
    std::vector<Affine> globals;
};

Cooked cook(const std::filesystem::path& file) {
    Cooked cooked{loadCharacter(file), {}, {}, {}, {}};
    cooked.ragdoll = makeRagdoll(cooked.character);
    cooked.visual = cookSkin(file, cooked.ragdoll);
    cooked.scene = readBack(cooked.visual);
    cooked.globals = globalTransforms(cooked.scene);
    return cooked;
}

/// At rest the cooked skin is where the physics was fitted to: every vertex of the one is one of the other.
void expectSameRestPose(const Cooked& cooked) {
    std::vector<Vec3> fitted;
    for (const auto& ofBone : cooked.character.skeleton.skin) fitted.insert(fitted.end(), ofBone.begin(), ofBone.end());
    // Chains of float transforms through the file's units: 1e-4 of the height is far below any feature of a body.
    const float tolerance = 1e-4f * cooked.character.height;
    EXPECT_EQ(strays(fitted, skinned(cooked.scene, cooked.globals), tolerance), 0);
}

TEST(CookSkin, StandsAtRestWhereTheRagdollWasFitted) {
    RAGTOP_MODEL(file, "X/BCN_Epileptic.X");
    const Cooked cooked = cook(file);
    expectSameRestPose(cooked);
    int triangles = 0;
    for (const ImportedMesh& mesh : cooked.scene.meshes) triangles += static_cast<int>(mesh.triangles.size() / 3);
    EXPECT_EQ(triangles, cooked.character.skin.triangles);
}

TEST(CookSkin, CentimetresUnnamedJointsAndControlBonesStandAtRestToo) {
    for (const char* name : {"arnaud.fbx", "cesium_man.gltf", "knight.glb"}) {
        RAGTOP_SAMPLE(file, (std::string("characters/") + name));
        SCOPED_TRACE(name);
        expectSameRestPose(cook(file));
    }
}

TEST(CookSkin, NodesArePartsByTheNamesOfTheirBones) {
    RAGTOP_MODEL(file, "X/BCN_Epileptic.X");
    const Cooked cooked = cook(file);
    ASSERT_EQ(cooked.visual.nodes.size(), cooked.ragdoll.parts.size());
    for (const VisualNode& node : cooked.visual.nodes) {
        const RagdollPart& part = cooked.ragdoll.parts[static_cast<std::size_t>(node.index)];
        EXPECT_EQ(node.name, cooked.ragdoll.bones[static_cast<std::size_t>(part.bone)].name);
        const int found = nodeNamed(cooked.scene, node.name);
        ASSERT_GE(found, 0);
        const Affine& at = cooked.globals[static_cast<std::size_t>(found)];
        EXPECT_LT(length(at.shift - part.bind.position), 1e-5f) << node.name;
        EXPECT_LT(length(at.linear.cy - rotate(part.bind.rotation, {0, 1, 0})), 1e-5f) << node.name;
    }
}

TEST(CookSkin, EveryBoneFollowsTheRagdollAsItsPoseSays) {
    RAGTOP_MODEL(file, "X/BCN_Epileptic.X");
    Cooked cooked = cook(file);
    // Some pose of the parts; bones must then be where Ragdoll::pose says, body pose times inPart.
    std::vector<Frame> posed;
    for (std::size_t i = 0; i < cooked.ragdoll.parts.size(); ++i) {
        const float angle = 0.3f * static_cast<float>(i + 1);
        posed.push_back({{0.1f * static_cast<float>(i), angle, -1}, normalized(Quat{angle, 0.2f, -angle, 1})});
    }
    for (const VisualNode& node : cooked.visual.nodes) {
        const Frame& pose = posed[static_cast<std::size_t>(node.index)];
        Affine& local = cooked.scene.nodes[static_cast<std::size_t>(nodeNamed(cooked.scene, node.name))].local;
        local.linear = {rotate(pose.rotation, {1, 0, 0}), rotate(pose.rotation, {0, 1, 0}),
                        rotate(pose.rotation, {0, 0, 1})};
        local.shift = pose.position;
    }
    const std::vector<Affine> globals = globalTransforms(cooked.scene);
    for (const RagdollBone& bone : cooked.ragdoll.bones) {
        const Frame expected = posed[static_cast<std::size_t>(bone.part)] * bone.inPart;
        const Affine& at = globals[static_cast<std::size_t>(nodeNamed(cooked.scene, bone.name))];
        EXPECT_LT(length(at.shift - expected.position), 1e-4f) << bone.name;
        EXPECT_LT(length(at.linear.cx - rotate(expected.rotation, {1, 0, 0})), 1e-4f) << bone.name;
    }
}

TEST(CookSkin, WeightsSumToOneOverAtMostFourJoints) {
    RAGTOP_SAMPLE(file, "characters/cesium_man.gltf");
    const Cooked cooked = cook(file);
    for (const ImportedMesh& mesh : cooked.scene.meshes) {
        std::vector<float> sum(mesh.vertices.size(), 0);
        std::vector<int> count(mesh.vertices.size(), 0);
        for (const ImportedBone& bone : mesh.bones)
            for (const ImportedWeight& w : bone.weights) sum[w.vertex] += w.weight, count[w.vertex] += w.weight > 0;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            EXPECT_NEAR(sum[i], 1, 1e-5f);
            EXPECT_LE(count[i], 4);
        }
    }
}

TEST(CookSkin, EmbedsTexturesAndColours) {
    RAGTOP_SAMPLE(file, "characters/cesium_man.gltf");
    const Cooked cooked = cook(file);
    ASSERT_EQ(cooked.scene.images.size(), 1u);
    EXPECT_EQ(cooked.scene.images[0].file, importScene(file, ImportedDetail::looks).images.at(0).file);
    EXPECT_EQ(textOf(cooked.visual.glb).find("\"uri\""), std::string::npos);
}

TEST(CookSkin, RefusesWhatDoesNotFitTogether) {
    RAGTOP_MODEL(file, "X/BCN_Epileptic.X");
    RAGTOP_MODEL(other, "X/Testwuson.X");
    const RagdollDef ragdoll = makeRagdoll(loadCharacter(file));
    EXPECT_NE(importError(other, [&] { cookSkin(other, ragdoll); }).find("no bone of the ragdoll"), std::string::npos);
    EXPECT_NE(importError("absent.glb", [&] { cookSkin("absent.glb", ragdoll); }).find("no such file"),
              std::string::npos);
    EXPECT_NE(importError(file, [&] { cookSkin(file, RagdollDef{}); }).find("not usable"), std::string::npos);
    const TemporaryFile garbage("garbage.glb", "glTF and then nothing that makes sense");
    EXPECT_NE(importError(garbage.path(), [&] { cookSkin(garbage.path(), ragdoll); }), "");
    RAGTOP_MODEL(motion, "BVH/01_01.bvh");
    const RagdollDef moving = makeRagdoll(loadCharacter(motion, {.metersPerUnit = 0.0564f}));
    EXPECT_NE(importError(motion, [&] { cookSkin(motion, moving); }).find("no mesh to look at"), std::string::npos);
}

VehicleDef hatchback() {
    return loadVehicle(std::filesystem::path(RAGTOP_SOURCE_DIR) / "assets/data/vehicles/hatchback.car.json");
}

Bounds boundsBelow(const ImportedScene& scene, const std::string& name) {
    const std::vector<Affine> globals = globalTransforms(scene);
    const int top = nodeNamed(scene, name);
    Bounds bounds{{1e9f, 1e9f, 1e9f}, {-1e9f, -1e9f, -1e9f}};
    for (const ImportedMesh& mesh : scene.meshes)
        for (const std::int32_t node : mesh.nodes) {
            int at = node;
            while (at >= 0 && at != top) at = scene.nodes[static_cast<std::size_t>(at)].parent;
            if (at != top) continue;
            for (const Vec3& vertex : mesh.vertices) {
                const Vec3 p = transformPoint(globals[static_cast<std::size_t>(node)], vertex);
                bounds = {min(bounds.lower, p), max(bounds.upper, p)};
            }
        }
    return bounds;
}

TEST(CookCar, ShippedCarLooksAsLargeAsItIs) {
    const VehicleDef def = hatchback();
    const Visual visual = cookCar(def);
    EXPECT_TRUE(visual.warnings.empty());
    ASSERT_EQ(visual.nodes.size(), 1 + def.wheels.size());
    EXPECT_EQ(visual.nodes[0].index, -1);
    const ImportedScene scene = readBack(visual);
    // The body that is seen and the one that collides differ by bumpers and mirrors.
    const Bounds body = boundsBelow(scene, visual.nodes[0].name);
    for (const ChassisShape& shape : def.chassis.shapes) {
        const Vec3 half = std::get<Box>(shape.shape).halfExtents;
        EXPECT_GT(shape.frame.position.z - half.z, body.lower.z - 0.1f);
        EXPECT_LT(shape.frame.position.z + half.z, body.upper.z + 0.1f);
        EXPECT_LT(shape.frame.position.y + half.y, body.upper.y + 0.1f);
    }
    EXPECT_LT(body.upper.z - body.lower.z, 4.0f);
    for (std::size_t i = 1; i < visual.nodes.size(); ++i) {
        const WheelDef& wheel = def.wheels[static_cast<std::size_t>(visual.nodes[i].index)];
        const Vec3 half{0.5f * wheel.width, wheel.radius, wheel.radius};
        const Bounds seen = boundsBelow(scene, visual.nodes[i].name);
        EXPECT_LT(length(seen.lower - (wheel.position - half)), 1e-4f) << wheel.name;
        EXPECT_LT(length(seen.upper - (wheel.position + half)), 1e-4f) << wheel.name;
    }
}

/// The truck of the samples: one file with its wheels as nodes.
VehicleDef truck(const std::filesystem::path& file) {
    VehicleDef def = hatchback();
    def.visual = VehicleVisualDef{.chassis = file.string()};
    for (const ImportedNode& node : importScene(file, ImportedDetail::surface).nodes)
        if (node.name.find("wheel") == 0) def.visual->wheelNodes.push_back(node.name);
    return def;
}

TEST(CookCar, WheelsMayBeNodesOfTheModel) {
    RAGTOP_SAMPLE(file, "vehicles/truck_red.glb");
    const VehicleDef def = truck(file);
    ASSERT_EQ(def.visual->wheelNodes.size(), 4u);
    const Visual visual = cookCar(def);
    EXPECT_EQ(visual.nodes.size(), 5u);
    // Its texture is absent.
    ASSERT_FALSE(visual.warnings.empty());
    EXPECT_NE(visual.warnings[0].find("left out"), std::string::npos);
    const ImportedScene scene = readBack(visual);
    const WheelDef& wheel = def.wheels[2];
    const Bounds seen = boundsBelow(scene, "wheel2");
    EXPECT_NEAR(seen.upper.y - seen.lower.y, 2 * wheel.radius, 1e-4f);
    EXPECT_LT(length(0.5f * (seen.lower + seen.upper) - wheel.position), 1e-4f);
}

TEST(CookCar, FrameAndScalePutTheModelIntoTheChassis) {
    const TemporaryFile file("box.obj",
                             "v 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\n"
                             "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    VehicleDef def = hatchback();
    const float root = std::sqrt(0.5f);
    def.visual = VehicleVisualDef{.chassis = file.path().string(),
                                  .frame = {{1, 2, 3}, {0, root, 0, root}},  // x to −z, z to x
                                  .scale = 0.5f};
    const Bounds seen = boundsBelow(readBack(cookCar(def)), "chassis");
    EXPECT_LT(length(seen.lower - Vec3{1, 2, 2}), 1e-5f);
    EXPECT_LT(length(seen.upper - Vec3{4, 4, 3}), 1e-5f);
}

TEST(CookCar, SaysWhatIsMissing) {
    VehicleDef def = hatchback();
    def.visual->wheelNodes = {"a", "b", "c", "d"};
    EXPECT_THROW(cookCar(def), std::invalid_argument);
    def.visual->wheel.clear();
    EXPECT_NE(importError(def.visual->chassis, [&] { cookCar(def); }).find("no node 'a'"), std::string::npos);
    def.visual->wheelNodes.pop_back();
    EXPECT_NE(whyInvalid(def).find("/visual/wheelNodes has 3 names"), std::string::npos);
    def.visual = VehicleVisualDef{};
    EXPECT_NE(whyInvalid(def).find("/visual/chassis is empty"), std::string::npos);
    def.visual->chassis = "absent.glb";
    EXPECT_NE(importError("absent.glb", [&] { cookCar(def); }).find("no such file"), std::string::npos);
    def.visual.reset();
    EXPECT_THROW(cookCar(def), std::invalid_argument);
}

TEST(CookCar, TexturesOutsideTheModelsFolderAreLeftOut) {
    const TemporaryFile secret("secret.png", std::string("\x89PNG\r\n\x1a\n") + "not for everyone");
    const auto folder = temporaryPath("model");
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "box.mtl") << "newmtl m\nmap_Kd ../" << secret.path().filename().string() << "\n";
    std::ofstream(folder / "box.obj") << "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
    VehicleDef def = hatchback();
    def.visual = VehicleVisualDef{.chassis = (folder / "box.obj").string()};
    const Visual visual = cookCar(def);
    std::filesystem::remove_all(folder);
    EXPECT_EQ(textOf(visual.glb).find("not for everyone"), std::string::npos);
    ASSERT_EQ(visual.warnings.size(), 1u);
    EXPECT_NE(visual.warnings[0].find("not in the folder of the model"), std::string::npos);
}

TEST(LoadVehicle, VisualModelsAreFoundBesideTheFile) {
    const VehicleDef def = hatchback();
    ASSERT_TRUE(def.visual.has_value());
    EXPECT_TRUE(std::filesystem::path(def.visual->chassis).is_absolute());
    EXPECT_TRUE(std::filesystem::exists(def.visual->chassis));
    EXPECT_TRUE(std::filesystem::exists(def.visual->wheel));
    const auto copy = temporaryPath("copy.car.json");
    saveVehicle(def, copy);
    EXPECT_EQ(loadVehicle(copy).visual->wheel, def.visual->wheel);
    std::filesystem::remove(copy);
}

TEST(LoadScene, RagdollsNameTheCharacterTheyWereMadeFrom) {
    RAGTOP_MODEL(file, "X/BCN_Epileptic.X");
    const Scene scene = loadScene(findScene("crash"));
    ASSERT_EQ(scene.ragdolls.size(), 1u);
    EXPECT_EQ(scene.ragdolls[0].character, file);
    EXPECT_EQ(cookSkin(file, *scene.ragdolls[0].def).nodes.size(), scene.ragdolls[0].def->parts.size());
}

}  // namespace
}  // namespace ragtop
