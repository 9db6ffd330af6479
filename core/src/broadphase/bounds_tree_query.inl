#pragma once

#include "broadphase/sought_bounds.h"
#include "broadphase/swept_box.h"

namespace ragtop {

template <class Visit>
void BoundsTree::query(const Bounds& bounds, Visit&& visit) const {
    const SoughtBounds sought(bounds);
    if (root_ == kNull || !sought.overlaps(nodes_[root_].bounds)) return;
    // One waiting node per level at most: the right siblings of the path down to the current node.
    std::uint32_t waiting[kMaxHeight];
    int count = 0;
    std::uint32_t index = root_;
    for (;;) {
        const Node& node = nodes_[index];
        if (node.height == 0) {
            if (!visit(node.value)) return;
        } else {
            const bool left = sought.overlaps(nodes_[node.left].bounds);
            const bool right = sought.overlaps(nodes_[node.right].bounds);
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
void BoundsTree::cast(const SweptBox& box, Visit&& visit) const {
    if (root_ == kNull) return;
    struct Waiting {
        std::uint32_t index;
        float enter;
    };
    Waiting waiting[kMaxHeight];
    int count = 0;
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
