#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "base/pair_set.h"
#include "base/stage_memory.h"
#include "broadphase/bounds_tree.h"
#include "ragtop/math.h"

namespace ragtop {

/// By a margin, m, on each side.
inline Bounds enlarged(const Bounds& bounds, float margin) {
    const Vec3 m{margin, margin, margin};
    return {bounds.lower - m, bounds.upper + m};
}

/// How far a body with a single shape that swings free can still go before that leaves its bounds.
struct BoundsRoom {
    static constexpr double kUnknown = -1;  ///< no travel is negative
    Vec3 below, above;         ///< m, towards the lower and the upper bounds
    double travel = kUnknown;  ///< m, of the body then
};

/// Which shapes have left their bounds at the end of a step.
struct BoundsLeft {
    explicit BoundsLeft(std::pmr::memory_resource* memory) : bodies(memory), starts(memory), rooms(memory) {}
    AlignedArray<std::uint8_t> bodies;   ///< per awake body: has some shape of it?
    AlignedArray<std::uint32_t> starts;  ///< per block of bodies: where their shapes begin in the list of moved ones
    AlignedArray<BoundsRoom> rooms;      ///< per body
};

/// Two shapes whose bounds have met.
struct PairFound {
    std::uint32_t a, b;
};

/// What the search for pairs uses.
struct PairSearch {
    explicit PairSearch(std::pmr::memory_resource* memory) : branches(memory) {}
    std::pmr::vector<BoundsTree::NodePair> branches;              ///< between which partners are sought
    std::vector<std::pmr::vector<PairFound>> found;               ///< per pair of branches, or per block of shapes
    std::vector<std::pmr::vector<BoundsTree::NodePair>> waiting;  ///< per worker: scratch of BoundsTree::queryAll
};

/// Bounds of all shapes, enlarged, in two trees: of what never moves, and of all else; the pairs of shapes whose bounds
/// overlap, by the number of their contact; and the shapes that look for partners in the next step.
///
/// Between two calls `moved` holds each shape once whose record says that it is in it, and `pairs` has exactly the
/// pairs of the contacts there are.
struct Broadphase {
    Broadphase(std::pmr::memory_resource* memory, StageMemory& scratch)
        : fixedTree(memory, scratch),
          movingTree(memory, scratch),
          pairs(memory),
          moved(memory),
          newVelocities(memory),
          search(memory),
          left(memory) {}

    BoundsTree& tree(bool fixed) { return fixed ? fixedTree : movingTree; }
    const BoundsTree& tree(bool fixed) const { return fixed ? fixedTree : movingTree; }

    template <class Archive>
    void archive(Archive& archive) {
        archive(newVelocities);
        archive(moved);
        archive.tree(fixedTree);
        archive.tree(movingTree);
        archive.pairs(pairs);
    }

    BoundsTree fixedTree, movingTree;
    PairSet pairs;
    AlignedArray<std::uint32_t> moved;
    AlignedArray<std::uint32_t> newVelocities;  ///< bodies with BodyRecord::hasNewVelocity, and some that are no more
    PairSearch search;
    BoundsLeft left;
};

}  // namespace ragtop
