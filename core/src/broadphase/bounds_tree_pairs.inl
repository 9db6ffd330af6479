#pragma once

#include "base/prefetch.h"
#include "broadphase/sought_bounds.h"

/// Pairs of many proxies at once: two trees are gone down together, so that what is far apart is told apart once, and not
/// for each proxy from the root on.
namespace ragtop {

/// Puts those pairs of branches below at `to` that may hold pairs of proxies, four at most, and gives what is behind them.
/// The higher branch is opened, or both: then branches of like size meet. Which of them meet nobody foresees: all are
/// written, and kept or not.
inline BoundsTree::NodePair* BoundsTree::open(const BoundsTree& partners, NodePair pair, NodePair* to) const {
    const Node& mine = nodes_[pair.mine];
    const auto add = [&](std::uint32_t a, std::uint32_t b, const SoughtBounds& ofB) {
        const Node& node = nodes_[a];
        const bool seeks = ((node.flags | partners.nodes_[b].flags) & kSeeking) != 0;
        *to = {a, b};
        to += static_cast<int>(seeks) & static_cast<int>(ofB.overlaps(node.bounds));
    };
    const auto addWithin = [&](std::uint32_t index) {
        *to = {index, index};
        to += (nodes_[index].flags & kSeeking) != 0 && nodes_[index].height > 0 ? 1 : 0;
    };
    if (this == &partners && pair.mine == pair.other) {
        if (mine.height == 0) return to;
        addWithin(mine.left);
        addWithin(mine.right);
        add(mine.left, mine.right, SoughtBounds(nodes_[mine.right].bounds));
        return to;
    }
    const Node& other = partners.nodes_[pair.other];
    const auto addAll = [&](std::uint32_t b) {
        const SoughtBounds sought(partners.nodes_[b].bounds);
        add(mine.left, b, sought);
        add(mine.right, b, sought);
    };
    if (mine.height < other.height) {
        add(pair.mine, other.left, SoughtBounds(partners.nodes_[other.left].bounds));
        add(pair.mine, other.right, SoughtBounds(partners.nodes_[other.right].bounds));
    } else if (mine.height > other.height) {
        addAll(pair.other);
    } else {
        addAll(other.left);
        addAll(other.right);
    }
    return to;
}

template <class Visit>
void BoundsTree::forPairs(const BoundsTree& partners, NodePair from, Visit&& visit) const {
    // Opening one branch leaves one more waiting, opening both leaves three.
    NodePair waiting[4 * kMaxHeight];
    NodePair* next = waiting;
    *next++ = from;
    while (next != waiting) {
        const NodePair pair = *--next;
        const Node &mine = nodes_[pair.mine], &other = partners.nodes_[pair.other];
        if (mine.height + other.height > 0)
            next = open(partners, pair, next);
        else if (this != &partners || pair.mine != pair.other)
            visit(mine.value, other.value);
    }
}

/// All go down side by side, first in, first out: what is below a branch has come when its turn has.
template <class Visit>
void BoundsTree::queryAll(std::span<const Bounds> sought, std::pmr::vector<NodePair>& waiting, Visit&& visit) const {
    waiting.clear();
    const auto wait = [&](std::uint32_t place, std::uint32_t index) {
        const Node& node = nodes_[index];
        if (!overlaps(sought[place], node.bounds)) return;
        waiting.push_back({place, index});
        if (node.height == 0) return;
        for (const std::uint32_t below : {node.left, node.right}) {
            prefetch(&nodes_[below].bounds);
            prefetch(&nodes_[below].category);
        }
    };
    for (std::uint32_t place = 0; root_ != kNull && place < sought.size(); ++place) wait(place, root_);
    for (std::size_t next = 0; next < waiting.size(); ++next) {
        const auto [place, index] = waiting[next];
        const Node& node = nodes_[index];
        if (node.height == 0) {
            visit(place, node.value);
        } else {
            wait(place, node.left);
            wait(place, node.right);
        }
    }
}

}  // namespace ragtop
