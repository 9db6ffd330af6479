// Plans the elimination of trees: the order of links, parents before children, which of them form ball chains, and
// which trees have the same topology and precision, so that one group of lanes eliminates them side by side.

#include "direct/tree_plan.h"

#include <algorithm>
#include <cstring>

namespace ragtop::direct {

void markBallChains(TreeLink* links, std::size_t count) {
    for (std::size_t l = 0; l < count; ++l) links[l].below = links[l].joint == TreeJoint::ball ? -1 : kNoBallChain;
    for (std::size_t l = 0; l < count; ++l) {
        if (links[l].parent < 0) continue;
        std::int32_t& below = links[static_cast<std::size_t>(links[l].parent)].below;
        below = below == -1 && links[l].joint == TreeJoint::ball ? static_cast<std::int32_t>(l) : kNoBallChain;
    }
}

TreePlan::TreePlan(std::pmr::memory_resource* memory)
    : trees_(memory),
      links_(memory),
      states_(memory),
      joints_(memory),
      order_(memory),
      groups_(memory),
      independentGroups_(memory),
      sharedGroups_(memory),
      members_(memory),
      laneStates_(memory),
      laneAnchors_(memory),
      rows_(memory),
      impulses_(memory),
      memory_(memory) {}

void TreePlan::clear() {
    trees_.clear();
    links_.clear();
    states_.clear();
    joints_.clear();
    groups_.clear();
    independentGroups_.clear();
    sharedGroups_.clear();
    grouped_ = false;
    built_ = 0;
}

void TreePlan::push(const TreeLink& link, std::uint32_t state, std::uint32_t joint) {
    links_.push(link);
    states_.push(state);
    joints_.push(joint);
}

void TreePlan::keep(std::uint32_t anchor, std::uint32_t owner, bool doublePrecision) {
    const auto end = static_cast<std::uint32_t>(links_.size());
    markBallChains(links_.data() + built_, end - built_);
    trees_.push({built_, end - built_, anchor, owner, doublePrecision, 1, false});
    built_ = end;
}

void TreePlan::drop() {
    links_.resizeForOverwrite(built_);
    states_.resizeForOverwrite(built_);
    joints_.resizeForOverwrite(built_);
}

bool TreePlan::setPace(std::size_t tree, int stepFactor, bool independent) {
    Tree& at = trees_[tree];
    const bool changes = at.stepFactor != stepFactor || at.independent != independent;
    at.stepFactor = static_cast<std::uint8_t>(stepFactor);
    at.independent = independent;
    return changes;
}

/// By precision and topology.
int TreePlan::compareShapes(const Tree& a, const Tree& b) const {
    if (a.doublePrecision != b.doublePrecision) return a.doublePrecision ? 1 : -1;
    if (a.count != b.count) return a.count < b.count ? -1 : 1;
    return std::memcmp(links_.data() + a.first, links_.data() + b.first, a.count * sizeof(TreeLink));
}
/// By all that must be equal in a group.
int TreePlan::compare(const Tree& a, const Tree& b) const {
    const int way = compareShapes(a, b);
    if (way != 0) return way;
    return a.stepFactor != b.stepFactor ? a.stepFactor - b.stepFactor : int{b.independent} - int{a.independent};
}

/// The next place where vectors of every width may lie: groups of different widths follow one another.
constexpr std::size_t onLine(std::size_t bytes) { return (bytes + 63) & ~std::size_t{63}; }

/// Trees of one shape fill their groups, but for one per step factor, and one of those that are not independent.
void TreePlan::makeRoom(const TreeTables& tables) {
    const TreeTables& widest = tables.wider ? *tables.wider : tables;
    std::size_t rows = 0, lanes = 0, bytes = 0, groups = 0;
    for (std::size_t i = 0, end = 0; i < order_.size(); i = end) {
        const Tree& first = trees_[order_[i]];
        while (end < order_.size() && compareShapes(first, trees_[order_[end]]) == 0) ++end;
        const TreeKernels& kernels = first.doublePrecision ? widest.doublePrecision : widest.single;
        const auto width = static_cast<std::size_t>(kernels.lanes);
        const std::size_t most = (end - i) / width + (first.doublePrecision ? kStepFactors : 1) + 1;
        groups += most;
        lanes += most * width;
        rows += most * width * first.count;
        bytes += most * onLine(first.count * kernels.linkBytes);
    }
    laneStates_.reserve(rows), laneAnchors_.reserve(lanes);
    rows_.reserve(rows), impulses_.reserve(rows);
    memory_.reserve(bytes), groups_.reserve(groups);
    independentGroups_.reserve(groups), sharedGroups_.reserve(groups), members_.reserve(states_.size());
}

void TreePlan::group(const TreeTables& tables) {
    grouped_ = true;
    groups_.clear();
    independentGroups_.clear();
    sharedGroups_.clear();
    members_.clear();
    const auto count = static_cast<std::uint32_t>(trees_.size());
    order_.resizeForOverwrite(count);
    for (std::uint32_t i = 0; i < count; ++i) order_[i] = i;
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int way = compare(trees_[a], trees_[b]);
        return way != 0 ? way < 0 : a < b;
    });
    makeRoom(tables);
    std::size_t rows = 0, lanes = 0, bytes = 0;
    for (std::uint32_t i = 0; i < count;) {
        Group group;
        const Tree& first = trees_[order_[i]];
        const auto kernelsOf = [&](const TreeTables& from) {
            return first.doublePrecision ? &from.doublePrecision : &from.single;
        };
        group.kernels = kernelsOf(tables);
        const std::uint32_t beyond = i + static_cast<std::uint32_t>(group.kernels->lanes);
        if (tables.wider && beyond < count && compare(first, trees_[order_[beyond]]) == 0)
            group.kernels = kernelsOf(*tables.wider);
        group.firstTree = i;
        group.firstRow = rows;
        group.lanes.linkCount = static_cast<int>(first.count);
        while (i < count && group.lanes.used < group.kernels->lanes && compare(first, trees_[order_[i]]) == 0)
            ++group.lanes.used, ++i;
        rows += first.count * static_cast<std::size_t>(group.kernels->lanes);
        lanes += static_cast<std::size_t>(group.kernels->lanes);
        bytes = onLine(bytes) + first.count * group.kernels->linkBytes;
        groups_.push(group);
    }
    laneStates_.resizeForOverwrite(rows);
    laneAnchors_.resizeForOverwrite(lanes);
    rows_.resizeForOverwrite(rows);
    impulses_.resizeForOverwrite(rows);
    memory_.resizeForOverwrite(bytes);
    lanes = bytes = 0;
    for (Group& group : groups_) {
        bytes = onLine(bytes);
        group.lanes.anchors = laneAnchors_.data() + lanes;
        group.lanes.memory = memory_.data() + bytes;
        lanes += static_cast<std::size_t>(group.kernels->lanes);
        bytes += static_cast<std::size_t>(group.lanes.linkCount) * group.kernels->linkBytes;
        layOut(group);
        (treeOf(group, 0).independent ? independentGroups_ : sharedGroups_)
            .push(static_cast<std::uint32_t>(&group - groups_.data()));
    }
}

void TreePlan::layOut(Group& group) {
    const Tree& first = treeOf(group, 0);
    group.lanes.links = links_.data() + first.first;
    group.lanes.states = laneStates_.data() + group.firstRow;
    group.lanes.joints = rows_.data() + group.firstRow;
    group.lanes.impulses = impulses_.data() + group.firstRow;
    group.firstMember = static_cast<std::uint32_t>(members_.size());
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const Tree& tree = treeOf(group, lane);
        for (std::uint32_t i = 0; i < tree.count; ++i) members_.push(states_[tree.first + i]);
    }
    group.memberCount = static_cast<std::uint32_t>(members_.size()) - group.firstMember;
    std::uint32_t* anchors = laneAnchors_.data() + (group.lanes.anchors - laneAnchors_.data());
    for (int lane = 0; lane < group.kernels->lanes; ++lane) {
        const Tree& tree = treeOf(group, lane < group.lanes.used ? lane : 0);
        anchors[lane] = tree.anchor;
        for (int l = 0; l < group.lanes.linkCount; ++l)
            laneStates_[place(group, l, lane)] = states_[tree.first + static_cast<std::uint32_t>(l)];
    }
}

void TreePlan::repeatRows(const Group& group) {
    for (int lane = group.lanes.used; lane < group.kernels->lanes; ++lane)
        for (int l = 0; l < group.lanes.linkCount; ++l) rows_[place(group, l, lane)] = rows_[place(group, l, 0)];
}

}  // namespace ragtop::direct
