#include "bone_tree.h"

#include <algorithm>

namespace ragtop {

BoneTree::BoneTree(const Skeleton& skeleton)
    : children(skeleton.bones.size()),
      loose(skeleton.bones.size(), false),
      reach(skeleton.bones.size(), 0.0f),
      tip(skeleton.bones.size()),
      end(skeleton.bones.size()),
      skin(skeleton.bones.size(), 0),
      depth(skeleton.bones.size(), 0),
      headSaid(skeleton.bones.size(), 0.0f),
      skeleton_(&skeleton),
      enter_(skeleton.bones.size(), 0),
      leave_(skeleton.bones.size(), 0) {
    for (int i = 0; i < count(); ++i) {
        names.push_back(readName(skeleton.bones[static_cast<std::size_t>(i)].name));
        if (parent(i) < 0) continue;
        children[static_cast<std::size_t>(parent(i))].push_back(i);
        depth[static_cast<std::size_t>(i)] = depth[static_cast<std::size_t>(parent(i))] + 1;
    }
    order();
    findLoose();
    findEnds();
    measure();
}

void BoneTree::order() {
    std::vector<int> below(children.size(), 1);
    for (int i = count() - 1; i > 0; --i)
        below[static_cast<std::size_t>(parent(i))] += below[static_cast<std::size_t>(i)];
    for (int i = 0; i < count(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        leave_[at] = enter_[at] + below[at];
        int next = enter_[at] + 1;
        for (const int child : children[at]) {
            enter_[static_cast<std::size_t>(child)] = next;
            next += below[static_cast<std::size_t>(child)];
        }
    }
}

/// What a control, a cape or a sword is called is none of the body, with all that hangs on it, unless joints of the
/// body do: a whole rig may be below a bone called "control".
void BoneTree::findLoose() {
    std::vector<bool> hasJoints(children.size(), false);
    for (int i = count() - 1; i >= 0; --i) {
        const auto at = static_cast<std::size_t>(i);
        if (names[at].hint != NameHint::none) hasJoints[at] = true;
        if (parent(i) >= 0 && hasJoints[at]) hasJoints[static_cast<std::size_t>(parent(i))] = true;
    }
    for (int i = 1; i < count(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        const bool most = 2 * (leave_[at] - enter_[at]) > count();
        loose[at] = loose[static_cast<std::size_t>(parent(i))] || (names[at].loose && !hasJoints[at] && !most);
    }
}

/// The vertex that a twentieth of the others are farther than: a few that follow a bone by mistake do not count.
void BoneTree::findEnds() {
    std::vector<std::pair<float, std::size_t>> far;
    for (std::size_t i = 0; i < children.size(); ++i) {
        end[i] = at(static_cast<int>(i));
        if (skeleton_->skin.empty()) continue;
        const std::vector<Vec3>& vertices = skeleton_->skin[i];
        skin[i] = vertices.size();
        if (!children[i].empty() || vertices.empty()) continue;
        far.clear();
        for (std::size_t k = 0; k < vertices.size(); ++k) far.emplace_back(lengthSquared(vertices[k] - end[i]), k);
        const auto rank = far.begin() + static_cast<std::ptrdiff_t>((far.size() - 1) * 19 / 20);
        std::nth_element(far.begin(), rank, far.end());
        end[i] = vertices[rank->second];
    }
}

void BoneTree::measure() {
    for (int i = count() - 1; i >= 0; --i) {
        const auto at = static_cast<std::size_t>(i);
        if (reach[at] == 0) {
            tip[at] = i;
            reach[at] = beyond(i);
        }
        const NameHint hint = names[at].hint;
        if (hint == NameHint::head || hint == NameHint::neck) headSaid[at] = 1;  // hair on it may be called a tail
        if (hint == NameHint::tail || hint == NameHint::wing) headSaid[at] -= 3;
        size = std::max(size, reach[at]);
        if (i == 0 || loose[at]) continue;
        const auto above = static_cast<std::size_t>(parent(i));
        skin[above] += skin[at];
        const float through = reach[at] + length(this->at(i) - this->at(parent(i)));
        // Two ways from one bone make one from tip to tip.
        if (reach[above] > 0) size = std::max(size, reach[above] + through);
        if (through > reach[above]) {
            reach[above] = through;
            tip[above] = tip[at];
            headSaid[above] = headSaid[at];
        }
    }
}

float BoneTree::beyond(int bone) const { return length(end[static_cast<std::size_t>(bone)] - at(bone)); }

bool BoneTree::isWithin(int bone, int ancestor) const {
    const int place = enter_[static_cast<std::size_t>(bone)];
    return place >= enter_[static_cast<std::size_t>(ancestor)] && place < leave_[static_cast<std::size_t>(ancestor)];
}

int BoneTree::commonAncestor(int a, int b) const {
    while (a != b) {
        int& deeper = depth[static_cast<std::size_t>(a)] > depth[static_cast<std::size_t>(b)] ? a : b;
        deeper = parent(deeper);
    }
    return a;
}

std::vector<int> BoneTree::path(int from, int to) const {
    std::vector<int> result{to};
    while (result.back() != from) result.push_back(parent(result.back()));
    std::reverse(result.begin(), result.end());
    return result;
}

}  // namespace ragtop
