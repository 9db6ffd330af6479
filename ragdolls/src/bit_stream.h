#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

/// Numbers of any width one after another, the lowest bit first.
namespace ragtop {

static_assert(std::endian::native == std::endian::little, "several bytes are read as one number");

class BitWriter {
public:
    void put(std::uint64_t value, unsigned bits) {
        for (unsigned i = 0; i < bits; ++i, ++at_) {
            if (at_ % 8 == 0) bytes_.push_back(0);
            bytes_.back() = static_cast<std::uint8_t>(bytes_.back() | (value >> i & 1u) << at_ % 8);
        }
    }
    /// With what lets eight bytes be read from wherever a number begins.
    std::vector<std::uint8_t> finished() && {
        bytes_.insert(bytes_.end(), sizeof(std::uint64_t) - 1, 0);
        bytes_.shrink_to_fit();
        return std::move(bytes_);
    }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

constexpr std::uint64_t lowest(std::uint64_t value, unsigned bits) { return value & ((std::uint64_t{1} << bits) - 1); }

/// The bits from a place on: 57 of the stream, or more.
inline std::uint64_t bitsAt(const std::uint8_t* stream, std::size_t at) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, stream + at / 8, sizeof bits);
    return bits >> at % 8;
}

/// Numbers with a sign are kept above the lowest one of their width.
constexpr std::int32_t lowestOf(unsigned bits) { return -static_cast<std::int32_t>((std::uint64_t{1} << bits) >> 1); }
/// Fewest bits of one that has a value.
constexpr unsigned signedWidth(std::int32_t value) {
    return value == 0
               ? 0u
               : 1u + static_cast<unsigned>(std::bit_width(static_cast<std::uint32_t>(value < 0 ? ~value : value)));
}

}  // namespace ragtop
