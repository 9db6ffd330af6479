#pragma once

#include <cstdint>

/// Sets of numbers as trees: parent[i] leads to the root of i, whose parent is itself. Of two roots the lower one wins,
/// so that roots depend on what was united alone.
namespace ragtop {

template <class Parents>
std::uint32_t rootOf(Parents& parent, std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

template <class Parents>
void unite(Parents& parent, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t rootA = rootOf(parent, a), rootB = rootOf(parent, b);
    parent[rootA < rootB ? rootB : rootA] = rootA < rootB ? rootA : rootB;
}

}  // namespace ragtop
