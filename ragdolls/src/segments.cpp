#include "segments.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ragtop {
namespace {

constexpr float kSamePlace = 0.06f;  ///< of the trunk: bones this near to each other are one joint
constexpr float kPelvisNear = 0.1f;  ///< of the trunk: this much farther from the hips than the nearest bone will do
constexpr float kLongNeck = 0.5f;    ///< of the trunk: a neck that is a part of its own
constexpr std::size_t kTailParts = 4;

bool speaksOf(NameHint hint, BodyRole role) {
    switch (role) {
        case BodyRole::pelvis:
            return hint == NameHint::pelvis;
        case BodyRole::abdomen:
            return hint == NameHint::spine;
        case BodyRole::chest:
            return hint == NameHint::chest || hint == NameHint::spine;
        case BodyRole::head:
            return hint == NameHint::head || hint == NameHint::neck;
        case BodyRole::neck:
            return hint == NameHint::neck;
        case BodyRole::upperArm:
            return hint == NameHint::shoulder || hint == NameHint::arm || hint == NameHint::shoulderOrClavicle;
        case BodyRole::forearm:
            return hint == NameHint::elbow || hint == NameHint::arm;
        case BodyRole::hand:
            return hint == NameHint::wrist || hint == NameHint::finger;
        case BodyRole::thigh:
            return hint == NameHint::hip || hint == NameHint::leg;
        case BodyRole::shank:
            return hint == NameHint::knee || hint == NameHint::leg;
        case BodyRole::foot:
            return hint == NameHint::ankle || hint == NameHint::toe;
        case BodyRole::tail:
            return hint == NameHint::tail;
        case BodyRole::wing:
            return hint == NameHint::wing;
        case BodyRole::other:
            break;
    }
    return false;
}

class Segmenter {
public:
    Segmenter(const Skeleton& skeleton, const BoneTree& tree, const KnownRoles& known, const PlanChoice& choice,
              Anatomy& anatomy)
        : skeleton_(skeleton), tree_(tree), known_(known), choice_(choice), anatomy_(anatomy) {}

    void run() {
        addTrunk();
        addHead();
        addPair(choice_.legs, BodyRole::thigh, pelvis_);
        addPair(choice_.arms, choice_.plan == BodyPlan::hexapod ? BodyRole::thigh : BodyRole::upperArm, chest_);
        for (const LimbPair& pair : choice_.more) addMore(pair);
        addTail();
    }

private:
    /// How sure a role is: the mean of the signs there are.
    float confidence(BodyRole role, int bone, std::initializer_list<float> signs) const {
        if (known_.of[static_cast<std::size_t>(bone)]) return 1;
        float sum = choice_.confidence, count = 1;
        for (const float sign : signs) {
            sum += sign;
            ++count;
        }
        const NameHint hint = tree_.names[static_cast<std::size_t>(bone)].hint;
        if (hint != NameHint::none) {
            sum += speaksOf(hint, role) ? 1.0f : 0.0f;
            ++count;
        }
        return sum / count;
    }

    int add(BodyRole role, BodySide side, int bone, int parent, const Vec3& end, float sure) {
        anatomy_.segments.push_back({role, side, bone, parent, end, sure});
        return static_cast<int>(anatomy_.segments.size()) - 1;
    }
    int addMiddle(BodyRole role, int bone, int parent) {
        return add(role, BodySide::middle, bone, parent, tree_.at(bone), confidence(role, bone, {}));
    }

    int knownAs(const std::vector<int>& bones, BodyRole role) const {
        for (std::size_t i = 0; i < bones.size(); ++i) {
            const auto& known = known_.of[static_cast<std::size_t>(bones[i])];
            if (known && known->role == role) return static_cast<int>(i);
        }
        return -1;
    }

    /// The bone of the trunk that the hips are at. The root of the skeleton will do where it is hardly farther, and
    /// what is called so before it.
    int findPelvis(const std::vector<int>& spine, int root) const {
        if (const int known = knownAs(spine, BodyRole::pelvis); known >= 0) return known;
        const Vec3 hips = choice_.legs.start();
        const float trunk = length(choice_.arms.start() - hips);
        const auto away = [&](int i) { return length(tree_.at(spine[static_cast<std::size_t>(i)]) - hips); };
        int nearest = 0;
        const int count = static_cast<int>(spine.size());
        for (int i = 1; i < count; ++i)
            if (away(i) < away(nearest)) nearest = i;
        const float will = away(nearest) + kPelvisNear * trunk;
        const auto likely = [&](int i, bool named) {
            const NameHint hint = tree_.names[static_cast<std::size_t>(spine[static_cast<std::size_t>(i)])].hint;
            return away(i) <= will && (!named || hint == NameHint::pelvis);
        };
        if (likely(root, true)) return root;
        for (int i = 0; i < count; ++i)
            if (likely(i, true)) return i;
        return likely(root, false) ? root : nearest;
    }

    /// Pelvis, abdomen and chest share the bones from hips to shoulders; the chest begins at the joint nearest to the
    /// middle between the lowest one of the spine and the neck. With fewer bones parts are left out.
    void addTrunk() {
        const int top = tree_.commonAncestor(choice_.legs.attach, choice_.arms.attach);
        std::vector<int> spine = tree_.path(top, choice_.legs.attach);
        std::reverse(spine.begin(), spine.end());
        const int root = static_cast<int>(spine.size()) - 1;
        const std::vector<int> upper = tree_.path(top, choice_.arms.attach);
        spine.insert(spine.end(), upper.begin() + 1, upper.end());
        std::vector<float> along{0};
        for (std::size_t i = 1; i < spine.size(); ++i)
            along.push_back(along.back() + length(tree_.at(spine[i]) - tree_.at(spine[i - 1])));
        const Vec3 neck = choice_.head >= 0 ? tree_.at(choice_.head) : choice_.arms.start();
        const float last = along.back() + length(neck - tree_.at(spine.back()));

        const int pelvis = findPelvis(spine, root), count = static_cast<int>(spine.size());
        const auto at = [&](int i) { return along[static_cast<std::size_t>(i)]; };
        int abdomen = knownAs(spine, BodyRole::abdomen), chest = knownAs(spine, BodyRole::chest);
        int first = pelvis + 1;
        while (first + 1 < count && at(first) - at(pelvis) < kSamePlace * (last - at(pelvis))) ++first;
        if (abdomen < 0 && first + 1 < count && chest != first) abdomen = first;
        if (chest < 0 && first < count) {
            chest = abdomen >= 0 ? abdomen + 1 : first;
            const float middle = 0.5f * (at(first) + last);
            for (int i = chest + 1; i < count; ++i)
                if (std::abs(at(i) - middle) < std::abs(at(chest) - middle)) chest = i;
            if (chest >= count) chest = -1;
        }
        joinTrunk(spine, {pelvis, abdomen, chest}, root);
    }

    /// The part that the root of the skeleton belongs to carries the others, each the next one.
    void joinTrunk(const std::vector<int>& spine, std::array<int, 3> place, int root) {
        constexpr std::array<BodyRole, 3> kRoles{BodyRole::pelvis, BodyRole::abdomen, BodyRole::chest};
        std::size_t first = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (place[k] >= 0 && place[k] <= root) first = k;
        if (place[first] < root) place[first] = root;
        std::array<int, 3> index{-1, -1, -1};
        const auto bone = [&](std::size_t k) { return spine[static_cast<std::size_t>(place[k])]; };
        index[first] = addMiddle(kRoles[first], bone(first), -1);
        int carrier = index[first];
        for (std::size_t k = first; k-- > 0;)
            if (place[k] >= 0) carrier = index[k] = addMiddle(kRoles[k], bone(k), carrier);
        carrier = index[first];
        for (std::size_t k = first + 1; k < 3; ++k)
            if (place[k] >= 0) carrier = index[k] = addMiddle(kRoles[k], bone(k), carrier);
        pelvis_ = index[0] >= 0 ? index[0] : 0;
        chest_ = index[2] >= 0 ? index[2] : index[1] >= 0 ? index[1] : 0;
        // A part ends where the next one towards the head begins.
        for (std::size_t k = 0; k < 3; ++k) {
            if (index[k] < 0) continue;
            Vec3 end = choice_.head >= 0 ? tree_.at(choice_.head) : choice_.arms.start();
            for (std::size_t next = 3; next-- > k + 1;)
                if (index[next] >= 0) end = tree_.at(bone(next));
            anatomy_.segments[static_cast<std::size_t>(index[k])].end = end;
        }
    }

    void addHead() {
        const int first = choice_.head;
        if (first < 0) return;
        int head = first, carrier = carrierOf(tree_.parent(first));
        const std::vector<int> chain = tree_.chain(first);
        const float trunk = length(choice_.arms.start() - choice_.legs.start());
        const float reach = tree_.reach[static_cast<std::size_t>(first)];
        if (choice_.plan != BodyPlan::human && chain.size() > 2 && reach > kLongNeck * trunk) {
            for (const int bone : chain) {
                const bool named = tree_.names[static_cast<std::size_t>(bone)].hint == NameHint::head;
                const bool far = tree_.reach[static_cast<std::size_t>(bone)] < 0.4f * reach;
                if (bone == first || !(named || far)) continue;
                head = bone;
                break;
            }
        }
        if (head != first) {
            carrier = addMiddle(BodyRole::neck, first, carrier);
            anatomy_.segments.back().end = tree_.at(head);
        }
        addMiddle(BodyRole::head, head, carrier);
        const Vec3 tip = tree_.end[static_cast<std::size_t>(tree_.tip[static_cast<std::size_t>(head)])];
        anatomy_.segments.back().end =
            choice_.plan == BodyPlan::human ? tree_.at(head) + highestAbove(head) * anatomy_.up : tip;
    }

    float highestAbove(int head) const {
        float highest = 0;
        for (int bone = head; bone < tree_.count(); ++bone) {
            if (!tree_.isWithin(bone, head) || tree_.loose[static_cast<std::size_t>(bone)]) continue;
            highest = std::max(highest, dot(tree_.at(bone) - tree_.at(head), anatomy_.up));
            if (skeleton_.skin.empty()) continue;
            for (const Vec3& vertex : skeleton_.skin[static_cast<std::size_t>(bone)])
                highest = std::max(highest, dot(vertex - tree_.at(head), anatomy_.up));
        }
        return highest;
    }

    /// The segment that a bone belongs to: that of the nearest one above it that begins one.
    int carrierOf(int bone) const {
        for (; bone >= 0; bone = tree_.parent(bone))
            for (std::size_t i = 0; i < anatomy_.segments.size(); ++i)
                if (anatomy_.segments[i].bone == bone) return static_cast<int>(i);
        return 0;
    }

    BodySide sideOf(const LimbPair& pair, std::size_t which) const {
        const Limb& limb = *pair.limb[which];
        for (const int bone : limb.joint)
            if (bone >= 0 && known_.of[static_cast<std::size_t>(bone)] &&
                known_.of[static_cast<std::size_t>(bone)]->side != BodySide::middle)
                return known_.of[static_cast<std::size_t>(bone)]->side;
        Vec3 other = tree_.at(pair.attach);
        if (pair.limb[1]) other = pair.limb[1 - which]->point[0];
        float left = dot(limb.point[0] - other, anatomy_.left);
        // Where both begin at one point they go apart farther down.
        if (std::abs(left) < 1e-3f * limb.length2())
            left = dot(limb.point[1] - (pair.limb[1] ? pair.limb[1 - which]->point[1] : other), anatomy_.left);
        return left > 0 ? BodySide::left : BodySide::right;
    }

    void addPair(const LimbPair& pair, BodyRole first, int carrier) {
        for (std::size_t i = 0; i < 2; ++i) {
            if (!pair.limb[i]) continue;
            const Limb& limb = *pair.limb[i];
            const float proportions =
                std::exp(-2 * std::max(0.0f, limb.misfit + (limb.forced ? 100.0f : 0.0f) +
                                                 0.25f * static_cast<float>(limb.named - limb.misnamed)));
            const float alike =
                pair.limb[1] ? std::exp(-4 * std::abs(std::log(pair.limb[0]->upper / pair.limb[1]->upper))) : 0.3f;
            int parent = carrier;
            for (std::size_t k = 0; k < 3 && limb.joint[k] >= 0; ++k) {
                const auto role = first == BodyRole::wing || first == BodyRole::other
                                      ? first
                                      : static_cast<BodyRole>(static_cast<std::size_t>(first) + k);
                parent = add(role, sideOf(pair, i), limb.joint[k], parent, limb.point[k + 1],
                             confidence(role, limb.joint[k], {proportions, alike}));
            }
        }
    }

    /// Legs of who has many; wings of others where they grow from the upper half of the trunk.
    void addMore(const LimbPair& pair) {
        BodyRole role = BodyRole::other;
        const bool named = tree_.names[static_cast<std::size_t>(pair.limb[0]->joint[0])].hint == NameHint::wing ||
                           tree_.names[static_cast<std::size_t>(pair.limb[0]->root)].hint == NameHint::wing;
        const Vec3 hips = choice_.legs.start(), shoulders = choice_.arms.start();
        const bool high = lengthSquared(pair.start() - shoulders) < lengthSquared(pair.start() - hips);
        if (choice_.plan == BodyPlan::hexapod && !named)
            role = BodyRole::thigh;
        else if (named || high)
            role = BodyRole::wing;
        addPair(pair, role, carrierOf(pair.attach));
    }

    /// A chain behind the hips that is no limb, or is called so.
    void addTail() {
        int tail = -1;
        const Vec3 trunk = normalized(choice_.arms.start() - choice_.legs.start());
        for (int bone = 1; bone < tree_.count() && tail < 0; ++bone) {
            const auto at = static_cast<std::size_t>(bone);
            if (tree_.loose[at] || tree_.reach[at] < 0.08f * tree_.size) continue;
            const auto& known = known_.of[at];
            const bool named = tree_.names[at].hint == NameHint::tail || (known && known->role == BodyRole::tail);
            const bool behind = tree_.parent(bone) == choice_.legs.attach && tree_.chain(bone).size() > 2 &&
                                tree_.reach[at] > 0.15f * tree_.size &&
                                dot(tree_.at(tree_.tip[at]) - tree_.at(bone), trunk) < -0.2f * tree_.reach[at];
            const bool free = std::none_of(anatomy_.segments.begin(), anatomy_.segments.end(), [&](const Segment& s) {
                return tree_.isWithin(s.bone, bone) || (tree_.isWithin(bone, s.bone) && s.role != BodyRole::pelvis &&
                                                        s.role != BodyRole::abdomen && s.role != BodyRole::chest);
            });
            if ((named || behind) && free) tail = bone;
        }
        if (tail < 0) return;
        const std::vector<int> chain = tree_.chain(tail);
        const float whole = tree_.reach[static_cast<std::size_t>(tail)];
        int carrier = carrierOf(tree_.parent(tail));
        std::size_t parts = 0;
        for (const int bone : chain) {
            const float left = tree_.reach[static_cast<std::size_t>(bone)];
            const float due = (static_cast<float>(parts) - 0.25f) * whole / kTailParts;
            if (parts == kTailParts || left < 0.5f * whole / kTailParts || whole - left < due) continue;
            if (parts > 0) anatomy_.segments.back().end = tree_.at(bone);
            carrier = addMiddle(BodyRole::tail, bone, carrier);
            anatomy_.segments.back().end = tree_.end[static_cast<std::size_t>(chain.back())];
            ++parts;
        }
    }

    const Skeleton& skeleton_;
    const BoneTree& tree_;
    const KnownRoles& known_;
    const PlanChoice& choice_;
    Anatomy& anatomy_;
    int pelvis_ = 0, chest_ = 0;
};

}  // namespace

void segmentBody(const Skeleton& skeleton, const BoneTree& tree, const KnownRoles& known, const PlanChoice& choice,
                 Anatomy& anatomy) {
    Segmenter(skeleton, tree, known, choice, anatomy).run();
}

}  // namespace ragtop
