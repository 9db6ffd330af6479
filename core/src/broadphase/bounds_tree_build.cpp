#include <algorithm>
#include <bit>
#include <tuple>

#include "base/stage_runner.h"
#include "broadphase/bounds_tree.h"

/// Rebuilding of branches from the top down by binned surface areas [Wald, On Fast Construction of SAH-based Bounding
/// Volume Hierarchies, 2007].
namespace ragtop {

namespace {

constexpr int kBins = 8;  ///< of the longest axis, by trial
constexpr float kFar = 3.4e38f;  ///< beyond all bounds

/// Twice the centre.
Vec3 center(const Bounds& b) { return b.lower + b.upper; }

struct Bin {
    Bounds bounds{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
    std::uint32_t count = 0;
};

}  // namespace

/// There are never more branches, and parts of the tree that wait, than proxies.
void BoundsTree::takeScratch(std::size_t proxies) {
    scratch_.begin(StageMemory::bytesOf<Branch>(proxies) + StageMemory::bytesOf<std::uint32_t>(proxies));
    branches_ = scratch_.take<Branch>(proxies);
    parts_ = scratch_.take<std::uint32_t>(proxies);
}

void BoundsTree::rebuild(bool all, StageRunner* runner) {
    takeScratch(static_cast<std::size_t>(proxyCount_));
    collectBranches(all);
    const auto count = static_cast<std::uint32_t>(branches_.size());
    for (std::uint32_t i = 1; i < count; ++i) parts_.push(allocate());
    // The binned cut may be lopsided; after these levels of it the rest is halved, so that the height stays within
    // twice the logarithm of the count.
    const Part whole{branches_.data(), count, static_cast<int>(std::bit_width(count)), parts_.data()};
    root_ = whole.root();
    runner ? buildParts(whole, *runner) : build(whole);
    nodes_[root_].parent = kNull;
}

/// Takes the tree apart from the root down to its leaves or to branches that were not enlarged, freeing what is above.
/// The list itself serves as the stack of nodes to look at: [0, kept) are branches, the rest waits.
void BoundsTree::collectBranches(bool all) {
    branches_.push({{}, root_, 0});
    std::size_t kept = 0;
    while (kept < branches_.size()) {
        const std::uint32_t index = branches_.back().index;
        const Node node = nodes_[index];
        if (node.height > 0 && (all || node.flags != 0)) {
            release(index);
            branches_.back().index = node.right;
            branches_.push({{}, node.left, 0});
        } else {
            nodes_[index].flags = 0;
            branches_.back().index = branches_[kept].index;
            branches_[kept++] = {node.bounds, index, 0};
        }
    }
}

/// Links the root of several branches with those of its two sides, which are yet to be built.
std::pair<BoundsTree::Part, BoundsTree::Part> BoundsTree::split(const Part& part) {
    const std::uint32_t cut = part.count == 2 ? 1 : partition(part.branches, part.count, part.binnedLevels > 0);
    const Part left{part.branches, cut, part.binnedLevels - 1, part.nodes + 1};
    const Part right{part.branches + cut, part.count - cut, part.binnedLevels - 1, part.nodes + cut};
    const std::uint32_t index = part.root();
    nodes_[index].left = left.root();
    nodes_[index].right = right.root();
    nodes_[left.root()].parent = index;
    nodes_[right.root()].parent = index;
    return {left, right};
}

void BoundsTree::build(const Part& part) {
    if (part.count == 1) return;
    const auto [left, right] = split(part);
    build(left);
    build(right);
    refit(part.root());
}

/// Parts share nothing; what is above them follows, children first. They are split level by level, those of one at once.
void BoundsTree::buildParts(const Part& whole, StageRunner& runner) {
    constexpr int kParts = 32;  // tasks at most, which the stack holds
    constexpr std::uint32_t kFew = 64;  // branches
    Part parts[kParts];
    std::uint32_t above[kParts];
    int places[kParts], count = 0, opened = 0;
    parts[count++] = whole;
    for (bool more = runner.workers() > 1; more;) {
        const int end = count, first = opened;
        for (int i = 0; i < end && count < kParts; ++i) {
            if (parts[i].count < kFew) continue;
            places[opened] = i;
            above[opened++] = parts[i].root();
            ++count;
        }
        runner.parallelFor(opened - first, 1, [&](int from, int to, int) {
            for (int k = from; k < to; ++k)
                std::tie(parts[places[first + k]], parts[end + k]) = split(parts[places[first + k]]);
        });
        more = opened > first;
    }
    runner.parallelFor(count, 1, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) build(parts[i]);
    });
    while (opened > 0) refit(above[--opened]);
}

/// Sorts the branches to the two sides of a cut across the axis along which their centres spread most; the count of
/// the left side is neither 0 nor all.
std::uint32_t BoundsTree::partition(Branch* branches, std::uint32_t count, bool binned) {
    Vec3 lower = center(branches[0].bounds);
    Vec3 upper = lower;
    for (std::uint32_t i = 1; i < count; ++i) {
        const Vec3 c = center(branches[i].bounds);
        lower = min(lower, c);
        upper = max(upper, c);
    }
    const Vec3 spread = upper - lower;
    const int axis = spread.x >= spread.y ? (spread.x >= spread.z ? 0 : 2) : (spread.y >= spread.z ? 1 : 2);
    const float size = spread[axis];
    // Below this the factor of the bins would overflow: all centres are one.
    if (!(size > 1e-37f)) return count / 2;
    if (!binned) {
        // A sort of distinct keys has one outcome; std::nth_element orders the halves as each library likes.
        std::sort(branches, branches + count, [&](const Branch& a, const Branch& b) {
            const float ca = center(a.bounds)[axis];
            const float cb = center(b.bounds)[axis];
            return ca < cb || (ca == cb && a.index < b.index);
        });
        return count / 2;
    }
    const float start = lower[axis];
    const float binsPerLength = kBins / size;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float place = (center(branches[i].bounds)[axis] - start) * binsPerLength;
        branches[i].bin = static_cast<std::uint32_t>(place < kBins - 1 ? place : kBins - 1);
    }
    const auto cut = static_cast<std::uint32_t>(cheapestCut(branches, count));
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (branches[i].bin < cut) std::swap(branches[left++], branches[i]);
    }
    return left;
}

/// The number of bins left of the cut that is cheapest by count · area on both sides. There is one with branches on
/// both sides, since the first and the last bin hold the outermost.
int BoundsTree::cheapestCut(const Branch* branches, std::uint32_t count) {
    Bin bins[kBins];
    for (std::uint32_t i = 0; i < count; ++i) {
        Bin& bin = bins[branches[i].bin];
        bin.bounds = merge(bin.bounds, branches[i].bounds);
        ++bin.count;
    }
    float rightCost[kBins] = {};
    Bin right;
    for (int i = kBins - 1; i > 0; --i) {
        right.bounds = merge(right.bounds, bins[i].bounds);
        right.count += bins[i].count;
        rightCost[i] = static_cast<float>(right.count) * area(right.bounds);
    }
    int best = 1;
    float bestCost = kFar;
    Bin left;
    for (int i = 1; i < kBins; ++i) {
        left.bounds = merge(left.bounds, bins[i - 1].bounds);
        left.count += bins[i - 1].count;
        const float cost = static_cast<float>(left.count) * area(left.bounds) + rightCost[i];
        if (cost < bestCost) {
            best = i;
            bestCost = cost;
        }
    }
    return best;
}

}  // namespace ragtop
