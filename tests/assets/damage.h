#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>

namespace ragtop {

/// What a transfer, a disk or a bad program does to a file: bits flipped, digits changed, its end cut off, a section
/// doubled or blanked. The same bytes for the same seed on every machine.
inline std::string damaged(std::string bytes, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::size_t count) { return count > 0 ? random() % count : 0; };
    if (bytes.empty()) return bytes;
    switch (below(5)) {
        case 0:
            for (std::size_t i = 1 + below(16); i > 0; --i)
                bytes[below(bytes.size())] ^= static_cast<char>(1u << below(8));
            break;
        case 1:
            bytes.resize(below(bytes.size()));
            break;
        case 2: {
            const std::size_t from = below(bytes.size()), length = 1 + below(std::min<std::size_t>(bytes.size(), 4096));
            bytes.insert(below(bytes.size()), bytes.substr(from, length));
            break;
        }
        case 3:  // what still has the form of its format
            for (int tries = 0, changed = 0; tries < 20'000 && changed < 16; ++tries) {
                char& byte = bytes[below(bytes.size())];
                if (byte < '0' || byte > '9') continue;
                byte = static_cast<char>('0' + below(10));
                ++changed;
            }
            break;
        default: {
            const std::size_t from = below(bytes.size()), length = 1 + below(64);
            for (std::size_t i = from; i < std::min(from + length, bytes.size()); ++i) bytes[i] = 0;
        }
    }
    return bytes;
}

}  // namespace ragtop
