#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ragtop/id.h"
#include "ragtop/math.h"

namespace ragtop {

/// A 64-bit digest of a sequence of values, the same on every platform. Equal states give equal digests: −0 counts as
/// +0, and every NaN as one. Each word goes through a bijection of the digest so far (xor, odd multiplication, xor
/// shift: FNV-1a over 64-bit words with a mixing shift), so one changed word always changes the result.
class StateHash {
public:
    void add(std::uint64_t word) {
        state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
        state_ ^= state_ >> 32;
    }
    void add(std::uint32_t word) { add(std::uint64_t{word}); }
    void add(std::int32_t word) { add(static_cast<std::uint32_t>(word)); }
    void add(bool flag) { add(std::uint64_t{flag}); }
    void add(float value) { add(bitsOf(value)); }
    void add(double value) { add(bitsOf(value)); }
    void add(const Vec3& a) {
        addPair(bitsOf(a.x), bitsOf(a.y));
        add(bitsOf(a.z));
    }
    void add(const DVec3& a) {
        add(a.x);
        add(a.y);
        add(a.z);
    }
    void add(const Quat& q) {
        addPair(bitsOf(q.x), bitsOf(q.y));
        addPair(bitsOf(q.z), bitsOf(q.w));
    }
    void add(const Frame& f) {
        add(f.position);
        add(f.rotation);
    }
    void add(const Pose& p) {
        add(p.position);
        add(p.rotation);
    }
    template <class Tag>
    void add(const Id<Tag>& id) {
        addPair(id.index, id.generation);
    }
    /// Bytes as they are, and their number.
    void add(std::span<const std::byte> bytes) {
        std::uint64_t word = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            word |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * (i % 8));
            if (i % 8 == 7) {
                add(word);
                word = 0;
            }
        }
        if (bytes.size() % 8 != 0) add(word);
        add(static_cast<std::uint64_t>(bytes.size()));
    }

    /// The digest of what was added so far, all bits mixed [Steele, Lea, Flood, Fast Splittable Pseudorandom Number
    /// Generators, 2014].
    std::uint64_t value() const {
        std::uint64_t x = state_;
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
        return x ^ (x >> 31);
    }

private:
    static std::uint32_t bitsOf(float value) {
        if (value == 0) return 0;
        return value != value ? 0x7fc00000u : std::bit_cast<std::uint32_t>(value);
    }
    static std::uint64_t bitsOf(double value) {
        if (value == 0) return 0;
        return value != value ? 0x7ff8000000000000u : std::bit_cast<std::uint64_t>(value);
    }
    void addPair(std::uint32_t low, std::uint32_t high) { add(std::uint64_t{high} << 32 | low); }

    std::uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace ragtop
