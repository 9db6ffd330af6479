#include "contacts/find_pairs.h"

#include <algorithm>

#include "base/prefetch.h"
#include "contacts/may_collide.h"
#include "contacts/surfaces.h"

namespace ragtop {

namespace {

/// Pairs whose bounds a shape has met, few at a time: by the time the table of pairs is asked for them, in which they
/// lie in no order, its memory is on the way.
class PairsMet {
public:
    PairsMet(const PairView& view, std::pmr::vector<PairFound>& found) : view_(view), found_(found) {}
    void add(std::uint32_t shape, std::uint32_t other) {
        prefetch(&view_.shapes[other].filter);
        view_.broadphase.pairs.prefetch(pairKey(shape, other));
        met_[count_++] = {shape, other};
        if (count_ == kMost) ask();
    }
    /// Of obstacles in the move buffer, with what moves and has not found them itself.
    void addObstacles() {
        for (const std::uint32_t index : view_.broadphase.moved) {
            const ShapeRecord& shape = view_.shapes[index];
            if (!shape.isStaticTree) continue;
            view_.broadphase.movingTree.query(view_.broadphase.fixedTree.bounds(shape.proxy), [&](std::uint32_t other) {
                if (!view_.shapes[other].inMoveBuffer) add(index, other);
                return true;
            });
        }
    }
    void ask() {
        for (int i = 0; i < count_; ++i)
            if (isNew(met_[i])) found_.push_back(met_[i]);
        count_ = 0;
    }

private:
    static constexpr int kMost = 64;  ///< pairs that are asked for at once

    bool isNew(const PairFound& pair) const {
        const ShapeRecord &a = view_.shapes[pair.a], &b = view_.shapes[pair.b];
        if (!filtersAgree(a.filter, b.filter)) return false;
        if (view_.broadphase.pairs.contains(pairKey(pair.a, pair.b)) ||
            !shouldCollide(view_.bodies, view_.shapes, view_.joints, a, b))
            return false;
        return !view_.callbacks.filter || view_.callbacks.filter(pairInfo(view_.bodies, view_.shapes, pair.a, pair.b));
    }

    const PairView& view_;
    std::pmr::vector<PairFound>& found_;
    PairFound met_[kMost];
    int count_ = 0;
};

/// Pairs of moving shapes in the move buffer together: the trees are gone down once for all of them.
std::size_t findPairsOfMany(const PairView& view, StageRunner& runner, bool obstaclesToo) {
    constexpr std::size_t kMostBranches = 64;     // tasks
    constexpr std::size_t kShapesPerBranch = 32;  // of a task, by trial
    BoundsTree& tree = view.broadphase.movingTree;
    for (const std::uint32_t shape : view.broadphase.moved)
        if (!view.shapes[shape].isStaticTree) tree.seek(view.shapes[shape].proxy);
    const std::size_t few = std::min(view.broadphase.moved.size() / kShapesPerBranch, kMostBranches);
    auto& branches = view.broadphase.search.branches;
    auto& found = view.broadphase.search.found;
    branches.clear();
    tree.collectSeeking(tree, few, branches);
    const std::size_t amongMoving = branches.size();
    if (obstaclesToo) tree.collectSeeking(view.broadphase.fixedTree, few, branches);
    while (found.size() < branches.size()) found.emplace_back(view.memory);
    runner.parallelFor(static_cast<int>(branches.size()), 1, [&](int begin, int end, int) {
        for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block) {
            found[block].clear();
            PairsMet met(view, found[block]);
            tree.forPairs(block < amongMoving ? tree : view.broadphase.fixedTree, branches[block],
                          [&](std::uint32_t a, std::uint32_t b) { met.add(a, b); });
            met.ask();
        }
    });
    for (const std::uint32_t shape : view.broadphase.moved)
        if (!view.shapes[shape].isStaticTree) tree.stopSeeking(view.shapes[shape].proxy);
    return branches.size();
}

/// The same where few of many have moved: branches that hold one of them are far larger than it, and would meet much
/// that it does not. Of two that both seek, the first one in the order of shapes finds the other.
std::size_t findPairsOfFew(const PairView& view, StageRunner& runner, bool obstaclesToo) {
    constexpr std::size_t kAtOnce = 64;  // shapes of a task
    auto& found = view.broadphase.search.found;
    auto& waiting = view.broadphase.search.waiting;
    const std::size_t count = view.broadphase.moved.size(), blocks = (count + kAtOnce - 1) / kAtOnce;
    while (found.size() < blocks) found.emplace_back(view.memory);
    while (waiting.size() < static_cast<std::size_t>(runner.workers())) waiting.emplace_back(view.memory);
    runner.parallelFor(static_cast<int>(blocks), 1, [&](int begin, int end, int worker) {
        for (auto block = static_cast<std::size_t>(begin); block < static_cast<std::size_t>(end); ++block) {
            found[block].clear();
            PairsMet met(view, found[block]);
            std::uint32_t seekers[kAtOnce];
            Bounds sought[kAtOnce];
            std::size_t seeking = 0;
            for (std::size_t i = block * kAtOnce; i < std::min(count, (block + 1) * kAtOnce); ++i) {
                const ShapeRecord& shape = view.shapes[view.broadphase.moved[i]];
                if (shape.isStaticTree) continue;
                seekers[seeking] = view.broadphase.moved[i];
                sought[seeking++] = view.broadphase.movingTree.bounds(shape.proxy);
            }
            auto& scratch = waiting[static_cast<std::size_t>(worker)];
            view.broadphase.movingTree.queryAll(
                {sought, seeking}, scratch, [&](std::uint32_t place, std::uint32_t other) {
                    const std::uint32_t own = seekers[place];
                    if (own < other || (own != other && !view.shapes[other].inMoveBuffer)) met.add(own, other);
                });
            if (obstaclesToo)
                view.broadphase.fixedTree.queryAll(
                    {sought, seeking}, scratch,
                    [&](std::uint32_t place, std::uint32_t other) { met.add(seekers[place], other); });
            met.ask();
            // What one shape has met lies together, as its contacts then do.
            std::sort(found[block].begin(), found[block].end(),
                      [](const PairFound& x, const PairFound& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
        }
    });
    return blocks;
}

}  // namespace

std::size_t findPairs(const PairView& view, StageRunner& runner, bool obstaclesToo) {
    if (view.broadphase.moved.empty()) return 0;
    constexpr std::size_t kFew = 16;     // one of so many
    constexpr std::size_t kNear = 4096;  // view.shapes whose tree a cache holds
    const auto all = static_cast<std::size_t>(view.broadphase.movingTree.proxyCount());
    const bool few = all > kNear && kFew * view.broadphase.moved.size() < all;
    std::size_t blocks = few ? findPairsOfFew(view, runner, obstaclesToo) : findPairsOfMany(view, runner, obstaclesToo);
    auto& found = view.broadphase.search.found;
    bool obstacles = false;
    for (const std::uint32_t shape : view.broadphase.moved) obstacles |= view.shapes[shape].isStaticTree;
    if (obstacles) {
        if (found.size() == blocks) found.emplace_back(view.memory);
        found[blocks].clear();
        PairsMet met(view, found[blocks++]);
        met.addObstacles();
        met.ask();
    }
    return blocks;
}

}  // namespace ragtop
