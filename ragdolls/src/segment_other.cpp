#include "segments.h"

namespace ragtop {
namespace {

/// The farthest child, or as far as the skin goes of a bone that has none.
Vec3 farEnd(const BoneTree& tree, int bone) {
    Vec3 end = tree.end[static_cast<std::size_t>(bone)];
    for (const int child : tree.children[static_cast<std::size_t>(bone)])
        if (lengthSquared(tree.at(child) - tree.at(bone)) > lengthSquared(end - tree.at(bone))) end = tree.at(child);
    return end;
}

}  // namespace

void segmentOther(const BoneTree& tree, Anatomy& anatomy) {
    constexpr std::size_t kMost = 24;
    const auto begins = [&](const std::vector<int>& segmentOf, int bone, float least) {
        const int carrier = segmentOf[static_cast<std::size_t>(tree.parent(bone))];
        const Vec3& start = tree.at(anatomy.segments[static_cast<std::size_t>(carrier)].bone);
        return length(farEnd(tree, bone) - tree.at(bone)) >= least && length(tree.at(bone) - start) >= 0.5f * least;
    };
    for (float bar = 0.06f;; bar *= 1.25f) {
        anatomy.segments.clear();
        std::vector<int> segmentOf(tree.children.size(), 0);
        for (int bone = 0; bone < tree.count() && anatomy.segments.size() <= kMost; ++bone) {
            const bool isFirst = bone == 0 || (!tree.loose[static_cast<std::size_t>(bone)] && tree.reach[0] > 0 &&
                                               begins(segmentOf, bone, bar * tree.reach[0]));
            int& segment = segmentOf[static_cast<std::size_t>(bone)];
            segment = bone == 0 ? -1 : segmentOf[static_cast<std::size_t>(tree.parent(bone))];
            if (!isFirst) continue;
            anatomy.segments.push_back({BodyRole::other, BodySide::middle, bone, segment, farEnd(tree, bone), 0});
            segment = static_cast<int>(anatomy.segments.size()) - 1;
        }
        if (anatomy.segments.size() <= kMost) return;
    }
}

}  // namespace ragtop
