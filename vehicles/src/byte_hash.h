#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ragtop {

/// FNV-1a.
class ByteHash {
public:
    void add(std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) value_ = (value_ ^ static_cast<std::uint64_t>(byte)) * kPrime;
    }
    std::uint64_t value() const { return value_; }

private:
    static constexpr std::uint64_t kPrime = 1099511628211ull;
    std::uint64_t value_ = 14695981039346656037ull;
};

}  // namespace ragtop
