#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "import_child.h"
#include "ragtop/math.h"
#include "ragtop/mesh_file.h"

namespace ragtop {

/// A linear map and a shift, as files have them: may scale, shear and mirror.
struct Affine {
    Mat3 linear{};
    Vec3 shift{};
};
Affine operator*(const Affine& a, const Affine& b);
Vec3 transformPoint(const Affine& a, const Vec3& p);
/// The inverse; of a map without one, all zeros.
Affine inverse(const Affine& a);
float determinant(const Mat3& m);
/// Turns the axis that points up in a file into y, and scales.
Affine uprightScaling(UpAxis up, float scale);
/// The rotation nearest to the first two axes, and the shift; a mirror image is turned back into a rotation.
Frame rigidPart(const Affine& a);

struct ImportedNode {
    std::string name;
    std::int32_t parent = -1;
    Affine local;
    bool device = false;  ///< a camera, a light, or what one looks at
};

struct ImportedWeight {
    std::uint32_t vertex = 0;
    float weight = 0;
};

struct ImportedBone {
    std::string name;
    std::int32_t node = -1;  ///< that it is; −1: the file has none
    Affine offset;           ///< from the mesh to the bone, at rest
    std::vector<ImportedWeight> weights;
};

/// Coordinates in a texture; v runs down.
struct TextureCoordinate {
    float u = 0, v = 0;
};

struct ImportedMesh {
    std::string name;
    std::vector<Vec3> vertices;
    std::vector<Vec3> normals;               ///< none, or one per vertex
    std::vector<TextureCoordinate> texture;  ///< none, or one per vertex
    std::int32_t material = -1;
    std::vector<std::uint32_t> triangles;  ///< three indices each
    std::vector<ImportedBone> bones;
    std::vector<std::int32_t> nodes;  ///< where it stands
};

/// What a clip does to a node in its parent; it has one key of each kind at least.
struct ImportedChannel {
    std::int32_t node = -1;
    std::vector<float> positionTimes, rotationTimes, scaleTimes;  ///< s, rising
    std::vector<Vec3> positions;
    std::vector<Quat> rotations;
    std::vector<Vec3> scales;
};

struct ImportedClip {
    std::string name;
    double seconds = 0;
    std::vector<ImportedChannel> channels;
};

/// A PNG or JPEG file.
struct ImportedImage {
    std::string mime;
    std::vector<char> file;
};

struct ImportedMaterial {
    std::string name;
    std::array<float, 4> color{0.8f, 0.8f, 0.8f, 1};  ///< linear red, green, blue; opacity
    float metalness = 0, roughness = 0.8f;
    bool twoSided = false;
    std::int32_t image = -1;  ///< of the colour, which it multiplies
};

/// A bone that swings as VRMC_springBone has it, and the node where it ends.
struct ImportedSpring {
    std::int32_t node = -1, end = -1;
    float stiffness = 0, gravityPower = 0;  ///< m/s: by which it goes on in a frame, over the frame's time
    float drag = 0;                         ///< share of its motion that it loses in a frame
    float hitRadius = 0;
    Vec3 gravity{0, -1, 0};     ///< direction
    std::int32_t centered = 0;  ///< 1: what carries the character does not shake it
};
/// A ball, or a capsule between two points, in a node.
struct ImportedSpringCollider {
    std::int32_t node = -1;
    Vec3 from{}, to{};
    float radius = 0;
};
struct ImportedSprings {
    std::vector<ImportedSpring> bones;
    std::vector<ImportedSpringCollider> colliders;
    bool grouped = false;  ///< colliders are not the same for all
};

/// What a file says, in its own units and axes; nodes have parents before children.
struct ImportedScene {
    std::string format;
    double unitScale = 0;      ///< m per unit; 0: the file does not say and the importer has not converted
    std::int32_t upAxis = -1;  ///< 0 x, 1 y, 2 z; −1: the file does not say
    std::vector<ImportedNode> nodes;
    std::vector<ImportedMesh> meshes;
    std::vector<ImportedClip> clips;
    std::vector<ImportedMaterial> materials;
    std::vector<ImportedImage> images;
    ImportedSprings springs;
    std::vector<std::string> warnings;
};

/// What is wanted of a file.
enum class ImportedDetail : std::uint8_t {
    surface,   ///< triangles that share the vertices at one place
    skeleton,  ///< bones, the vertices that they move, and clips
    looks,     ///< that and normals, materials and textures
};

/// Node by node from the root, their transforms in the scene.
std::vector<Affine> globalTransforms(const ImportedScene& scene);

/// Reads a file with assimp in a process of its own, since some files crash it, never end, or take all memory.
/// Throws AssetError: missing, not readable, crashed, out of time.
ImportedScene importScene(const std::filesystem::path& path, ImportedDetail detail,
                          std::chrono::milliseconds timeout = kImportTime);

}  // namespace ragtop
