#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>
#include <utility>
#include <vector>

#include "base/stage_memory.h"
#include "ragtop/math.h"

namespace ragtop {

class StageRunner;
struct SweptBox;

/// A dynamic binary tree of axis-aligned boxes, for pairs, rays and queries. A leaf (proxy) has the bounds that its
/// caller gives it; a branch has the union of those of its children, B = Bl ∪ Br. Two boxes overlap when
///   lower_i ≤ upper'_i  and  lower'_i ≤ upper_i   along x, y and z,
/// and what does not overlap a branch overlaps nothing below it.
///
/// The cost of a query grows with the sum of the surface areas A(B) of all branches [Goldsmith, Salmon, 1987].
/// Insertion descends to where that sum grows least; a branch whose leaves have changed is refitted and, where that
/// makes its children smaller, rotated; after eight refits it is rebuilt.
///
/// The caller enlarges the bounds of shapes by a share of their size and by their motion, so that most shapes stay
/// within them for many steps and only those that leave them are looked up. The same calls give the same tree.
class BoundsTree {
public:
    static constexpr std::uint32_t kNull = 0xffffffffu;  ///< no node
    /// No tree of 2³¹ leaves grows higher; traversals need no more room than this.
    static constexpr int kMaxHeight = 80;

    struct Node {
        Bounds bounds;
        std::uint32_t parent = kNull;  ///< next free node when unused
        std::uint32_t left = kNull, right = kNull;
        std::uint32_t value = 0;               ///< the caller's, leaves only
        std::uint16_t height = 0;              ///< 0 for a leaf
        std::uint16_t flags = 0;               ///< kEnlarged, kStale, kSeeking
        std::uint32_t category = 0xffffffffu;  ///< or of the leaves below
    };

    /// `scratch` is begun anew where branches are rebuilt: in refitEnlarged, and where proxies come and go.
    BoundsTree(std::pmr::memory_resource* memory, StageMemory& scratch) : nodes_(memory), scratch_(scratch) {}

    /// Sets memory aside so that this many proxies need no more of it.
    void reserve(std::size_t proxies);

    std::uint32_t insert(const Bounds& bounds, std::uint32_t category, std::uint32_t value);
    void remove(std::uint32_t proxy);
    /// Moves a proxy elsewhere in the tree.
    void move(std::uint32_t proxy, const Bounds& bounds);
    /// Changes a proxy's bounds in place and grows its ancestors' to hold them, until refitEnlarged().
    void enlarge(std::uint32_t proxy, const Bounds& bounds);
    /// The same in two parts, for many proxies at once: threads give bounds to proxies, each to its own; when all have,
    /// threads tell of each. Nothing may be looked for until refitEnlarged().
    void give(std::uint32_t proxy, const Bounds& bounds) {
        nodes_[proxy].bounds = bounds;
        nodes_[proxy].flags |= kEnlarged;
    }
    bool wasGiven(std::uint32_t proxy) const { return (nodes_[proxy].flags & kEnlarged) != 0; }
    void tellGiven(std::uint32_t proxy);
    void setCategory(std::uint32_t proxy, std::uint32_t category);
    const Bounds& bounds(std::uint32_t proxy) const { return nodes_[proxy].bounds; }
    std::uint32_t value(std::uint32_t proxy) const { return nodes_[proxy].value; }
    int proxyCount() const { return proxyCount_; }
    bool empty() const { return root_ == kNull; }
    /// Of all proxies, where there are any.
    const Bounds& bounds() const { return nodes_[root_].bounds; }
    /// Fits the branches that were enlarged to what is below them and turns them where that makes them smaller, so that
    /// queries stay fast. Call once per step. The tree does not depend on the runner.
    void refitEnlarged(StageRunner* runner = nullptr);

    /// visit(value) → false to end.
    template <class Visit>
    void query(const Bounds& bounds, Visit&& visit) const;
    /// A swept box: visit(value, closer) returns the new largest fraction of interest (0 ends, unchanged goes on).
    /// Nearer branches come first.
    template <class Visit>
    void cast(const SweptBox& box, Visit&& visit) const;

    /// A branch of this tree and one of another, or of this one again; twice the same: pairs within it.
    struct NodePair {
        std::uint32_t mine, other;
    };
    /// Says that the partners of a proxy are looked for, until it is told that they are not.
    void seek(std::uint32_t proxy);
    void stopSeeking(std::uint32_t proxy);
    /// Adds branches of this tree and of `partners`, which may be this one, between which all pairs are that a seeking
    /// proxy of this tree is in: a few at least, if there are as many. They depend on the trees alone.
    void collectSeeking(const BoundsTree& partners, std::size_t few, std::pmr::vector<NodePair>& found) const;
    /// visit(value, value of the partner) for all pairs between both branches.
    template <class Visit>
    void forPairs(const BoundsTree& partners, NodePair from, Visit&& visit) const;

    /// The other way to find the partners of few proxies: visit(place among the sought, value) for all that their bounds meet.
    /// `waiting` is scratch.
    template <class Visit>
    void queryAll(std::span<const Bounds> sought, std::pmr::vector<NodePair>& waiting, Visit&& visit) const;

    /// All state for save and restore: one array and a few numbers.
    struct Header {
        std::uint32_t root = kNull, freeList = kNull;
        std::int32_t proxyCount = 0;
        std::uint32_t refits = 0;
    };
    Header header() const { return {root_, freeList_, proxyCount_, refits_}; }
    const std::pmr::vector<Node>& nodes() const { return nodes_; }
    void restore(const Header& header, const void* nodes, std::size_t count);  ///< memory of any alignment

private:
    static constexpr std::uint16_t kEnlarged = 1;  ///< since the last refit
    static constexpr std::uint16_t kStale = 2;     ///< refitted since its branch was rebuilt
    static constexpr std::uint16_t kSeeking = 4;   ///< seeks partners, or something below does

    /// Half the surface, the cost of a node in the surface area heuristic.
    static constexpr float area(const Bounds& b) {
        const Vec3 size = b.upper - b.lower;
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }

    NodePair* open(const BoundsTree& partners, NodePair pair, NodePair* to) const;

    std::uint32_t allocate();
    void release(std::uint32_t index);
    void insertLeaf(std::uint32_t leaf);
    void removeLeaf(std::uint32_t leaf);
    std::uint32_t bestSibling(const Bounds& bounds) const;
    void refit(std::uint32_t index);
    void refitBranch(std::uint32_t index);
    void refitNode(std::uint32_t index);
    void refitBranches(StageRunner& runner);
    void rotate(std::uint32_t index);
    void limitHeight();
    /// A node that a rebuild takes over as it is, with what the cuts look at side by side.
    struct Branch {
        Bounds bounds;
        std::uint32_t index = kNull;
        std::uint32_t bin = 0;
    };
    /// Branches that become one, and the nodes that this takes: one less.
    struct Part {
        Branch* branches;
        std::uint32_t count;
        int binnedLevels;
        const std::uint32_t* nodes;

        std::uint32_t root() const { return count == 1 ? branches[0].index : nodes[0]; }
    };
    void takeScratch(std::size_t proxies);
    void collectBranches(bool all);
    void rebuild(bool all, StageRunner* runner);
    std::pair<Part, Part> split(const Part& part);
    void build(const Part& part);
    void buildParts(const Part& whole, StageRunner& runner);
    static std::uint32_t partition(Branch* branches, std::uint32_t count, bool binned);
    static int cheapestCut(const Branch* branches, std::uint32_t count);

    std::pmr::vector<Node> nodes_;
    StageMemory& scratch_;
    StageArray<Branch> branches_;      ///< of the rebuild
    StageArray<std::uint32_t> parts_;  ///< the same: nodes in the order in which they are taken
    std::uint32_t root_ = kNull, freeList_ = kNull;
    int proxyCount_ = 0;
    std::uint32_t refits_ = 0;  ///< since branches were rebuilt
};

}  // namespace ragtop

#include "broadphase/bounds_tree_pairs.inl"
#include "broadphase/bounds_tree_query.inl"
