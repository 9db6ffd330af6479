#include "gltf_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "gltf_library.h"
#include "ragtop/asset_error.h"
#include "surface_mesh.h"

namespace ragtop {
namespace {

/// What is stored side by side in the buffer; a view each.
enum View { vertices, indices, times, positions, turns, viewCount };

/// Linear values of an sRGB colour, as glTF wants them.
std::vector<double> linearColor(Color color) {
    const auto channel = [&](int shift) { return std::pow(((color >> shift) & 0xff) / 255.0, 2.2); };
    return {channel(16), channel(8), channel(0), 1.0};
}

/// Tints that tell neighbours apart.
Color defaultColor(const RecordedBody& body) {
    static constexpr Color kTints[] = {0xd98c4a, 0xc9793b, 0xe0a060, 0xb86a35, 0xd0925c};
    if (body.type == BodyType::fixed) return 0x8a9a86;
    if (body.type == BodyType::kinematic) return 0x5f86c0;
    return kTints[body.id.index % std::size(kTints)];
}

class GltfBuilder {
public:
    tinygltf::Model build(const RecordedScene& scene) {
        model_.asset.version = "2.0";
        model_.asset.generator = "ragtop";
        model_.scenes.resize(1);
        model_.defaultScene = 0;
        for (const RecordedBody& body : scene.bodies) addBody(scene, body);
        if (!animation_.channels.empty()) {
            animation_.name = "recording";
            model_.animations.push_back(std::move(animation_));
        }
        finishBuffer();
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

    static void setPose(tinygltf::Node& node, const Vec3& p, const Quat& q) {
        if (p != Vec3{}) node.translation = {p.x, p.y, p.z};
        if (q != Quat{}) node.rotation = {q.x, q.y, q.z, q.w};
    }
    static void setScale(tinygltf::Node& node, const Vec3& s) {
        if (s != Vec3{1, 1, 1}) node.scale = {s.x, s.y, s.z};
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
        addChannel(node, "translation", "LINEAR", input, addVectors(positions, places));
        const int output = addAccessor(turns, TINYGLTF_COMPONENT_TYPE_SHORT, TINYGLTF_TYPE_VEC4, body.keys.size(),
                                       rotations.data(), rotations.size() * sizeof(std::int16_t));
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
        addChannel(node, "scale", "STEP", input, addVectors(positions, sizes));
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
        const int accessor = addAccessor(times, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, seconds.size(),
                                         seconds.data(), seconds.size() * sizeof(float));
        model_.accessors[static_cast<std::size_t>(accessor)].minValues = {seconds.front()};
        model_.accessors[static_cast<std::size_t>(accessor)].maxValues = {seconds.back()};
        return accessor;
    }

    int addVectors(View view, const std::vector<Vec3>& values) {
        const int accessor = addAccessor(view, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, values.size(),
                                         values.data(), values.size() * sizeof(Vec3));
        if (view == vertices) {
            Vec3 lower = values.front(), upper = values.front();
            for (const Vec3& v : values) lower = min(lower, v), upper = max(upper, v);
            model_.accessors[static_cast<std::size_t>(accessor)].minValues = {lower.x, lower.y, lower.z};
            model_.accessors[static_cast<std::size_t>(accessor)].maxValues = {upper.x, upper.y, upper.z};
        }
        return accessor;
    }

    int addAccessor(View view, int component, int type, std::size_t count, const void* data, std::size_t bytes) {
        tinygltf::Accessor accessor;
        accessor.bufferView = view;
        accessor.byteOffset = data_[view].size();
        accessor.componentType = component;
        accessor.type = type;
        accessor.count = count;
        const auto* begin = static_cast<const unsigned char*>(data);
        data_[view].insert(data_[view].end(), begin, begin + bytes);
        model_.accessors.push_back(std::move(accessor));
        return static_cast<int>(model_.accessors.size()) - 1;
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
            primitive.attributes["POSITION"] = addVectors(vertices, mesh.vertices);
            if (!mesh.normals.empty()) primitive.attributes["NORMAL"] = addVectors(vertices, mesh.normals);
            primitive.indices = addAccessor(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                                            mesh.indices.size(), mesh.indices.data(),
                                            mesh.indices.size() * sizeof(std::uint32_t));
            found->second = std::move(primitive);
        }
        return found->second;
    }

    /// Joins the views into one buffer; views that stayed empty are dropped and the others renumbered.
    void finishBuffer() {
        tinygltf::Buffer buffer;
        int numbers[viewCount] = {};
        for (std::size_t i = 0; i < viewCount; ++i) {
            if (data_[i].empty()) continue;
            tinygltf::BufferView view;
            view.buffer = 0;
            view.byteOffset = buffer.data.size();
            view.byteLength = data_[i].size();
            numbers[i] = static_cast<int>(model_.bufferViews.size());
            if (i == vertices) view.byteStride = sizeof(Vec3);
            model_.bufferViews.push_back(std::move(view));
            buffer.data.insert(buffer.data.end(), data_[i].begin(), data_[i].end());
        }
        for (tinygltf::Accessor& accessor : model_.accessors) accessor.bufferView = numbers[accessor.bufferView];
        if (!buffer.data.empty()) model_.buffers.push_back(std::move(buffer));
    }

    tinygltf::Model model_;
    tinygltf::Animation animation_;
    std::vector<unsigned char> data_[viewCount];
    std::map<Color, int> materials_;
    std::map<std::pair<std::string, Color>, int> meshes_;
    std::map<std::string, tinygltf::Primitive> geometries_;
};

}  // namespace

void writeGltf(const RecordedScene& scene, const std::filesystem::path& path) {
    const tinygltf::Model model = GltfBuilder().build(scene);
    std::ofstream out(path, std::ios::binary);
    const bool written = out && tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true);
    if (!written || !out.flush()) throw AssetError(path.string() + ": cannot be written");
}

}  // namespace ragtop
