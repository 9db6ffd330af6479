#include <array>
#include <cmath>
#include <cstring>

#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/visual.h"

namespace ragtop {
namespace {

std::string base64(const std::string& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63u];
    }
    return text;
}

template <class T>
void put(std::string& bytes, std::initializer_list<T> values) {
    for (const T value : values) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        bytes.append(raw, sizeof(T));
    }
}

/// A body of three bones, a metre above each other, and three meshes of a triangle each: each mesh follows one of the
/// bones, at whose height it is. All nodes of meshes come first; numbers go to
/// `apart` where that is given. A clip lifts the middle bone by a metre in a second.
std::string gltf(const std::array<const char*, 3>& meshes, const std::array<const char*, 3>& bones,
                 std::string* apart = nullptr) {
    std::string bytes;
    for (int mesh = 0; mesh < 3; ++mesh) {
        const float y = static_cast<float>(mesh);
        put<float>(bytes, {0, y, 0, 0.1f, y, 0, 0, y + 0.1f, 0});
        const auto joint = static_cast<unsigned char>(mesh);
        for (int corner = 0; corner < 3; ++corner) put<unsigned char>(bytes, {joint, 0, 0, 0});
        for (int corner = 0; corner < 3; ++corner) put<float>(bytes, {1, 0, 0, 0});
    }
    const std::size_t binds = bytes.size();
    for (int bone = 0; bone < 3; ++bone)
        put<float>(bytes, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -static_cast<float>(bone), 0, 1});
    const std::size_t times = bytes.size();
    put<float>(bytes, {0, 1});
    put<float>(bytes, {0, 1, 0, 0, 2, 0});
    std::string views, accessors, nodes, shapes;
    const auto accessor = [&](std::size_t offset, std::size_t length, const std::string& type) {
        const std::string comma = views.empty() ? "" : ",";
        views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" +
                 std::to_string(length) + "}";
        accessors +=
            comma + R"({"bufferView":)" + std::to_string(std::count(views.begin(), views.end(), '{') - 1) + type;
    };
    for (std::size_t mesh = 0; mesh < 3; ++mesh) {
        const std::size_t at = mesh * 96;
        accessor(at, 36, R"(,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,9,1]})");
        accessor(at + 36, 12, R"(,"componentType":5121,"count":3,"type":"VEC4"})");
        accessor(at + 48, 48, R"(,"componentType":5126,"count":3,"type":"VEC4"})");
        const auto number = [&](std::size_t k) { return std::to_string(3 * mesh + k); };
        shapes += std::string(mesh ? "," : "") + R"({"name":")" + meshes[mesh] +
                  R"(","primitives":[{"attributes":{"POSITION":)" + number(0) + R"(,"JOINTS_0":)" + number(1) +
                  R"(,"WEIGHTS_0":)" + number(2) + "}}]}";
        nodes += R"({"name":")" + std::string(meshes[mesh]) + R"(","mesh":)" + std::to_string(mesh) + R"(,"skin":0},)";
    }
    accessor(binds, 192, R"(,"componentType":5126,"count":3,"type":"MAT4"})");
    accessor(times, 8, R"(,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]})");
    accessor(times + 8, 24, R"(,"componentType":5126,"count":2,"type":"VEC3"})");
    nodes += R"({"name":")" + std::string(bones[0]) + R"(","children":[4]},{"name":")" + bones[1] +
             R"(","translation":[0,1,0],"children":[5]},{"name":")" + bones[2] + R"(","translation":[0,1,0]})";
    if (apart) *apart = bytes;
    const std::string uri = apart ? "" : R"(,"uri":"data:application/octet-stream;base64,)" + base64(bytes) + "\"";
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2,3]}],"nodes":[)" + nodes +
           R"(],"meshes":[)" + shapes + R"(],"skins":[{"joints":[3,4,5],"inverseBindMatrices":9}],)" +
           R"("animations":[{"name":"lift","channels":[{"sampler":0,"target":{"node":4,"path":"translation"}}],)" +
           R"("samplers":[{"input":10,"output":11}]}],"accessors":[)" + accessors + R"(],"bufferViews":[)" + views +
           R"(],"buffers":[{"byteLength":)" + std::to_string(bytes.size()) + uri + "}]}";
}

/// The three bones hang on each other, at their heights, each with the vertices of its mesh.
void expectChain(const Character& character) {
    const auto& bones = character.skeleton.bones;
    ASSERT_EQ(bones.size(), 3u);
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        EXPECT_EQ(bones[at].parent, i - 1);
        EXPECT_NEAR(bones[at].bind.position.y, static_cast<float>(i), 1e-6f);
        ASSERT_EQ(character.skeleton.skin[at].size(), 3u);
        EXPECT_NEAR(character.skeleton.skin[at][0].y, static_cast<float>(i), 1e-6f);
    }
    ASSERT_EQ(character.clips.size(), 1u);
    LocalPose pose = restPose(character.skeleton);
    sample(character.clips[0], 1, pose);
    const std::vector<Pose> world = writePose(character.skeleton, pose);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(world[i].position.y, i == 0 ? 0 : i == 1 ? 2 : 3, 1e-6) << i;
}

TEST(GltfBones, HangOnEachOtherWhateverTheMeshesAreCalled) {
    const std::array bones{"hip", "chest", "head"};
    for (const auto& meshes : {std::array{"a", "b", "c"}, bones, std::array{"head", "head", "chest"}}) {
        const TemporaryFile file("bones.gltf", gltf(meshes, bones));
        expectChain(loadCharacter(file.path()));
    }
}

TEST(GltfBones, MayHaveTheSameName) {
    const TemporaryFile file("same.gltf", gltf({"bone", "b", "c"}, {"bone", "bone", "bone"}));
    const Character character = loadCharacter(file.path());
    expectChain(character);
    EXPECT_EQ(character.skeleton.bones[0].name, "bone");
    EXPECT_EQ(character.skeleton.bones[2].name, "bone (3)");
}

std::string binaryOf(std::string text, std::string numbers) {
    const auto padded = [](std::string& chunk, char with) {
        chunk.resize((chunk.size() + 3) / 4 * 4, with);
        return static_cast<std::uint32_t>(chunk.size());
    };
    const std::uint32_t first = padded(text, ' '), second = padded(numbers, '\0');
    std::string binary = "glTF";
    put<std::uint32_t>(binary, {2, 28 + first + second, first, 0x4e4f534a});
    binary += text;
    put<std::uint32_t>(binary, {second, 0x004e4942});
    return binary + numbers;
}

TEST(GltfBones, OfABinaryMayHaveTheSameName) {
    std::string numbers;
    const std::string text = gltf({"bone", "b", "c"}, {"bone", "bone", "bone"}, &numbers);
    const TemporaryFile file("same.glb", binaryOf(text, numbers));
    expectChain(loadCharacter(file.path()));
}

TEST(GltfBones, KeysThatGoBackAreToldAndThoseThatAreNoNumberRefused) {
    std::string numbers;
    const std::string text = gltf({"a", "b", "c"}, {"hip", "chest", "head"}, &numbers);
    const std::size_t times = 3 * 96 + 192;
    const auto with = [&](std::size_t at, float number) {
        std::string changed = numbers;
        std::memcpy(changed.data() + times + 4 * at, &number, sizeof number);
        return binaryOf(text, changed);
    };
    const TemporaryFile back("back.glb", with(1, -1));
    EXPECT_TRUE(warns(loadCharacter(back.path()), "1 keys of clips that come no later than the one before"));
    for (const float number : {std::nanf(""), HUGE_VALF}) {
        const TemporaryFile file("key.glb", with(6, number));
        const std::string refused = importError(file.path(), [&] { loadCharacter(file.path()); });
        EXPECT_NE(refused.find("clip 'lift' has a key that is not finite"), std::string::npos) << refused;
    }
    const TemporaryFile sound("sound.glb", with(1, 1));
    EXPECT_FALSE(warns(loadCharacter(sound.path()), "keys of clips"));
}

}  // namespace
}  // namespace ragtop
