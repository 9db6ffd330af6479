#pragma once

#include <vector>

#include "bone_names.h"
#include "ragtop/skeleton.h"

namespace ragtop {

/// The branching of a skeleton, with lengths, names and skin.
struct BoneTree {
    std::vector<std::vector<int>> children;
    std::vector<BoneName> names;
    std::vector<bool> loose;   ///< hangs on the body, but is no part of it: hair, cloth, things carried, controls
    std::vector<float> reach;  ///< m, along bones from each bone to its farthest tip, skin included, loose ones apart
    std::vector<int> tip;      ///< the bone at that tip
    std::vector<Vec3> end;     ///< of a bone without children: as far as its skin goes; else its own place
    std::vector<std::size_t> skin;  ///< vertices of each bone and all below it
    std::vector<int> depth;
    /// What names on the way from each bone to its tip say of a head: 1 for it, below 0 where a tail or a wing comes
    /// first.
    std::vector<float> headSaid;
    float size = 0;  ///< m, the longest way along bones from one tip to another

    explicit BoneTree(const Skeleton& skeleton);

    const Vec3& at(int bone) const { return skeleton_->bones[static_cast<std::size_t>(bone)].bind.position; }
    int parent(int bone) const { return skeleton_->bones[static_cast<std::size_t>(bone)].parent; }
    int count() const { return static_cast<int>(children.size()); }
    /// m, of a bone beyond its joint where it has no children; 0 where there is no skin to tell.
    float beyond(int bone) const;

    bool isWithin(int bone, int ancestor) const;
    int commonAncestor(int a, int b) const;
    /// From `from`, which is an ancestor, down to `to`, both included.
    std::vector<int> path(int from, int to) const;
    /// From a bone to its farthest descendant that is not loose.
    std::vector<int> chain(int bone) const { return path(bone, tip[static_cast<std::size_t>(bone)]); }

private:
    void order();
    void findLoose();
    void findEnds();
    void measure();

    const Skeleton* skeleton_;
    std::vector<int> enter_, leave_;  ///< places in a walk of the tree that goes down first
};

}  // namespace ragtop
