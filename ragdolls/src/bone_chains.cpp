#include "bone_chains.h"

#include <algorithm>
#include <utility>

namespace ragtop {
namespace {

/// Bones of a part from where it begins to the next part, or to a tip.
struct Chain {
    int part = -1, next = -1;     ///< next: −1 where it ends in a tip
    std::vector<int> bones{};     ///< without the one that the part begins with
    std::vector<float> shares{};  ///< of the whole length from that one, of where each begins
    Vec3 tip{};                   ///< unit vector towards its end, in the axes of the part
};

bool hasTips(BodyRole role) { return role == BodyRole::hand || role == BodyRole::foot || role == BodyRole::head; }

/// Bones within limbs twist beside them, and those at the hips move nothing but skin.
bool bends(const RagdollPart& part, const RagdollPart& next) {
    const bool trunk = part.role == BodyRole::pelvis || part.role == BodyRole::abdomen || part.role == BodyRole::chest;
    return (trunk && next.role != BodyRole::thigh) || part.role == BodyRole::neck;
}

class ChainFinder {
public:
    explicit ChainFinder(const RetargetBody& body) : body_(body) {}

    std::vector<Chain> find() {
        const RagdollDef& def = body_.def;
        for (const RagdollJoint& joint : def.joints)
            if (bends(body_.part(joint.parent), body_.part(joint.child)))
                add(joint.parent, joint.child, body_.part(joint.child).bone);
        std::vector<bool> carries(def.bones.size(), false);
        for (const RagdollBone& bone : def.bones)
            if (bone.parent >= 0) carries[static_cast<std::size_t>(bone.parent)] = true;
        for (std::size_t part = 0; part < def.parts.size(); ++part) {
            if (!hasTips(def.parts[part].role)) continue;
            std::vector<int> tips;
            for (std::size_t i = 0; i < def.bones.size(); ++i)
                if (!carries[i] && def.bones[i].part == static_cast<int>(part)) tips.push_back(static_cast<int>(i));
            // A head and a foot are one way to the crown and to the toes; hair and eyes hang on it.
            const auto away = [&](int bone) {
                return length(def.bones[static_cast<std::size_t>(bone)].inPart.position);
            };
            if (def.parts[part].role != BodyRole::hand && !tips.empty())
                tips = {*std::max_element(tips.begin(), tips.end(), [&](int a, int b) { return away(a) < away(b); })};
            for (const int tip : tips) add(static_cast<int>(part), -1, tip);
        }
        return std::move(chains_);
    }

private:
    void add(int part, int next, int end) {
        const auto& bones = body_.skeleton.bones;
        const int first = body_.part(part).bone;
        std::vector<int> way;
        for (int bone = end; bone >= 0 && bone != first; bone = bones[static_cast<std::size_t>(bone)].parent)
            way.push_back(bone);
        std::reverse(way.begin(), way.end());
        Chain chain{.part = part, .next = next};
        float whole = 0;
        Vec3 at = bones[static_cast<std::size_t>(first)].bind.position;
        for (const int bone : way) {
            const Vec3 there = bones[static_cast<std::size_t>(bone)].bind.position;
            whole += length(there - at);
            at = there;
            if (bone == end && next >= 0) break;
            if (body_.def.bones[static_cast<std::size_t>(bone)].part != part) return;  // hangs on another one
            chain.bones.push_back(bone);
            chain.shares.push_back(whole);
        }
        if (chain.bones.empty() || !(whole > 0)) return;
        for (float& share : chain.shares) share /= whole;
        const Quat axes =
            bones[static_cast<std::size_t>(first)].bind.rotation * body_.axes[static_cast<std::size_t>(first)];
        chain.tip = inverseRotate(axes, normalized(at - bones[static_cast<std::size_t>(first)].bind.position));
        chains_.push_back(std::move(chain));
    }

    const RetargetBody& body_;
    std::vector<Chain> chains_;
};

bool alike(const RagdollPart& a, const RagdollPart& b) { return a.role == b.role && a.side == b.side; }

/// The chain of the other body between the same parts; of those to tips the one that lies nearest.
const Chain* counterpart(const Chain& chain, const RetargetBody& to, const std::vector<Chain>& chains,
                         const RetargetBody& from) {
    const Chain* best = nullptr;
    for (const Chain& each : chains) {
        if (!alike(to.part(chain.part), from.part(each.part)) || (chain.next < 0) != (each.next < 0)) continue;
        if (chain.next >= 0 && !alike(to.part(chain.next), from.part(each.next))) continue;
        if (!best || dot(each.tip, chain.tip) > dot(best->tip, chain.tip)) best = &each;
    }
    return best;
}

ChainBone between(int bone, float share, const Chain& other, int first) {
    int before = first, after = first;
    float from = 0, to = 0;
    for (std::size_t i = 0; i < other.bones.size(); ++i) {
        after = other.bones[i];
        to = other.shares[i];
        if (to >= share) break;
        before = after;
        from = to;
    }
    return {bone, before, after, to > from ? std::min((share - from) / (to - from), 1.0f) : 1.0f};
}

}  // namespace

std::vector<ChainBone> matchChains(const RetargetBody& from, const RetargetBody& to) {
    const std::vector<Chain> theirs = ChainFinder(from).find(), ours = ChainFinder(to).find();
    std::vector<ChainBone> matched;
    std::vector<bool> done(to.def.bones.size(), false);
    for (const Chain& chain : ours) {
        const Chain* other = counterpart(chain, to, theirs, from);
        if (!other) continue;
        for (std::size_t i = 0; i < chain.bones.size(); ++i) {
            const auto bone = static_cast<std::size_t>(chain.bones[i]);
            if (done[bone]) continue;
            done[bone] = true;
            matched.push_back(between(chain.bones[i], chain.shares[i], *other, from.part(other->part).bone));
        }
    }
    std::sort(matched.begin(), matched.end(), [](const ChainBone& a, const ChainBone& b) { return a.bone < b.bone; });
    return matched;
}

}  // namespace ragtop
