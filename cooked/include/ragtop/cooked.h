#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "ragtop/clip.h"
#include "ragtop/ragdoll.h"
#include "ragtop/robot_def.h"
#include "ragtop/shape.h"
#include "ragtop/skeleton.h"

/// Assets as a game loads them: one file, read where it lies in memory (docs/cooked.md).
namespace ragtop {

/// What is wrong with a cooked file, in one line that begins with its name.
struct CookedError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A version that is not this one's is refused: cook again.
inline constexpr std::uint32_t kCookedVersion = 5;

/// What one file holds; what it does not is empty.
struct Cooked {
    std::uint64_t sourceHash = 0;         ///< of the file that it was made from, cookedHash of its bytes
    std::optional<TriangleMesh> mesh{};   ///< with its tree, read in place
    std::vector<ConvexHull> pieces{};     ///< convex pieces of the mesh
    std::optional<Skeleton> skeleton{};   ///< without skin
    std::vector<Clip> clips{};            ///< of the skeleton
    std::optional<RagdollDef> ragdoll{};  ///< of the skeleton
    std::optional<Robot> robot{};         ///< `file` is the cooked one's name; without tags and warnings
};

/// The bytes of a cooked file. Throws std::invalid_argument on clips, a ragdoll or a robot that are not usable.
std::vector<std::byte> cook(const Cooked& asset);
/// Writes them. Throws CookedError where that is not possible.
void saveCooked(const Cooked& asset, const std::filesystem::path& path);

/// Reads a cooked file. A mesh stays in the file's memory, which its copies keep. Throws CookedError: missing, no
/// cooked file, another version, cut short, a byte that differs from what was written.
Cooked loadCooked(const std::filesystem::path& path);
/// The same from bytes that the caller has, aligned to 64; `owner` keeps them; `name` is for messages.
Cooked readCooked(std::span<const std::byte> bytes, std::shared_ptr<const void> owner, const std::string& name);

/// 64 bits that tell whether a source file has changed.
std::uint64_t cookedHash(std::span<const std::byte> bytes);

}  // namespace ragtop
