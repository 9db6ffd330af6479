#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ragtop/shape.h"

namespace ragtop {

/// Built shapes as bytes, little-endian, with all that building has found: for files that a game loads without building
/// again. The layout is that of docs/cooked.md.
struct ShapeImage {
    static constexpr std::size_t kAlignment = 64;  ///< of the first byte of an image

    static std::vector<std::byte> of(const TriangleMesh& mesh);
    static std::vector<std::byte> of(const ConvexHull& hull);

    /// A mesh that reads the image where it lies; `owner` keeps it. Throws std::invalid_argument on bytes that are
    /// none: too short, not aligned, with an index out of range or a number that is not finite.
    static TriangleMesh mesh(std::span<const std::byte> image, std::shared_ptr<const void> owner);
    /// A hull with a copy of the image.
    static ConvexHull hull(std::span<const std::byte> image);

    /// 64 bits by which bytes are known to be those that were written: one word that differs always changes it.
    static std::uint64_t checksum(std::span<const std::byte> bytes);
};

}  // namespace ragtop
