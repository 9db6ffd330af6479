#pragma once

#include <array>
#include <bit>
#include <cstdint>

/// The fixed parts of a cooked file; docs/cooked.md says what they mean.
namespace ragtop {

static_assert(std::endian::native == std::endian::little, "cooked files are little-endian, and read in place");

inline constexpr std::array<char, 8> kCookedMagic{'R', 'A', 'G', 'T', 'O', 'P', '\r', '\n'};
inline constexpr std::size_t kCookedAlignment = 64;  ///< of sections, which are as many times that long
inline constexpr std::uint32_t kMostSections = 65536;

enum class SectionKind : std::uint32_t { mesh = 1, piece = 2, skeleton = 3, clip = 4, ragdoll = 5, robot = 6 };

struct CookedHead {
    std::array<char, 8> magic = kCookedMagic;
    std::uint32_t version = 0;
    std::uint32_t sections = 0;
    std::uint64_t size = 0;  ///< of the whole file
    std::uint64_t sourceHash = 0;
    std::uint64_t checksum = 0;  ///< of head and list of sections, while this is 0
    std::array<std::uint64_t, 3> zero{};
};
static_assert(sizeof(CookedHead) == 64);

struct CookedSection {
    SectionKind kind{};
    std::uint32_t zero = 0;
    std::uint64_t offset = 0, size = 0;
    std::uint64_t checksum = 0;
};
static_assert(sizeof(CookedSection) == 32);

constexpr std::size_t padded(std::size_t size) {
    return (size + kCookedAlignment - 1) / kCookedAlignment * kCookedAlignment;
}

}  // namespace ragtop
