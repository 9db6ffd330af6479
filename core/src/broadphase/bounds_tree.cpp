#include "broadphase/bounds_tree.h"

#include <atomic>
#include <bit>
#include <cassert>
#include <cstring>

#include "base/stage_runner.h"

namespace ragtop {

namespace {

/// Refits after which enlarged branches are rebuilt: turning keeps them good for a while, at a quarter of the cost.
constexpr std::uint32_t kRefits = 8;

float centerDistance(const Bounds& a, const Bounds& b) {
    return lengthSquared((a.lower + a.upper) - (b.lower + b.upper));
}

}  // namespace

void BoundsTree::reserve(std::size_t proxies) {
    nodes_.reserve(2 * proxies);
    takeScratch(proxies);
}

std::uint32_t BoundsTree::allocate() {
    if (freeList_ == kNull) {
        nodes_.emplace_back();
        return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    const std::uint32_t index = freeList_;
    freeList_ = nodes_[index].parent;
    nodes_[index] = Node{};
    return index;
}

void BoundsTree::release(std::uint32_t index) {
    nodes_[index] = Node{};
    nodes_[index].parent = freeList_;
    freeList_ = index;
}

std::uint32_t BoundsTree::insert(const Bounds& bounds, std::uint32_t category, std::uint32_t value) {
    const std::uint32_t proxy = allocate();
    Node& node = nodes_[proxy];
    node.bounds = bounds;
    node.category = category;
    node.value = value;
    ++proxyCount_;
    insertLeaf(proxy);
    limitHeight();
    return proxy;
}

void BoundsTree::remove(std::uint32_t proxy) {
    assert(proxy < nodes_.size() && nodes_[proxy].height == 0);
    removeLeaf(proxy);
    release(proxy);
    --proxyCount_;
    limitHeight();
}

void BoundsTree::move(std::uint32_t proxy, const Bounds& bounds) {
    removeLeaf(proxy);
    nodes_[proxy].bounds = bounds;
    insertLeaf(proxy);
    limitHeight();
}

void BoundsTree::enlarge(std::uint32_t proxy, const Bounds& bounds) {
    nodes_[proxy].bounds = bounds;
    for (std::uint32_t index = nodes_[proxy].parent; index != kNull; index = nodes_[index].parent) {
        Node& node = nodes_[index];
        // Above a flagged node that already holds the bounds all others hold them and are flagged.
        if ((node.flags & kEnlarged) != 0 && contains(node.bounds, bounds)) return;
        node.bounds = merge(node.bounds, bounds);
        node.flags |= kEnlarged;
    }
}

/// Who finds a flag leaves what is above to the thread that has set it.
void BoundsTree::tellGiven(std::uint32_t proxy) {
    for (std::uint32_t index = nodes_[proxy].parent; index != kNull; index = nodes_[index].parent) {
        const std::atomic_ref flags(nodes_[index].flags);
        const std::uint16_t before = flags.load(std::memory_order_relaxed);
        if ((before & kEnlarged) != 0) return;
        flags.store(static_cast<std::uint16_t>(before | kEnlarged), std::memory_order_relaxed);
    }
}

void BoundsTree::seek(std::uint32_t proxy) {
    for (std::uint32_t index = proxy; index != kNull; index = nodes_[index].parent) {
        if ((nodes_[index].flags & kSeeking) != 0) return;
        nodes_[index].flags |= kSeeking;
    }
}

void BoundsTree::stopSeeking(std::uint32_t proxy) {
    constexpr auto kOthers = static_cast<std::uint16_t>(~kSeeking);
    for (std::uint32_t index = proxy; index != kNull; index = nodes_[index].parent) {
        if ((nodes_[index].flags & kSeeking) == 0) return;
        nodes_[index].flags &= kOthers;
    }
}

void BoundsTree::collectSeeking(const BoundsTree& partners, std::size_t few, std::pmr::vector<NodePair>& found) const {
    if (root_ == kNull || partners.root_ == kNull || (nodes_[root_].flags & kSeeking) == 0) return;
    const bool within = this == &partners;
    if (!within && !overlaps(nodes_[root_].bounds, partners.nodes_[partners.root_].bounds)) return;
    const auto isLeaf = [&](NodePair pair) {
        return nodes_[pair.mine].height == 0 && partners.nodes_[pair.other].height == 0;
    };
    const auto first = static_cast<std::ptrdiff_t>(found.size());
    std::size_t next = found.size();
    found.push_back({root_, partners.root_});
    for (bool opened = true; opened && found.size() - next < few;) {
        opened = false;
        for (const std::size_t end = found.size(); next < end; ++next) {
            const NodePair pair = found[next];
            if (isLeaf(pair)) {
                found.push_back(pair);
                continue;
            }
            opened = true;
            NodePair below[4];
            found.insert(found.end(), below, open(partners, pair, below));
        }
    }
    found.erase(found.begin() + first, found.begin() + static_cast<std::ptrdiff_t>(next));
}

void BoundsTree::refitEnlarged(StageRunner* runner) {
    if (root_ == kNull || (nodes_[root_].flags & (kEnlarged | kStale)) == 0) return;
    if (nodes_[root_].height == 0) {
        nodes_[root_].flags = 0;
        return;
    }
    if (++refits_ < kRefits) {
        runner ? refitBranches(*runner) : refitBranch(root_);
    } else {
        refits_ = 0;
        rebuild(false, runner);
    }
    limitHeight();
}

/// Children first, as high as the tree is at most.
void BoundsTree::refitBranch(std::uint32_t index) {
    Node& node = nodes_[index];
    if ((node.flags & kEnlarged) == 0) return;
    if (node.height == 0) {
        node.flags = 0;
        return;
    }
    refitBranch(node.left);
    refitBranch(node.right);
    refitNode(index);
}

void BoundsTree::refitNode(std::uint32_t index) {
    nodes_[index].flags = kStale;
    refit(index);
    rotate(index);
}

/// Branches of one level share nothing: each turns within itself. What is above them follows, children first.
void BoundsTree::refitBranches(StageRunner& runner) {
    constexpr int kBranches = 32, kLow = 5;  // some tens of leaves in each
    std::uint32_t branches[kBranches], above[kBranches];
    int count = 0, opened = 0;
    branches[count++] = root_;
    for (bool more = runner.workers() > 1; more;) {
        more = false;
        for (int i = 0, end = count; i < end && count < kBranches; ++i) {
            const Node& node = nodes_[branches[i]];
            if (node.height < kLow || (node.flags & kEnlarged) == 0) continue;
            above[opened++] = branches[i];
            branches[i] = node.left;
            branches[count++] = node.right;
            more = true;
        }
    }
    runner.parallelFor(count, 1, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) refitBranch(branches[i]);
    });
    while (opened > 0) refitNode(above[--opened]);
}

void BoundsTree::setCategory(std::uint32_t proxy, std::uint32_t category) {
    nodes_[proxy].category = category;
    for (std::uint32_t index = nodes_[proxy].parent; index != kNull; index = nodes_[index].parent) {
        nodes_[index].category = nodes_[nodes_[index].left].category | nodes_[nodes_[index].right].category;
    }
}

void BoundsTree::restore(const Header& header, const void* nodes, std::size_t count) {
    nodes_.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(nodes_.data()), nodes, count * sizeof(Node));
    root_ = header.root;
    freeList_ = header.freeList;
    proxyCount_ = header.proxyCount;
    refits_ = header.refits;
}

/// What a node derives from its children.
void BoundsTree::refit(std::uint32_t index) {
    Node& node = nodes_[index];
    const Node& left = nodes_[node.left];
    const Node& right = nodes_[node.right];
    node.bounds = merge(left.bounds, right.bounds);
    node.category = left.category | right.category;
    node.height = static_cast<std::uint16_t>(1 + (left.height > right.height ? left.height : right.height));
    node.flags |= static_cast<std::uint16_t>(left.flags | right.flags);
}

void BoundsTree::insertLeaf(std::uint32_t leaf) {
    if (root_ == kNull) {
        root_ = leaf;
        nodes_[leaf].parent = kNull;
        return;
    }
    const std::uint32_t sibling = bestSibling(nodes_[leaf].bounds);
    const std::uint32_t above = nodes_[sibling].parent;
    const std::uint32_t parent = allocate();
    nodes_[parent].parent = above;
    nodes_[parent].left = sibling;
    nodes_[parent].right = leaf;
    nodes_[sibling].parent = parent;
    nodes_[leaf].parent = parent;
    if (above == kNull) {
        root_ = parent;
    } else if (nodes_[above].left == sibling) {
        nodes_[above].left = parent;
    } else {
        nodes_[above].right = parent;
    }
    for (std::uint32_t index = parent; index != kNull; index = nodes_[index].parent) {
        refit(index);
        rotate(index);
    }
}

void BoundsTree::removeLeaf(std::uint32_t leaf) {
    const std::uint32_t parent = nodes_[leaf].parent;
    nodes_[leaf].parent = kNull;
    if (parent == kNull) {
        root_ = kNull;
        return;
    }
    const std::uint32_t sibling = nodes_[parent].left == leaf ? nodes_[parent].right : nodes_[parent].left;
    const std::uint32_t above = nodes_[parent].parent;
    nodes_[sibling].parent = above;
    if (above == kNull) {
        root_ = sibling;
    } else if (nodes_[above].left == parent) {
        nodes_[above].left = sibling;
    } else {
        nodes_[above].right = sibling;
    }
    release(parent);
    for (std::uint32_t index = above; index != kNull; index = nodes_[index].parent) refit(index);
}

/// The node beside which a leaf costs least [Catto, Dynamic Bounding Volume Hierarchies, GDC 2019]. With S the new
/// leaf, making it a sibling of node N costs
///   direct(N) + inherited(N) = A(N ∪ S) + Σ over the ancestors P of N of (A(P ∪ S) − A(P)),
/// and anything below N costs at least A(S) + A(N ∪ S) − A(N) + inherited(N). One greedy path follows the lower of the
/// two bounds. Where both agree (equal or nested boxes) the nearer and then the lower child is taken and a deeper place
/// preferred, so that many boxes in one place make no list.
std::uint32_t BoundsTree::bestSibling(const Bounds& bounds) const {
    const float own = area(bounds);
    float base = area(nodes_[root_].bounds);
    float direct = area(merge(nodes_[root_].bounds, bounds));
    float inherited = 0;
    std::uint32_t best = root_;
    float bestCost = direct;
    std::uint32_t index = root_;
    while (nodes_[index].height > 0) {
        if (direct + inherited <= bestCost) {
            best = index;
            bestCost = direct + inherited;
        }
        inherited += direct - base;

        const std::uint32_t children[2] = {nodes_[index].left, nodes_[index].right};
        float directs[2], bases[2], lowerBounds[2];
        bool worthwhile[2];
        for (int i = 0; i < 2; ++i) {
            const Node& child = nodes_[children[i]];
            directs[i] = area(merge(child.bounds, bounds));
            bases[i] = area(child.bounds);
            lowerBounds[i] = inherited + directs[i] + (child.height > 0 && own < bases[i] ? own - bases[i] : 0);
            worthwhile[i] = child.height > 0;
            if (child.height == 0 && directs[i] + inherited <= bestCost) {
                best = children[i];
                bestCost = directs[i] + inherited;
            }
        }
        for (int i = 0; i < 2; ++i) worthwhile[i] = worthwhile[i] && lowerBounds[i] <= bestCost;
        if (!worthwhile[0] && !worthwhile[1]) break;
        int next = worthwhile[0] ? 0 : 1;
        if (worthwhile[0] && worthwhile[1]) {
            const Node& a = nodes_[children[0]];
            const Node& b = nodes_[children[1]];
            const float distanceA = centerDistance(a.bounds, bounds);
            const float distanceB = centerDistance(b.bounds, bounds);
            if (lowerBounds[0] != lowerBounds[1]) {
                next = lowerBounds[0] < lowerBounds[1] ? 0 : 1;
            } else if (distanceA != distanceB) {
                next = distanceA < distanceB ? 0 : 1;
            } else {
                next = a.height <= b.height ? 0 : 1;
            }
        }
        index = children[next];
        base = bases[next];
        direct = directs[next];
    }
    return best;
}

/// Exchanges a child of the node with a grandchild on the other side where that shrinks the tree most: with children B
/// and C = {F, G}, exchanging B and F leaves C' = B ∪ G, a gain of A(C) − A(B ∪ G) [Kensler, Tree Rotations for
/// Improving Bounding Volume Hierarchies, 2008].
void BoundsTree::rotate(std::uint32_t index) {
    const std::uint32_t sides[2] = {nodes_[index].left, nodes_[index].right};
    float bestGain = 0;
    std::uint32_t child = kNull, opened = kNull, grandchild = kNull;
    for (int i = 0; i < 2; ++i) {
        const Node& inner = nodes_[sides[1 - i]];
        if (inner.height == 0) continue;
        const float innerArea = area(inner.bounds);
        const Bounds& moved = nodes_[sides[i]].bounds;
        const std::uint32_t below[2] = {inner.left, inner.right};
        for (int j = 0; j < 2; ++j) {
            const float gain = innerArea - area(merge(moved, nodes_[below[1 - j]].bounds));
            if (gain <= bestGain) continue;
            bestGain = gain;
            child = sides[i];
            opened = sides[1 - i];
            grandchild = below[j];
        }
    }
    if (child == kNull) return;
    (nodes_[index].left == child ? nodes_[index].left : nodes_[index].right) = grandchild;
    (nodes_[opened].left == grandchild ? nodes_[opened].left : nodes_[opened].right) = child;
    nodes_[grandchild].parent = index;
    nodes_[child].parent = opened;
    refit(opened);
    refit(index);
}

/// Rebuilds the whole tree in the rare case that it has become a list: a built tree of n leaves is at most 2 bits(n)
/// high, and there is room for as many insertions again before the next time.
void BoundsTree::limitHeight() {
    if (root_ == kNull) return;
    const int bits = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(proxyCount_)));
    if (nodes_[root_].height > 2 * bits + 16) rebuild(true, nullptr);
}

}  // namespace ragtop
