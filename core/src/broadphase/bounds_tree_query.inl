#pragma once

#include <cstddef>

#include "base/four_floats.h"
#include "broadphase/swept_box.h"

namespace ragtop {

/// `overlaps` of one box with the bounds of many nodes, without a branch for each of the six comparisons. Of four
/// floats that are read from a node the last is something else.
class OverlapTest {
public:
    explicit OverlapTest(const Bounds& b)
        : lower_{b.lower.x, b.lower.y, b.lower.z, 0}, upper_{b.upper.x, b.upper.y, b.upper.z, 0} {}
    template <class Node>
    bool meets(const Node& node) const {
        static_assert(sizeof(Node) >= sizeof(Bounds) + sizeof(float) && offsetof(Node, bounds) == 0);
        const FourInts meets = (loadFour(&node.bounds.lower.x) <= upper_) & (loadFour(&node.bounds.upper.x) >= lower_);
        return (lanesWhere(meets) & 7u) == 7u;
    }

private:
    FourFloats lower_, upper_;
};

template <class Visit>
void BoundsTree::query(const Bounds& bounds, Visit&& visit) const {
    const OverlapTest test(bounds);
    if (root_ == kNull || !test.meets(nodes_[root_])) return;
    // One waiting node per level at most: the right siblings of the path down to the current node.
    std::uint32_t waiting[kMaxHeight];
    int count = 0;
    std::uint32_t index = root_;
    for (;;) {
        const Node& node = nodes_[index];
        if (node.height == 0) {
            if (!visit(node.value)) return;
        } else {
            const bool left = test.meets(nodes_[node.left]), right = test.meets(nodes_[node.right]);
            if (left) {
                if (right) waiting[count++] = node.right;
                index = node.left;
                continue;
            }
            if (right) {
                index = node.right;
                continue;
            }
        }
        if (count == 0) return;
        index = waiting[--count];
    }
}

template <class Visit>
void BoundsTree::cast(const Vec3& origin, const Vec3& translation, const Vec3& extents, Visit&& visit) const {
    if (root_ == kNull) return;
    struct Waiting {
        std::uint32_t index;
        float enter;
    };
    Waiting waiting[kMaxHeight];
    int count = 0;
    const SweptBox box(origin, translation, extents);
    float closer = 1;
    std::uint32_t index = root_;
    if (box.enter(nodes_[root_].bounds, closer) == SweptBox::kMiss) return;
    for (;;) {
        const Node& node = nodes_[index];
        if (node.height == 0) {
            closer = visit(node.value, closer);
            if (closer <= 0) return;
        } else {
            const float left = box.enter(nodes_[node.left].bounds, closer);
            const float right = box.enter(nodes_[node.right].bounds, closer);
            const bool leftFirst = left <= right;
            const float nearer = leftFirst ? left : right;
            const float farther = leftFirst ? right : left;
            if (nearer != SweptBox::kMiss) {
                if (farther != SweptBox::kMiss) waiting[count++] = {leftFirst ? node.right : node.left, farther};
                index = leftFirst ? node.left : node.right;
                continue;
            }
        }
        do {
            if (count == 0) return;
            --count;
        } while (waiting[count].enter > closer * (1 + 8 * SweptBox::kEpsilon));
        index = waiting[count].index;
    }
}

}  // namespace ragtop
