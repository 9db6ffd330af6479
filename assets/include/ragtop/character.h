#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/clip.h"
#include "ragtop/mesh_file.h"
#include "ragtop/ragdoll.h"
#include "ragtop/skeleton.h"
#include "ragtop/spring_bones.h"

namespace ragtop {

/// What to believe where a file says nothing or something wrong.
struct CharacterOptions {
    std::optional<float> metersPerUnit{};  ///< m per unit of the file
    std::optional<UpAxis> upAxis{};        ///< of the file
};

/// What the skin of a file is like.
struct SkinInfo {
    int meshes = 0, vertices = 0, triangles = 0;
    int influences = 0;    ///< most bones that move one vertex
    int renormalized = 0;  ///< vertices whose weights did not sum to one
    float leastSum = 1, greatestSum = 1;
    int unweighted = 0;  ///< vertices that no bone moves
};

/// A rigged character, in metres with Y up.
struct Character {
    std::string file{};
    std::string format{};       ///< of the file, as its importer calls it
    Skeleton skeleton{};        ///< bones that move skin, and what joins them; with their vertices
    std::vector<Clip> clips{};  ///< of the bones of the skeleton
    SpringBonesDef springs{};   ///< hair, ears, clothes that swing, of VRMC_springBone
    SkinInfo skin{};
    std::vector<std::string> droppedBones{};  ///< controls, slots and others that move no vertex
    float metersPerUnit = 1;                  ///< m per unit of the file
    UpAxis upAxis = UpAxis::y;                ///< of the file
    float height = 0;                         ///< m, of skin and joints at rest along y
    std::vector<std::string> warnings{};

    /// Index of the clip of that name, −1 when there is none.
    int findClip(std::string_view name) const;
};

/// Reads a rigged character: FBX, glTF, Collada, X and others; a skeleton alone from BVH. The file is read in a
/// process of its own. Throws AssetError: missing, not readable, no bones, longer than 15 s.
Character loadCharacter(const std::filesystem::path& path, const CharacterOptions& options = {});

/// makeRagdoll of its skeleton.
RagdollDef makeRagdoll(const Character& character, const RagdollOptions& options = {});

/// Units, axes, size, bones, clips and warnings, some lines of text.
std::string describeAsset(const Character& character);
/// Parts with shapes, masses and joints, some lines of text.
std::string describeAsset(const RagdollDef& ragdoll);

}  // namespace ragtop
