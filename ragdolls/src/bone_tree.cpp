#include "bone_tree.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace ragtop {
namespace {

std::string lowered(const std::string& name) {
    std::string text = name;
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

bool has(std::string_view text, std::string_view word) { return text.find(word) != std::string_view::npos; }

}  // namespace

BoneTree::BoneTree(const Skeleton& skeleton)
    : children(skeleton.bones.size()),
      reach(skeleton.bones.size(), 0.0f),
      tip(skeleton.bones.size()),
      depth(skeleton.bones.size(), 0) {
    const int count = static_cast<int>(skeleton.bones.size());
    for (int i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        tip[at] = i;
        const int parent = skeleton.bones[at].parent;
        if (parent < 0) continue;
        children[static_cast<std::size_t>(parent)].push_back(i);
        depth[at] = depth[static_cast<std::size_t>(parent)] + 1;
    }
    for (int i = count - 1; i > 0; --i) {
        const auto at = static_cast<std::size_t>(i);
        const auto parent = static_cast<std::size_t>(skeleton.bones[at].parent);
        const float through =
            reach[at] + length(skeleton.bones[at].bind.position - skeleton.bones[parent].bind.position);
        if (through > reach[parent]) {
            reach[parent] = through;
            tip[parent] = tip[at];
        }
    }
}

std::vector<int> BoneTree::chain(const Skeleton& skeleton, int bone) const {
    std::vector<int> result;
    for (int at = tip[static_cast<std::size_t>(bone)]; at != bone;) {
        result.push_back(at);
        at = skeleton.bones[static_cast<std::size_t>(at)].parent;
    }
    result.push_back(bone);
    std::reverse(result.begin(), result.end());
    return result;
}

bool isWithin(const Skeleton& skeleton, int bone, int ancestor) {
    while (bone > ancestor) bone = skeleton.bones[static_cast<std::size_t>(bone)].parent;
    return bone == ancestor;
}

int commonAncestor(const Skeleton& skeleton, const BoneTree& tree, int a, int b) {
    while (a != b) {
        int& deeper = tree.depth[static_cast<std::size_t>(a)] > tree.depth[static_cast<std::size_t>(b)] ? a : b;
        deeper = skeleton.bones[static_cast<std::size_t>(deeper)].parent;
    }
    return a;
}

NameHint hintOf(const std::string& name) {
    const std::string text = lowered(name);
    // Twist bones carry the name of the segment whose middle they are in.
    if (has(text, "twist") || has(text, "roll")) return NameHint::none;
    static constexpr std::array<std::pair<std::string_view, NameHint>, 29> kWords{{
        {"forearm", NameHint::elbow},
        {"lowerarm", NameHint::elbow},
        {"lower_arm", NameHint::elbow},
        {"loarm", NameHint::elbow},
        {"elbow", NameHint::elbow},
        {"hand", NameHint::wrist},
        {"wrist", NameHint::wrist},
        {"upperarm", NameHint::shoulder},
        {"upper_arm", NameHint::shoulder},
        {"uparm", NameHint::shoulder},
        {"humerus", NameHint::shoulder},
        {"radius", NameHint::elbow},
        {"thigh", NameHint::hip},
        {"upleg", NameHint::hip},
        {"upperleg", NameHint::hip},
        {"upper_leg", NameHint::hip},
        {"femur", NameHint::hip},
        {"calf", NameHint::knee},
        {"shin", NameHint::knee},
        {"shank", NameHint::knee},
        {"knee", NameHint::knee},
        {"lowerleg", NameHint::knee},
        {"lower_leg", NameHint::knee},
        {"tibia", NameHint::knee},
        {"foot", NameHint::ankle},
        {"ankle", NameHint::ankle},
        {"head", NameHint::head},
        // What is left of arms and legs by now: "LeftArm" next to "LeftForeArm", "LeftLeg" next to "LeftUpLeg".
        {"arm", NameHint::shoulder},
        {"leg", NameHint::knee},
    }};
    for (const auto& [word, hint] : kWords)
        if (has(text, word)) return hint;
    return NameHint::none;
}

int sideHintOf(const std::string& name) {
    const std::string text = lowered(name);
    if (has(text, "left")) return -1;
    if (has(text, "right")) return 1;
    const auto separated = [&](char side) {
        const auto isLetter = [](char c) { return c >= 'a' && c <= 'z'; };
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] != side) continue;
            const bool before = i == 0 || !isLetter(text[i - 1]);
            const bool after = i + 1 == text.size() || !isLetter(text[i + 1]);
            if (before && after) return true;
        }
        return false;
    };
    return separated('l') ? -1 : separated('r') ? 1 : 0;
}

}  // namespace ragtop
