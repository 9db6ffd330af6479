#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>

#include "base/aligned_array.h"
#include "direct/tree_layout.h"

namespace ragtop::direct {

/// Trees of joints and how they share lanes: those of equal topology side by side. Lanes never mix, so that no result
/// depends on the trees beside it.
class TreePlan {
public:
    static constexpr std::size_t kStepFactors = 3;  ///< 1, 2 and 4 substeps
    static constexpr int kLongestFactor = 1 << (kStepFactors - 1);

    /// A tree; its links, joints and bodies are at [first, first + count) of their arrays.
    struct Tree {
        std::uint32_t first = 0, count = 0;
        std::uint32_t anchor = 0;  ///< state of what the root hangs from
        std::uint32_t owner = 0;   ///< the caller's
        bool doublePrecision = false;  ///< in double precision
        std::uint8_t stepFactor = 1;   ///< substeps of the world that it takes at once
        bool independent = false;      ///< goes through its step without the world's substeps
    };
    struct Group {
        TreeGroup lanes;
        std::uint32_t firstTree = 0;  ///< in the order of trees
        std::uint32_t firstMember = 0, memberCount = 0;
        std::size_t firstRow = 0;
        const TreeKernels* kernels = nullptr;
    };

    explicit TreePlan(std::pmr::memory_resource* memory);

    void clear();
    bool empty() const { return trees_.empty(); }
    /// Links of the tree that is being built: pushed one by one, then kept as a tree or dropped.
    void push(const TreeLink& link, std::uint32_t state, std::uint32_t joint);
    /// Joint of a link that has been pushed.
    std::uint32_t builtJoint(std::size_t i) const { return joints_[built_ + i]; }
    void keep(std::uint32_t anchor, std::uint32_t owner, bool doublePrecision);
    void drop();
    /// Groups what has been kept, and makes room for it however step factors change.
    void group(const TreeTables& tables);
    bool isGrouped() const { return grouped_; }

    std::size_t treeCount() const { return trees_.size(); }
    const Tree& treeAt(std::size_t index) const { return trees_[index]; }
    /// To be grouped again. True when that is another pace.
    bool setPace(std::size_t tree, int stepFactor, bool independent);
    int stepFactorOf(const Group& group) const { return treeOf(group, 0).stepFactor; }

    /// Groups of trees that are independent, and of the others.
    std::size_t groupCount(bool independent) const { return (independent ? independentGroups_ : sharedGroups_).size(); }
    Group& groupAt(bool independent, std::size_t index) {
        return groups_[(independent ? independentGroups_ : sharedGroups_)[index]];
    }
    /// States of the bodies of a group, each once.
    std::span<const std::uint32_t> membersOf(const Group& group) const {
        return {members_.data() + group.firstMember, group.memberCount};
    }
    const Tree& treeOf(const Group& group, int lane) const {
        return trees_[order_[group.firstTree + static_cast<std::uint32_t>(lane)]];
    }
    std::uint32_t jointOf(const Tree& tree, int link) const {
        return joints_[tree.first + static_cast<std::uint32_t>(link)];
    }
    const TreeLink& linkOf(const Tree& tree, int link) const {
        return links_[tree.first + static_cast<std::uint32_t>(link)];
    }
    TreeJointRow& row(const Group& group, int link, int lane) { return rows_[place(group, link, lane)]; }
    const TreeImpulse& impulse(const Group& group, int link, int lane) const {
        return impulses_[place(group, link, lane)];
    }
    /// Lanes without a tree take the rows of the first.
    void repeatRows(const Group& group);

private:
    static std::size_t place(const Group& group, int link, int lane) {
        return group.firstRow + static_cast<std::size_t>(link * group.kernels->lanes + lane);
    }
    int compareShapes(const Tree& a, const Tree& b) const;
    int compare(const Tree& a, const Tree& b) const;
    void makeRoom(const TreeTables& tables);
    void layOut(Group& group);

    AlignedArray<Tree> trees_;
    AlignedArray<TreeLink> links_;
    AlignedArray<std::uint32_t> states_, joints_, order_;
    AlignedArray<Group> groups_;
    AlignedArray<std::uint32_t> independentGroups_, sharedGroups_, members_;
    bool grouped_ = false;     ///< since it was cleared
    std::uint32_t built_ = 0;  ///< first link of the tree that is being built
    // Of the groups.
    AlignedArray<std::uint32_t> laneStates_, laneAnchors_;
    AlignedArray<TreeJointRow> rows_;
    AlignedArray<TreeImpulse> impulses_;
    AlignedArray<std::byte> memory_;
};

}  // namespace ragtop::direct
