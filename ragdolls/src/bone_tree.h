#pragma once

#include <vector>

#include "ragtop/skeleton.h"

namespace ragtop {

/// The branching of a skeleton, with lengths.
struct BoneTree {
    std::vector<std::vector<int>> children;
    std::vector<float> reach;  ///< m, along bones from each bone to its farthest descendant
    std::vector<int> tip;      ///< that descendant
    std::vector<int> depth;

    explicit BoneTree(const Skeleton& skeleton);

    /// From a bone to its farthest descendant.
    std::vector<int> chain(const Skeleton& skeleton, int bone) const;
};

bool isWithin(const Skeleton& skeleton, int bone, int ancestor);
int commonAncestor(const Skeleton& skeleton, const BoneTree& tree, int a, int b);

/// Which joint a name speaks of. Names never decide alone: they weigh against the proportions of the chain.
enum class NameHint : unsigned char { none, hip, knee, ankle, shoulder, elbow, wrist, head };
NameHint hintOf(const std::string& name);
/// −1 left, 1 right, 0 unknown.
int sideHintOf(const std::string& name);

}  // namespace ragtop
