#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "base/hash.h"

namespace ragtop {

/// A 64-bit checksum of much memory, about as fast as reading it: Fletcher's two sums over eight interleaved sequences
/// of words [Fletcher, An Arithmetic Checksum for Serial Transmissions, 1982], then mixed. One changed word always
/// changes the plain sum; words that trade places change the sum of sums.
inline std::uint64_t checksum(std::span<const std::byte> bytes) {
    // Pairs of words fit a register of every target; wider ones would be kept in memory where registers are narrow.
    typedef std::uint64_t Words __attribute__((vector_size(16)));
    struct Block {
        Words a{}, b{}, c{}, d{};
    };
    Block sum, sums;
    const auto add = [&](const Block& words) {
        sum.a += words.a, sum.b += words.b, sum.c += words.c, sum.d += words.d;
        sums.a += sum.a, sums.b += sum.b, sums.c += sum.c, sums.d += sum.d;
    };
    const std::byte* at = bytes.data();
    std::size_t left = bytes.size();
    for (; left >= sizeof(Block); at += sizeof(Block), left -= sizeof(Block)) {
        Block words;
        std::memcpy(&words, at, sizeof words);
        add(words);
    }
    if (left > 0) {
        Block words;
        std::memcpy(&words, at, left);
        add(words);
    }
    StateHash mixed;
    mixed.add(static_cast<std::uint64_t>(bytes.size()));
    for (const Block* block : {&sum, &sums})
        for (const Words& words : {block->a, block->b, block->c, block->d}) {
            mixed.add(static_cast<std::uint64_t>(words[0]));
            mixed.add(static_cast<std::uint64_t>(words[1]));
        }
    return mixed.value();
}

}  // namespace ragtop
