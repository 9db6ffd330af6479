#include "gltf_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "gltf_buffer.h"
#include "ragtop/asset_error.h"
#include "ragtop/surface_mesh.h"

namespace ragtop {
namespace {

/// Tints that tell neighbours apart.
Color defaultColor(const RecordedBody& body) {
    static constexpr Color kTints[] = {0xd98c4a, 0xc9793b, 0xe0a060, 0xb86a35, 0xd0925c};
    if (body.type == BodyType::fixed) return 0xb3b5ab;
    if (body.type == BodyType::kinematic) return 0x5f86c0;
    return kTints[body.id.index % std::size(kTints)];
}

class GltfBuilder {
public:
    tinygltf::Model build(const RecordedScene& scene) {
        for (const RecordedBody& body : scene.bodies) addBody(scene, body);
        if (!animation_.channels.empty()) {
            animation_.name = "recording";
            model_.animations.push_back(std::move(animation_));
        }
        buffer_.finish();
        return std::move(model_);
    }

private:
    void addBody(const RecordedScene& scene, const RecordedBody& body) {
        if (body.parts.empty()) return;
        tinygltf::Node node;
        node.name = body.name.empty() ? "body " + std::to_string(body.id.index) : body.name;
        setPose(node, body.keys.front().position, body.keys.front().rotation);
        const Color color = body.color.value_or(defaultColor(body));
        const bool whole = body.parts.size() == 1 && body.parts[0].frame == Frame{} && !comesOrGoes(scene, body);
        if (whole) {
            node.mesh = meshOf(body.parts[0].shape, color);
            setScale(node, surfaceScale(body.parts[0].shape));
        } else {
            for (const RecordedPart& part : body.parts) node.children.push_back(addPart(part, color));
        }
        const int index = static_cast<int>(model_.nodes.size());
        model_.nodes.push_back(std::move(node));
        model_.scenes[0].nodes.push_back(index);
        if (body.keys.size() > 1) animatePose(scene, body, index);
        if (comesOrGoes(scene, body)) animatePresence(scene, body, index);
    }

    static bool comesOrGoes(const RecordedScene& scene, const RecordedBody& body) {
        return body.firstFrame > 0 || body.goneFrame < static_cast<int>(scene.times.size());
    }

    int addPart(const RecordedPart& part, Color color) {
        tinygltf::Node node;
        node.mesh = meshOf(part.shape, color);
        setPose(node, part.frame.position, part.frame.rotation);
        setScale(node, surfaceScale(part.shape));
        model_.nodes.push_back(std::move(node));
        return static_cast<int>(model_.nodes.size()) - 1;
    }

    void animatePose(const RecordedScene& scene, const RecordedBody& body, int node) {
        std::vector<float> seconds;
        std::vector<Vec3> places;
        std::vector<std::int16_t> rotations;
        for (const RecordedKey& key : body.keys) {
            seconds.push_back(static_cast<float>(scene.times[static_cast<std::size_t>(key.frame)]));
            places.push_back(key.position);
            // Sixteen bits a component: 3e-5 rad, a third of the size of floats.
            for (const float c : {key.rotation.x, key.rotation.y, key.rotation.z, key.rotation.w}) {
                rotations.push_back(static_cast<std::int16_t>(std::lround(std::clamp(c, -1.0f, 1.0f) * 32767.0f)));
            }
        }
        const int input = addTimes(seconds);
        addChannel(node, "translation", "LINEAR", input, buffer_.add(GltfView::positions, places));
        const int output = buffer_.add(GltfView::turns, TINYGLTF_COMPONENT_TYPE_SHORT, TINYGLTF_TYPE_VEC4,
                                       body.keys.size(), rotations.data(), rotations.size() * sizeof(std::int16_t));
        model_.accessors[static_cast<std::size_t>(output)].normalized = true;
        addChannel(node, "rotation", "LINEAR", input, output);
    }

    /// A body that is not there has no size.
    void animatePresence(const RecordedScene& scene, const RecordedBody& body, int node) {
        std::vector<float> seconds{static_cast<float>(scene.times.front())};
        std::vector<Vec3> sizes{body.firstFrame > 0 ? Vec3{} : Vec3{1, 1, 1}};
        const auto add = [&](int frame, const Vec3& size) {
            seconds.push_back(static_cast<float>(scene.times[static_cast<std::size_t>(frame)]));
            sizes.push_back(size);
        };
        if (body.firstFrame > 0) add(body.firstFrame, {1, 1, 1});
        if (body.goneFrame < static_cast<int>(scene.times.size()) && body.goneFrame > body.firstFrame) {
            add(body.goneFrame, {});
        }
        const int input = addTimes(seconds);
        addChannel(node, "scale", "STEP", input, buffer_.add(GltfView::positions, sizes));
    }

    void addChannel(int node, const char* path, const char* interpolation, int input, int output) {
        tinygltf::AnimationSampler sampler;
        sampler.input = input;
        sampler.output = output;
        sampler.interpolation = interpolation;
        tinygltf::AnimationChannel channel;
        channel.sampler = static_cast<int>(animation_.samplers.size());
        channel.target_node = node;
        channel.target_path = path;
        animation_.samplers.push_back(std::move(sampler));
        animation_.channels.push_back(std::move(channel));
    }

    int addTimes(const std::vector<float>& seconds) {
        const int accessor = buffer_.add(GltfView::times, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR,
                                         seconds.size(), seconds.data(), seconds.size() * sizeof(float));
        model_.accessors[static_cast<std::size_t>(accessor)].minValues = {seconds.front()};
        model_.accessors[static_cast<std::size_t>(accessor)].maxValues = {seconds.back()};
        return accessor;
    }

    int materialOf(Color color) {
        const auto [found, isNew] = materials_.try_emplace(color, static_cast<int>(model_.materials.size()));
        if (isNew) {
            tinygltf::Material material;
            material.pbrMetallicRoughness.baseColorFactor = linearColor(color);
            material.pbrMetallicRoughness.metallicFactor = 0;
            material.pbrMetallicRoughness.roughnessFactor = 0.8;
            model_.materials.push_back(std::move(material));
        }
        return found->second;
    }

    int meshOf(const Shape& shape, Color color) {
        const auto [found, isNew] =
            meshes_.try_emplace({geometryKey(shape), color}, static_cast<int>(model_.meshes.size()));
        if (isNew) {
            tinygltf::Mesh mesh;
            mesh.primitives.push_back(geometryOf(shape));
            mesh.primitives[0].material = materialOf(color);
            model_.meshes.push_back(std::move(mesh));
        }
        return found->second;
    }

    /// Equal for shapes that look the same; shared data is its address.
    static std::string geometryKey(const Shape& shape) {
        std::string key = std::to_string(shape.index());
        if (const auto* s = std::get_if<Capsule>(&shape)) {
            key += " " + std::to_string(s->radius) + " " + std::to_string(s->halfHeight);
        }
        const void* data = nullptr;
        if (const auto* s = std::get_if<ConvexHull>(&shape)) data = &s->data();
        if (const auto* s = std::get_if<TriangleMesh>(&shape)) data = &s->data();
        if (const auto* s = std::get_if<HeightField>(&shape)) data = &s->data();
        return key + " " + std::to_string(reinterpret_cast<std::uintptr_t>(data));
    }

    tinygltf::Primitive geometryOf(const Shape& shape) {
        const auto [found, isNew] = geometries_.try_emplace(geometryKey(shape));
        if (isNew) {
            const SurfaceMesh mesh = surfaceOf(shape);
            tinygltf::Primitive primitive;
            primitive.mode = TINYGLTF_MODE_TRIANGLES;
            primitive.attributes["POSITION"] = buffer_.add(GltfView::vertices, mesh.vertices);
            if (!mesh.normals.empty()) primitive.attributes["NORMAL"] = buffer_.add(GltfView::vertices, mesh.normals);
            primitive.indices = buffer_.add(mesh.indices);
            found->second = std::move(primitive);
        }
        return found->second;
    }

    tinygltf::Model model_ = emptyModel();
    GltfBuffer buffer_{model_};
    tinygltf::Animation animation_;
    std::map<Color, int> materials_;
    std::map<std::pair<std::string, Color>, int> meshes_;
    std::map<std::string, tinygltf::Primitive> geometries_;
};

}  // namespace

void writeGltf(const RecordedScene& scene, const std::filesystem::path& path) {
    const tinygltf::Model model = GltfBuilder().build(scene);
    std::ofstream out(path, std::ios::binary);
    if (!writeBinary(model, out)) throw AssetError(path.string() + ": cannot be written");
}

}  // namespace ragtop
