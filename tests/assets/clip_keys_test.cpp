#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <vector>

#include "assimp_scene.h"
#include "gltf_library.h"
#include "import_support.h"
#include "ragtop/character.h"

// Clips beside the keys of their files, read by the libraries alone.
namespace ragtop {
namespace {

template <typename Value>
struct Keys {
    std::vector<float> times;
    std::vector<Value> values;
};

struct Mover {
    Keys<Vec3> places, scales;
    Keys<Quat> turns;
};

struct KeyedNode {
    std::string name{};
    int parent = -1;
    Affine local{};
    Vec3 place{}, scale{1, 1, 1};
    Quat turn{};
};

struct KeyedFile {
    std::vector<KeyedNode> nodes;
    std::vector<std::map<int, Mover>> clips;  ///< of each the nodes that it moves
};

Vec3 between(const Vec3& a, const Vec3& b, float share) { return a + share * (b - a); }

Quat between(const Quat& a, Quat b, float share) {
    float cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    if (cosine < 0) b = {-b.x, -b.y, -b.z, -b.w}, cosine = -cosine;
    const float angle = std::acos(std::min(cosine, 1.0f));
    const float p = angle < 1e-4f ? 1 - share : std::sin((1 - share) * angle) / std::sin(angle);
    const float q = angle < 1e-4f ? share : std::sin(share * angle) / std::sin(angle);
    return normalized(Quat{p * a.x + q * b.x, p * a.y + q * b.y, p * a.z + q * b.z, p * a.w + q * b.w});
}

template <typename Value>
Value at(const Keys<Value>& keys, float time, const Value& otherwise) {
    if (keys.times.empty()) return otherwise;
    const auto later = std::upper_bound(keys.times.begin(), keys.times.end(), time);
    if (later == keys.times.begin()) return keys.values.front();
    if (later == keys.times.end()) return keys.values.back();
    const auto i = static_cast<std::size_t>(later - keys.times.begin());
    const float share = (time - keys.times[i - 1]) / (keys.times[i] - keys.times[i - 1]);
    return between(keys.values[i - 1], keys.values[i], share);
}

Affine composed(const Vec3& place, const Quat& turn, const Vec3& scale) {
    const Mat3 m = toMat3(turn);
    return {{scale.x * m.cx, scale.y * m.cy, scale.z * m.cz}, place};
}

/// Where the nodes are; parents come in any order.
std::vector<Affine> globalsAt(const KeyedFile& file, const std::map<int, Mover>& clip, float time) {
    std::vector<Affine> globals;
    for (std::size_t i = 0; i < file.nodes.size(); ++i) {
        Affine global;
        for (int n = static_cast<int>(i); n >= 0; n = file.nodes[static_cast<std::size_t>(n)].parent) {
            const KeyedNode& node = file.nodes[static_cast<std::size_t>(n)];
            const auto mover = clip.find(n);
            global = (mover == clip.end() ? node.local
                                          : composed(at(mover->second.places, time, node.place),
                                                     at(mover->second.turns, time, node.turn),
                                                     at(mover->second.scales, time, node.scale))) *
                     global;
        }
        globals.push_back(global);
    }
    return globals;
}

/// The numbers of an accessor of floats.
std::vector<float> floatsOf(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const auto width =
        static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
    EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
    const unsigned char* from =
        model.buffers[static_cast<std::size_t>(view.buffer)].data.data() + view.byteOffset + accessor.byteOffset;
    std::vector<float> numbers(accessor.count * width);
    for (std::size_t i = 0; i < accessor.count; ++i)
        std::memcpy(&numbers[i * width], from + i * static_cast<std::size_t>(accessor.ByteStride(view)),
                    width * sizeof(float));
    return numbers;
}

Vec3 vectorOf(const float* v) { return {v[0], v[1], v[2]}; }
Quat turnOf(const float* q) { return normalized(Quat{q[0], q[1], q[2], q[3]}); }

KeyedFile readGltf(const std::filesystem::path& path) {
    tinygltf::TinyGLTF reader;
    reader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                             void*) { return true; },
                          nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const bool isRead = path.extension() == ".glb" ? reader.LoadBinaryFromFile(&model, &error, &warning, path.string())
                                                   : reader.LoadASCIIFromFile(&model, &error, &warning, path.string());
    EXPECT_TRUE(isRead) << error;
    KeyedFile file;
    file.nodes.resize(model.nodes.size());
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        const tinygltf::Node& from = model.nodes[i];
        KeyedNode& node = file.nodes[i];
        node.name = from.name.empty() ? "nodes[" + std::to_string(i) + "]" : from.name;
        const auto number = [](double x) { return static_cast<float>(x); };
        if (const auto& t = from.translation; t.size() == 3) node.place = {number(t[0]), number(t[1]), number(t[2])};
        if (const auto& s = from.scale; s.size() == 3) node.scale = {number(s[0]), number(s[1]), number(s[2])};
        if (const auto& q = from.rotation; q.size() == 4)
            node.turn = normalized(Quat{number(q[0]), number(q[1]), number(q[2]), number(q[3])});
        node.local = composed(node.place, node.turn, node.scale);
        if (const auto& m = from.matrix; m.size() == 16)
            node.local = {{{number(m[0]), number(m[1]), number(m[2])},
                           {number(m[4]), number(m[5]), number(m[6])},
                           {number(m[8]), number(m[9]), number(m[10])}},
                          {number(m[12]), number(m[13]), number(m[14])}};
        for (const int child : from.children) file.nodes[static_cast<std::size_t>(child)].parent = static_cast<int>(i);
    }
    for (const tinygltf::Animation& from : model.animations) {
        std::map<int, Mover>& clip = file.clips.emplace_back();
        for (const tinygltf::AnimationChannel& channel : from.channels) {
            const tinygltf::AnimationSampler& sampler = from.samplers[static_cast<std::size_t>(channel.sampler)];
            const std::vector<float> times = floatsOf(model, sampler.input), values = floatsOf(model, sampler.output);
            Mover& mover = clip[channel.target_node];
            for (std::size_t k = 0; k < times.size(); ++k) {
                if (channel.target_path == "rotation") {
                    mover.turns.times.push_back(times[k]);
                    mover.turns.values.push_back(turnOf(&values[4 * k]));
                } else if (Keys<Vec3>& keys = channel.target_path == "scale" ? mover.scales : mover.places;
                           channel.target_path != "weights") {
                    keys.times.push_back(times[k]);
                    keys.values.push_back(vectorOf(&values[3 * k]));
                }
            }
        }
    }
    return file;
}

KeyedFile readByAssimp(const std::filesystem::path& path) {
    Assimp::Importer importer;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
    const aiScene* scene = importer.ReadFile(path.string(), 0);
    KeyedFile file;
    if (!scene) return file;
    std::map<std::string, int> places;
    std::vector<std::pair<const aiNode*, int>> waiting{{scene->mRootNode, -1}};
    while (!waiting.empty()) {
        const auto [node, parent] = waiting.back();
        waiting.pop_back();
        const aiMatrix4x4& m = node->mTransformation;
        const int place = static_cast<int>(file.nodes.size());
        places.emplace(node->mName.C_Str(), place);
        file.nodes.push_back({node->mName.C_Str(),
                              parent,
                              {{{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}}, {m.a4, m.b4, m.c4}}});
        for (unsigned i = 0; i < node->mNumChildren; ++i) waiting.emplace_back(node->mChildren[i], place);
    }
    for (unsigned a = 0; a < scene->mNumAnimations; ++a) {
        const aiAnimation& from = *scene->mAnimations[a];
        const double rate = from.mTicksPerSecond > 0 ? from.mTicksPerSecond : 25;
        std::map<int, Mover>& clip = file.clips.emplace_back();
        for (unsigned c = 0; c < from.mNumChannels; ++c) {
            const aiNodeAnim& channel = *from.mChannels[c];
            Mover& mover = clip[places.at(channel.mNodeName.C_Str())];
            const auto read = [&](const aiVectorKey* keys, unsigned count, Keys<Vec3>& to) {
                for (unsigned k = 0; k < count; ++k) {
                    to.times.push_back(static_cast<float>(keys[k].mTime / rate));
                    to.values.push_back({keys[k].mValue.x, keys[k].mValue.y, keys[k].mValue.z});
                }
            };
            read(channel.mPositionKeys, channel.mNumPositionKeys, mover.places);
            read(channel.mScalingKeys, channel.mNumScalingKeys, mover.scales);
            for (unsigned k = 0; k < channel.mNumRotationKeys; ++k) {
                const aiQuaternion& q = channel.mRotationKeys[k].mValue;
                mover.turns.times.push_back(static_cast<float>(channel.mRotationKeys[k].mTime / rate));
                mover.turns.values.push_back(normalized(Quat{q.x, q.y, q.z, q.w}));
            }
        }
    }
    return file;
}

/// Of all bones at all keys of all clips the farthest from where the file has it, m, and the most turned, rad.
struct Farthest {
    float away = 0, turned = 0;
    int poses = 0;
};

Farthest farthest(const Character& character, const KeyedFile& file) {
    Farthest most;
    std::map<std::string, std::size_t> named;
    for (std::size_t i = 0; i < file.nodes.size(); ++i) named.emplace(file.nodes[i].name, i);
    const Affine toModel = uprightScaling(character.upAxis, character.metersPerUnit);
    EXPECT_EQ(character.clips.size(), file.clips.size());
    for (std::size_t c = 0; c < std::min(character.clips.size(), file.clips.size()); ++c) {
        std::vector<float> times{0};
        for (const auto& [node, mover] : file.clips[c])
            for (const auto* of : {&mover.places.times, &mover.turns.times})
                times.insert(times.end(), of->begin(), of->end());
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), times.end()), times.end());
        LocalPose pose = restPose(character.skeleton);
        for (const float time : times) {
            sample(character.clips[c], time, pose);
            const std::vector<Pose> bones = writePose(character.skeleton, pose);
            const std::vector<Affine> nodes = globalsAt(file, file.clips[c], time);
            ++most.poses;
            for (std::size_t b = 0; b < bones.size(); ++b) {
                const auto node = named.find(character.skeleton.bones[b].name);
                if (node == named.end()) {
                    ADD_FAILURE() << character.skeleton.bones[b].name;
                    continue;
                }
                const Frame wanted = rigidPart(toModel * nodes[node->second]);
                most.away = std::max(most.away, length(toVec3(bones[b].position) - wanted.position));
                most.turned =
                    std::max(most.turned, length(rotationVector(conjugate(wanted.rotation) * bones[b].rotation)));
            }
        }
    }
    return most;
}

void expectKeysOf(const std::filesystem::path& path, const KeyedFile& file) {
    const Farthest most = farthest(loadCharacter(path), file);
    EXPECT_GT(most.poses, 0) << path;
    EXPECT_LT(most.away, 1e-5f) << path;
    EXPECT_LT(most.turned, 1e-5f) << path;
    testing::Test::RecordProperty("poses", most.poses);
}

TEST(ClipKeys, OfGltfAreThoseOfTheFile) {
    RAGTOP_SAMPLE(man, "characters/cesium_man.gltf");
    RAGTOP_SAMPLE(knight, "characters/knight.glb");
    expectKeysOf(man, readGltf(man));
    expectKeysOf(knight, readGltf(knight));
}

TEST(ClipKeys, OfFbxAreThoseOfTheFile) {
    RAGTOP_SAMPLE(walk, "characters/arnaud_walk.fbx");
    expectKeysOf(walk, readByAssimp(walk));
}

TEST(ClipKeys, OfXAreThoseOfTheFile) {
    RAGTOP_MODEL(human, "X/BCN_Epileptic.X");
    expectKeysOf(human, readByAssimp(human));
}

}  // namespace
}  // namespace ragtop
