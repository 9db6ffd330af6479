#include "assimp_scene.h"

#include <assimp/commonMetaData.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <fstream>
#include <map>
#include <new>
#include <set>
#include <string_view>

#include "assimp_bones.h"
#include "assimp_clips.h"
#include "assimp_folder.h"
#include "assimp_looks.h"
#include "assimp_math.h"
#include "axes.h"
#include "file_kind.h"
#include "gltf/numbered_nodes.h"
#include "import_child.h"
#include "json_document.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

template <class Stream, class Node>
void nodeFields(Stream& stream, Node& node) {
    stream(node.name);
    stream(node.parent);
    stream(node.local);
    stream(node.device);
}
template <class Stream, class Bone>
void boneFields(Stream& stream, Bone& bone) {
    stream(bone.name);
    stream(bone.node);
    stream(bone.offset);
    stream(bone.weights);
}
template <class Stream, class Mesh>
void meshFields(Stream& stream, Mesh& mesh) {
    stream(mesh.name);
    stream(mesh.vertices);
    stream(mesh.normals);
    stream(mesh.texture);
    stream(mesh.material);
    stream(mesh.triangles);
    stream(mesh.bones);
    stream(mesh.nodes);
}
template <class Stream, class Channel>
void channelFields(Stream& stream, Channel& channel) {
    stream(channel.node);
    stream(channel.positionTimes);
    stream(channel.rotationTimes);
    stream(channel.scaleTimes);
    stream(channel.positions);
    stream(channel.rotations);
    stream(channel.scales);
}
template <class Stream, class Clip>
void clipFields(Stream& stream, Clip& clip) {
    stream(clip.name);
    stream(clip.seconds);
    stream(clip.channels);
}
template <class Stream, class Material>
void materialFields(Stream& stream, Material& material) {
    stream(material.name);
    stream(material.color);
    stream(material.metalness);
    stream(material.roughness);
    stream(material.twoSided);
    stream(material.image);
}
template <class Stream, class Image>
void imageFields(Stream& stream, Image& image) {
    stream(image.mime);
    stream(image.file);
}

}  // namespace

// One description of each struct serves writing and reading; ByteWriter and ByteReader find these by argument.
static void fields(ByteWriter& stream, const ImportedNode& node) { nodeFields(stream, node); }
static void fields(ByteReader& stream, ImportedNode& node) { nodeFields(stream, node); }
static void fields(ByteWriter& stream, const ImportedBone& bone) { boneFields(stream, bone); }
static void fields(ByteReader& stream, ImportedBone& bone) { boneFields(stream, bone); }
static void fields(ByteWriter& stream, const ImportedMesh& mesh) { meshFields(stream, mesh); }
static void fields(ByteReader& stream, ImportedMesh& mesh) { meshFields(stream, mesh); }
static void fields(ByteWriter& stream, const ImportedChannel& channel) { channelFields(stream, channel); }
static void fields(ByteReader& stream, ImportedChannel& channel) { channelFields(stream, channel); }
static void fields(ByteWriter& stream, const ImportedClip& clip) { clipFields(stream, clip); }
static void fields(ByteReader& stream, ImportedClip& clip) { clipFields(stream, clip); }
static void fields(ByteWriter& stream, const ImportedMaterial& material) { materialFields(stream, material); }
static void fields(ByteReader& stream, ImportedMaterial& material) { materialFields(stream, material); }
static void fields(ByteWriter& stream, const ImportedImage& image) { imageFields(stream, image); }
static void fields(ByteReader& stream, ImportedImage& image) { imageFields(stream, image); }

namespace {

template <class Stream, class Scene>
void sceneFields(Stream& stream, Scene& scene) {
    stream(scene.format);
    stream(scene.unitScale);
    stream(scene.upAxis);
    stream(scene.nodes);
    stream(scene.meshes);
    stream(scene.clips);
    stream(scene.materials);
    stream(scene.images);
    stream(scene.springs.bones);
    stream(scene.springs.colliders);
    stream(scene.springs.grouped);
    stream(scene.warnings);
}

Affine toAffine(const aiMatrix4x4& m) {
    return {{{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}}, {m.a4, m.b4, m.c4}};
}

/// Parents before children, each followed by all below it. Gives the place of each node.
NodePlaces addNodes(const aiNode& root, ImportedScene& scene) {
    NodePlaces places;
    std::vector<const aiNode*> waiting{&root};
    while (!waiting.empty()) {
        const aiNode& node = *waiting.back();
        waiting.pop_back();
        const auto index = static_cast<std::int32_t>(scene.nodes.size());
        places.emplace(&node, index);
        const std::int32_t parent = &node == &root ? -1 : places.at(node.mParent);
        scene.nodes.push_back({node.mName.C_Str(), parent, toAffine(node.mTransformation)});
        for (unsigned i = 0; i < node.mNumMeshes; ++i)
            if (node.mMeshes[i] < scene.meshes.size()) scene.meshes[node.mMeshes[i]].nodes.push_back(index);
        for (unsigned i = node.mNumChildren; i-- > 0;) waiting.push_back(node.mChildren[i]);
    }
    return places;
}

ImportedMesh toMesh(const aiMesh& mesh) {
    ImportedMesh result;
    result.name = mesh.mName.C_Str();
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) result.vertices.push_back(toVec3(mesh.mVertices[i]));
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        if (face.mNumIndices != 3) continue;
        result.triangles.insert(result.triangles.end(), face.mIndices, face.mIndices + 3);
    }
    for (unsigned i = 0; i < mesh.mNumBones; ++i) {
        const aiBone& bone = *mesh.mBones[i];
        ImportedBone to{bone.mName.C_Str(), -1, toAffine(bone.mOffsetMatrix), {}};
        for (unsigned k = 0; k < bone.mNumWeights; ++k)
            to.weights.push_back({bone.mWeights[k].mVertexId, bone.mWeights[k].mWeight});
        result.bones.push_back(std::move(to));
    }
    return result;
}

/// FBX counts in centimetres times a factor of the file, and neither this nor its up axis is applied by the
/// importer; glTF is in metres with y up; of Collada the importer has converted both.
void readUnits(const aiScene& from, ImportedScene& scene) {
    aiString format;
    if (from.mMetaData && from.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, format)) scene.format = format.C_Str();
    const auto isFormat = [&](const char* word) { return scene.format.find(word) != std::string::npos; };
    if (isFormat("FBX")) {
        double factor = 1;
        float single = 1;
        std::int32_t axis = 1;
        if (from.mMetaData->Get("UnitScaleFactor", single))
            factor = static_cast<double>(single);
        else
            from.mMetaData->Get("UnitScaleFactor", factor);
        scene.unitScale = 0.01 * factor;
        if (from.mMetaData->Get("UpAxis", axis) && axis >= 0 && axis <= 2) scene.upAxis = axis;
    } else if (isFormat("glTF") || isFormat("Collada")) {
        scene.unitScale = 1;
        scene.upAxis = 1;
    }
}

/// Cameras and lights go by the names of their nodes; targets by theirs with ".Target" behind.
void markDevices(const aiScene& from, ImportedScene& scene) {
    std::set<std::string> names;
    const auto mark = [&](const aiString& name) {
        if (name.length == 0) return;
        for (const char* ending : {"", ".Target", "_target", ".target", "Target"})
            names.insert(nameInFile(name.C_Str()) + ending);
    };
    for (unsigned i = 0; i < from.mNumCameras; ++i) mark(from.mCameras[i]->mName);
    for (unsigned i = 0; i < from.mNumLights; ++i) mark(from.mLights[i]->mName);
    for (ImportedNode& node : scene.nodes) node.device = names.contains(nameInFile(node.name));
}

ImportedScene toScene(const aiScene& from, const std::string& file) {
    ImportedScene scene;
    readUnits(from, scene);
    for (unsigned i = 0; i < from.mNumMeshes; ++i) scene.meshes.push_back(toMesh(*from.mMeshes[i]));
    if (from.mRootNode) {
        const NodePlaces places = addNodes(*from.mRootNode, scene);
        findBoneNodes(places, scene);
        findSprings(from, file, places, scene);
    }
    markDevices(from, scene);
    return scene;
}

/// Where normals are made, edges sharper than this stay sharp, degrees.
constexpr float kSmoothAngle = 60;

/// At most so long as is read: names in files may have megabytes.
std::string onOneLine(std::string text) {
    constexpr std::size_t kLongest = 300;
    if (text.size() > kLongest) text = text.substr(0, kLongest) + " …";
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ') c = ' ';
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

/// Some of the formats that assimp reads.
constexpr const char* kFormats = "FBX, glTF, Collada, OBJ, STL, PLY, 3DS, X, BVH and others of assimp";

std::string beginningOf(const std::string& file) {
    std::string text(4096, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return text;
}

/// The importer does not say what is wrong with the JSON of a glTF.
void checkJson(const std::string& file) {
    try {
        JsonDocument::parse(gltfText(file), file);
    } catch (const AssetError& error) {
        const std::string mistakes = error.what();
        throw AssetError(mistakes.substr(0, mistakes.find('\n')));
    }
}

[[noreturn]] void refuse(const Assimp::Importer& importer, const std::string& file, const std::string& outside) {
    if (!outside.empty())
        throw AssetError(file, "", "refers to '" + onOneLine(outside) + "', must refer to files in its folder alone");
    const std::string extension = std::filesystem::path(file).extension().string();
    const std::string like = looksLike(beginningOf(file));
    if (extension == ".gltf") checkJson(file);
    if (!importer.IsExtensionSupported(extension))
        throw AssetError(file, "", "is in no format that is read, which are " + std::string(kFormats) + like);
    const std::string reason = onOneLine(importer.GetErrorString());
    if (reason.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    throw AssetError(file, "", "cannot be imported: " + reason + like);
}

/// The importer of glTF 1 reads all of a file to find that it is of version 2, as the header of a binary says [Khronos,
/// glTF 2.0, 4.4.2].
void passOverGltf1(Assimp::Importer& importer, const std::string& file) {
    using namespace std::string_view_literals;
    if (!beginningOf(file).starts_with("glTF\2\0\0\0"sv)) return;
    for (std::size_t i = 0; i < importer.GetImporterCount(); ++i)
        if (importer.GetImporterInfo(i)->mName == "glTF Importer"sv) {
            importer.UnregisterLoader(importer.GetImporter(i));
            return;
        }
}

ImportedScene importHere(const std::string& file, ImportedDetail detail) {
    const bool isGltf = file.ends_with(".gltf") || file.ends_with(".glb");
    if (isGltf) checkGltf(file);
    // Ends with its process, sooner than it is taken apart.
    Assimp::Importer& importer = *new Assimp::Importer;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
    unsigned steps = aiProcess_Triangulate;
    if (detail == ImportedDetail::surface) {
        // Corners that differ in anything but their place would keep the surface from closing.
        steps |= aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices;
        importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                                aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                                aiComponent_BONEWEIGHTS);
    } else if (detail == ImportedDetail::looks) {
        steps |= aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices;
        importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kSmoothAngle);
    }
    passOverGltf1(importer, file);
    auto* files = new FilesOfFolder(file);
    importer.SetIOHandler(files);  // which owns it from now on
    const aiScene* scene = importer.ReadFile(file, steps);
    if (!scene) refuse(importer, file, files->refused());
    if (isGltf && haveEqualNames(*scene->mRootNode)) {
        files->replace(file, withNumberedNodes(file));
        scene = importer.ReadFile(file, steps);
        if (!scene) refuse(importer, file, files->refused());
    }
    ImportedScene imported = toScene(*scene, file);
    if (!files->refused().empty())
        imported.warnings.push_back("file '" + onOneLine(files->refused()) +
                                    "' is left out: it is not in the folder of the model");
    if (detail != ImportedDetail::surface) addClips(*scene, imported);
    if (detail == ImportedDetail::looks) addLooks(*scene, file, imported);
    for (ImportedNode& node : imported.nodes) node.name = nameInFile(node.name);
    for (ImportedMesh& mesh : imported.meshes)
        for (ImportedBone& bone : mesh.bones) bone.name = nameInFile(bone.name);
    return imported;
}

/// Indices that lead nowhere and numbers that are none must not get farther than here.
void check(const ImportedScene& scene, const std::string& file) {
    const auto isFiniteMap = [](const Affine& a) {
        return isFinite(a.linear.cx) && isFinite(a.linear.cy) && isFinite(a.linear.cz) && isFinite(a.shift);
    };
    const auto isFlat = [](const Affine& a) {
        constexpr float kLeast = 1e-6f;  // of the volume between its axes, were they upright
        const Mat3& m = a.linear;
        return !(std::abs(determinant(m)) > kLeast * length(m.cx) * length(m.cy) * length(m.cz));
    };
    for (const ImportedNode& node : scene.nodes)
        if (!isFiniteMap(node.local))
            throw AssetError(file, "", "node '" + node.name + "' has a transform that is not finite");
    for (const ImportedClip& clip : scene.clips)
        if (const std::string problem = whyInvalid(clip, scene.nodes.size()); !problem.empty())
            throw AssetError(file, "", "clip '" + clip.name + "' " + problem);
    const auto isNode = [&](std::int32_t node) {
        return node >= 0 && node < static_cast<std::int32_t>(scene.nodes.size());
    };
    for (const ImportedSpring& spring : scene.springs.bones)
        if (!isNode(spring.node) || !isNode(spring.end)) throw AssetError(file, "", "has a spring of no node");
    for (const ImportedSpringCollider& collider : scene.springs.colliders)
        if (!isNode(collider.node)) throw AssetError(file, "", "has a collider of springs of no node");
    for (const ImportedMesh& mesh : scene.meshes) {
        const std::string name = "mesh '" + mesh.name + "' ";
        for (const Vec3& vertex : mesh.vertices)
            if (!isFinite(vertex)) throw AssetError(file, "", name + "has a vertex that is not finite");
        for (const std::uint32_t index : mesh.triangles)
            if (index >= mesh.vertices.size())
                throw AssetError(file, "",
                                 name + "has a triangle with vertex " + std::to_string(index) + " of " +
                                     std::to_string(mesh.vertices.size()));
        if (mesh.material >= static_cast<std::int32_t>(scene.materials.size()))
            throw AssetError(file, "", name + "has no such material");
        for (const ImportedBone& bone : mesh.bones) {
            if (bone.node >= static_cast<std::int32_t>(scene.nodes.size()))
                throw AssetError(file, "", "bone '" + bone.name + "' has no such node");
            if (!isFiniteMap(bone.offset))
                throw AssetError(file, "", "bone '" + bone.name + "' has a rest pose that is not finite");
            if (isFlat(bone.offset))
                throw AssetError(file, "",
                                 "bone '" + bone.name + "' has a rest pose that is flat, must have an inverse");
            for (const ImportedWeight& weight : bone.weights)
                if (weight.vertex >= mesh.vertices.size() || !std::isfinite(weight.weight))
                    throw AssetError(file, "",
                                     "bone '" + bone.name + "' has a weight that is not finite or of no vertex");
        }
    }
}

}  // namespace

Affine operator*(const Affine& a, const Affine& b) { return {a.linear * b.linear, a.linear * b.shift + a.shift}; }

Vec3 transformPoint(const Affine& a, const Vec3& p) { return a.linear * p + a.shift; }

float determinant(const Mat3& m) { return dot(m.cx, cross(m.cy, m.cz)); }

Affine inverse(const Affine& a) {
    const Mat3& m = a.linear;
    const float d = determinant(m);
    if (d == 0) return {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {}};
    const float s = 1.0f / d;
    const Mat3 inverted = transpose({s * cross(m.cy, m.cz), s * cross(m.cz, m.cx), s * cross(m.cx, m.cy)});
    return {inverted, -(inverted * a.shift)};
}

Affine uprightScaling(UpAxis up, float scale) {
    return {{scale * upright(up, {1, 0, 0}), scale * upright(up, {0, 1, 0}), scale * upright(up, {0, 0, 1})}, {}};
}

Frame rigidPart(const Affine& a) {
    const Vec3 x = normalized(a.linear.cx);
    const Vec3 y = normalized(a.linear.cy - dot(a.linear.cy, x) * x, perpendicular(x));
    return {a.shift, normalized(rotationFromAxes(x, y, cross(x, y)))};
}

std::vector<Affine> globalTransforms(const ImportedScene& scene) {
    std::vector<Affine> globals;
    for (const ImportedNode& node : scene.nodes)
        globals.push_back(node.parent < 0 ? node.local : globals[static_cast<std::size_t>(node.parent)] * node.local);
    return globals;
}

ImportedScene importScene(const std::filesystem::path& path, ImportedDetail detail, std::chrono::milliseconds timeout) {
    ImportedScene scene;
    const auto write = [&](ByteWriter& to) {
        const ImportedScene imported = importHere(path.string(), detail);
        sceneFields(to, imported);
    };
    importInChild(
        path, write, [&](ByteReader& from) { sceneFields(from, scene); }, timeout);
    check(scene, path.string());
    return scene;
}

}  // namespace ragtop
