#include "ragtop/recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "gltf_library.h"
#include "ragtop/surface_mesh.h"
#include "ragtop/world.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

tinygltf::Model written(const Recording& recording) {
    const std::string path = temporaryPath("recording.glb").string();
    recording.write(path);
    tinygltf::Model model;
    std::string errors, warnings;
    EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &errors, &warnings, path)) << errors;
    EXPECT_EQ(errors + warnings, "");
    return model;
}

/// The floats of an accessor.
std::vector<float> floats(const tinygltf::Model& model, int index) {
    const auto& accessor = model.accessors[static_cast<std::size_t>(index)];
    const auto& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    std::vector<float> values(accessor.count * (accessor.type == TINYGLTF_TYPE_VEC3 ? 3 : 1));
    std::memcpy(values.data(), model.buffers[0].data.data() + view.byteOffset + accessor.byteOffset,
                values.size() * sizeof(float));
    return values;
}

/// The animated values of one node, empty when it has no such channel.
std::vector<float> channel(const tinygltf::Model& model, const std::string& node, const std::string& path, bool times) {
    for (const auto& animation : model.animations) {
        for (const auto& c : animation.channels) {
            if (c.target_path != path || model.nodes[static_cast<std::size_t>(c.target_node)].name != node) continue;
            const auto& sampler = animation.samplers[static_cast<std::size_t>(c.sampler)];
            return floats(model, times ? sampler.input : sampler.output);
        }
    }
    return {};
}

TEST(Recording, ShowsFallAndLeavesTheGroundAlone) {
    World world;
    const BodyId ground = world.create(StaticBody{.shape = Box{{5, 1, 5}}, .position = {0, -1, 0}});
    const BodyId ball = world.create(DynamicBody{.shape = Sphere{0.5f}, .position = {0, 100, 0}});
    Recording recording{world};
    recording.name(ground, "ground");
    recording.name(ball, "ball");
    for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60);
        recording.capture();
    }
    EXPECT_EQ(recording.frames(), 31);
    const auto model = written(recording);
    EXPECT_EQ(model.meshes.size(), 2u);
    EXPECT_TRUE(channel(model, "ground", "translation", false).empty());
    const auto path = channel(model, "ball", "translation", false);
    ASSERT_EQ(path.size(), 31u * 3);
    EXPECT_NEAR(path[1], 100, 1e-4);
    // ½ g t², and the half step by which a first-order integrator may be ahead.
    EXPECT_NEAR(path.end()[-2], 100 - 0.5 * 9.81, 9.81 / 60);
    EXPECT_NEAR(channel(model, "ball", "translation", true).back(), 1, 1e-6);
}

TEST(Recording, BodiesThatComeAndGoHaveNoSizeBeforeAndAfter) {
    World world;
    const BodyId first = world.create(DynamicBody{.shape = Box{}});
    Recording recording{world, {.every = 1}};
    recording.name(first, "first");
    world.step(1.0 / 60);
    recording.capture();
    world.destroy(first);
    const BodyId second = world.create(DynamicBody{.shape = Capsule{}});
    world.step(1.0 / 60);
    recording.capture();
    recording.name(second, "second");
    const auto model = written(recording);
    EXPECT_EQ(channel(model, "first", "scale", false), (std::vector<float>{1, 1, 1, 0, 0, 0}));
    EXPECT_EQ(channel(model, "second", "scale", false), (std::vector<float>{0, 0, 0, 1, 1, 1}));
}

TEST(Recording, SharesMeshesAndStaysSmallForThousandsOfBodies) {
    World world({.gravity = {}});
    for (int i = 0; i < 2000; ++i)
        world.create(DynamicBody{.shape = Box{{0.2f, 0.1f, 0.1f}}, .position = {i * 1.0, 0, 0}});
    Recording recording{world};
    for (int i = 0; i < 10; ++i) {
        world.step(1.0 / 60);
        recording.capture();
    }
    const auto model = written(recording);
    EXPECT_LE(model.meshes.size(), 8u);
    EXPECT_TRUE(model.animations.empty());
}

TEST(Recording, RefusesAPlaceThatIsNoFile) {
    World world;
    EXPECT_THROW(Recording{world}.write("/no such folder/x.glb"), AssetError);
}

/// Six times the volume that triangles enclose: the sum of their triple products, positive when all face outwards.
double volumeOf(const std::vector<Vec3>& vertices, const std::vector<std::uint32_t>& indices) {
    double volume = 0;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        volume += dot(vertices[indices[i]], cross(vertices[indices[i + 1]], vertices[indices[i + 2]])) / 6.0;
    }
    return volume;
}

TEST(SurfaceMesh, EnclosesTheVolumeOfItsShape) {
    const auto volume = [](const Shape& shape) {
        const SurfaceMesh mesh = surfaceOf(shape);
        return volumeOf(mesh.vertices, mesh.indices);
    };
    EXPECT_NEAR(volume(Box{}), 8, 1e-5);
    // Sixteen sides lose a few per cent of a ball of volume 4π/3.
    EXPECT_NEAR(volume(Sphere{}), 4 * 3.14159 / 3, 0.3);
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1},         {1, 1, 0},
                                   {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0.5f, 0.5f, 0.5f}};
    EXPECT_NEAR(volumeOf(points, hullTriangles(points)), 1, 1e-5);
}

}  // namespace
}  // namespace ragtop
