#include "body_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace ragtop {
namespace {

constexpr std::size_t kMostPairs = 10;  ///< of each kind that are tried with each other
constexpr float kLeastEvidence = 0.5f;  ///< what speaks for a plan, less what speaks against it
constexpr float kLongPair = 0.5f;       ///< a pair this long beside the legs needs an explanation

float squared(float x) { return x * x; }
float ratioOff(float ratio, float usual, float spread) {
    return ratio > 0 ? squared(std::log(ratio / usual) / spread) : std::numeric_limits<float>::infinity();
}

/// Evidence for a plan in the manner of log odds, and the strongest reason against it.
struct Evidence {
    float sum = 0, worst = 0;
    const char* against = "nothing speaks for it";

    void add(float worth, const char* otherwise) {
        sum += worth;
        if (worth >= worst) return;
        worst = worth;
        against = otherwise;
    }
};

/// How the limbs of a body lie to each other at rest, and how long they are.
struct Posture {
    Vec3 trunk;        ///< from hips to shoulders, unit
    float standing;    ///< cosine between legs and the trunk, reversed: 1 upright, 0 on all fours or seated
    float fourLegged;  ///< arms along the legs and both across the trunk: 1 on all fours
    float lateral;     ///< arms to the sides and the trunk across the legs: 1 a bird with open wings
    float armsToLegs, trunkToLegs;

    Posture(const LimbPair& legs, const LimbPair& arms) {
        const Vec3 way = arms.start() - legs.start();
        trunk = normalized(way);
        const Vec3 down = legs.direction();
        standing = -dot(trunk, down);
        const float crossing = 1 - std::abs(standing);
        fourLegged = std::max(0.0f, dot(arms.direction(), down)) * crossing;
        lateral = 0;
        if (arms.limb[1]) {
            const Vec3 across = normalized(arms.limb[0]->point[0] - arms.limb[1]->point[0]);
            lateral =
                0.5f * crossing * (dot(arms.limb[0]->direction(), across) - dot(arms.limb[1]->direction(), across));
        }
        armsToLegs = arms.length() / legs.length();
        trunkToLegs = length(way) / legs.length();
    }
};

class PlanSearch {
public:
    PlanSearch(const BoneTree& tree, const LimbSearch& search, const KnownRoles& known)
        : tree_(tree), search_(search), known_(known), namesTail_(namesTail()) {
        for (std::size_t kind = 0; kind < kLimbKinds; ++kind) pairs_[kind] = pairsOf(static_cast<LimbKind>(kind));
    }

    PlanChoice run() {
        for (const auto& [plan, legs, arms] : kPlans)
            for (const LimbPair& behind : pairsOf_(legs))
                for (const LimbPair& ahead : pairsOf_(arms)) consider(plan, behind, ahead, 0);
        considerHexapod();
        if (best_.plan == BodyPlan::other) considerMissing();
        if (best_.plan == BodyPlan::other) {
            best_.missing = whyNone();
            return best_;
        }
        float rival = kLeastEvidence;
        for (const auto& [plan, sum] : evidence_)
            if (plan != best_.plan) rival = std::max(rival, sum);
        const float lead = evidenceOf(best_.plan) - rival;
        best_.confidence = 1 / (1 + std::exp(-lead));
        findMore();
        return best_;
    }

private:
    using Kinds = std::tuple<BodyPlan, LimbKind, LimbKind>;
    static constexpr std::array<Kinds, 3> kPlans{{
        {BodyPlan::human, LimbKind::leg, LimbKind::arm},
        {BodyPlan::quadruped, LimbKind::hindleg, LimbKind::foreleg},
        {BodyPlan::bird, LimbKind::hindleg, LimbKind::wing},
    }};

    const std::vector<LimbPair>& pairsOf_(LimbKind kind) const { return pairs_[static_cast<std::size_t>(kind)]; }

    std::vector<LimbPair> pairsOf(LimbKind kind) const {
        std::vector<LimbPair> pairs;
        const auto roots = search_.roots();
        for (std::size_t i = 0; i < roots.size(); ++i)
            for (std::size_t k = i + 1; k < roots.size(); ++k)
                if (auto pair = search_.pair(roots[i], roots[k], kind)) pairs.push_back(*pair);
        // Of two that fit alike the longer limbs are the legs.
        const auto order = [&](const LimbPair& pair) {
            return std::make_tuple(pair.misfit - 2 * pair.length() / tree_.size, pair.limb[0]->root,
                                   pair.limb[1]->root);
        };
        std::sort(pairs.begin(), pairs.end(),
                  [&](const LimbPair& a, const LimbPair& b) { return order(a) < order(b); });
        if (pairs.size() > kMostPairs) pairs.resize(kMostPairs);
        return pairs;
    }

    bool apart(const LimbPair& a, const LimbPair& b) const {
        for (const auto& one : a.limb)
            for (const auto& other : b.limb)
                if (one && other && !search_.apart(one->root, other->root)) return false;
        return true;
    }

    template <class Test>
    bool anyNamed(const LimbPair& pair, Test test) const {
        for (const auto& limb : pair.limb) {
            if (!limb) continue;
            for (const int bone : tree_.chain(limb->root))
                if (test(tree_.names[static_cast<std::size_t>(bone)])) return true;
        }
        return false;
    }
    bool isWing(const LimbPair& pair) const {
        return anyNamed(pair, [](const BoneName& name) { return name.hint == NameHint::wing; });
    }
    bool isBeastly(const LimbPair& pair, int end) const {
        return anyNamed(pair, [&](const BoneName& name) { return name.end == end || name.beast; });
    }
    /// Fingers or toes.
    int digits(const LimbPair& pair) const {
        std::size_t most = 0;
        for (const auto& limb : pair.limb)
            if (limb && limb->isComplete())
                most = std::max(most, tree_.children[static_cast<std::size_t>(limb->joint[2])].size());
        return static_cast<int>(most);
    }
    /// Long pairs apart from these, which a body of two pairs does not have.
    int unexplained(const LimbPair& legs, const LimbPair& arms) const {
        int count = 0;
        for (const LimbPair& pair : pairsOf_(LimbKind::insectLeg))
            if (apart(pair, legs) && apart(pair, arms) && !isWing(pair))
                count += std::abs(std::log(pair.length() / legs.length())) < kLongPair;
        return count;
    }
    bool namesTail() const {
        const auto hint = [&](int bone) { return tree_.names[static_cast<std::size_t>(bone)].hint; };
        for (int bone = 1; bone < tree_.count(); ++bone) {
            if (hint(bone) != NameHint::tail) continue;
            int at = tree_.parent(bone);
            while (at >= 0 && hint(at) != NameHint::head && hint(at) != NameHint::neck) at = tree_.parent(at);
            if (at < 0) return true;
        }
        return false;
    }
    /// Whether a chain leaves the trunk behind the legs.
    bool hasTail(const LimbPair& legs) const {
        if (namesTail_) return true;
        for (const int child : tree_.children[static_cast<std::size_t>(legs.attach)]) {
            const auto at = static_cast<std::size_t>(child);
            if (tree_.loose[at] || tree_.reach[at] < 0.15f * tree_.size || tree_.chain(child).size() < 3) continue;
            const bool isLeg = !search_.apart(child, legs.limb[0]->root) ||
                               (legs.limb[1] && !search_.apart(child, legs.limb[1]->root));
            if (!isLeg && tree_.children[static_cast<std::size_t>(tree_.tip[at])].empty() && !carries(child))
                return true;
        }
        return false;
    }
    bool carries(int bone) const {
        return std::any_of(search_.roots().begin(), search_.roots().end(),
                           [&](int root) { return root != bone && tree_.isWithin(root, bone); });
    }

    Evidence forHuman(const LimbPair& legs, const LimbPair& arms, const Posture& posture, bool head) const {
        Evidence e{2};
        e.add(-1.5f * std::clamp(legs.misfit, -1.0f, 1.2f), "no two limbs have the proportions of legs");
        e.add(-1.5f * std::clamp(arms.misfit, -1.0f, 1.2f), "no two limbs have the proportions of arms");
        e.add(-std::min(3.0f, ratioOff(posture.armsToLegs, 0.68f, 0.45f)),
              "arms and legs do not have lengths of one human");
        e.add(-std::min(1.5f, ratioOff(posture.trunkToLegs, 0.59f, 0.7f)),
              "the trunk is too short or long for its legs");
        e.add(posture.standing > 0 ? 1.5f * posture.standing : posture.standing, "the legs do not continue the spine");
        e.add(-2.5f * posture.fourLegged, "it stands on all fours");
        e.add(head ? 0.7f : -0.7f, "nothing rises between the arms");
        e.add(digits(arms) > 2 ? 0.6f : digits(legs) > 2 ? -0.6f : 0, "it has fingers on its feet");
        if (isWing(arms)) e.add(-2, "it has wings for arms");
        if (isBeastly(arms, 1) || isBeastly(legs, -1)) e.add(-2, "names speak of an animal");
        e.add(-0.3f * static_cast<float>(unexplained(legs, arms)), "it has more than four limbs");
        return e;
    }

    Evidence forQuadruped(const LimbPair& legs, const LimbPair& arms, const Posture& posture, bool head) const {
        Evidence e{1};
        e.add(-std::clamp(legs.misfit, -1.0f, 1.2f), "no two limbs have the proportions of hind legs");
        e.add(-std::clamp(arms.misfit, -1.0f, 1.2f), "no two limbs have the proportions of forelegs");
        e.add(-std::min(2.0f, ratioOff(posture.armsToLegs, 0.9f, 0.5f)), "front and hind legs have different lengths");
        e.add(3 * posture.fourLegged, "it does not stand on all fours");
        e.add(-2 * std::max(0.0f, posture.standing), "it stands upright");
        e.add(hasTail(legs) ? 0.6f : 0, "it has no tail");
        e.add(head ? 0.3f : -0.3f, "it has no head");
        if (isWing(arms)) e.add(-2, "it has wings for forelegs");
        if (isBeastly(arms, 1) || isBeastly(legs, -1)) e.add(2, "");
        e.add(-2.0f * static_cast<float>(unexplained(legs, arms)), "it has more than four legs");
        return e;
    }

    Evidence forBird(const LimbPair& legs, const LimbPair& arms, const Posture& posture, bool head) const {
        Evidence e{0};
        e.add(-std::clamp(legs.misfit, -1.0f, 1.2f), "no two limbs have the proportions of legs");
        e.add(-std::clamp(arms.misfit, -1.0f, 1.2f), "no two limbs have the proportions of wings");
        e.add(2 * posture.lateral, "its wings are not open");
        e.add(std::clamp(std::log(posture.armsToLegs), -1.0f, 1.0f), "its wings are short");
        e.add(-0.5f * std::max(0.0f, posture.standing), "it stands upright");
        e.add(head ? 0.3f : -0.3f, "it has no head");
        e.add(digits(legs) > 2 ? 0.4f : 0, "");
        if (isWing(arms)) e.add(3, "");
        if (isBeastly(arms, 1)) e.add(-1, "names speak of legs");
        e.add(-1.0f * static_cast<float>(unexplained(legs, arms)), "it has more than four limbs");
        return e;
    }

    Evidence evidenceFor(BodyPlan plan, const LimbPair& legs, const LimbPair& arms, bool head) const {
        const Posture posture(legs, arms);
        switch (plan) {
            case BodyPlan::human:
                return forHuman(legs, arms, posture, head);
            case BodyPlan::quadruped:
                return forQuadruped(legs, arms, posture, head);
            default:
                return forBird(legs, arms, posture, head);
        }
    }

    void consider(BodyPlan plan, const LimbPair& legs, const LimbPair& arms, float penalty) {
        if (!apart(legs, arms) || !(legs.length() > 0 && arms.length() > 0)) return;
        const int head = findHead(tree_, known_, legs, arms);
        const Evidence e = evidenceFor(plan, legs, arms, head >= 0);
        const float forced = 50.0f * static_cast<float>(isForced(legs) + isForced(arms));
        take(plan, e, e.sum - penalty + forced, legs, arms, head);
    }
    static int isForced(const LimbPair& pair) {
        return (pair.limb[0]->forced ? 1 : 0) + (pair.limb[1] && pair.limb[1]->forced ? 1 : 0);
    }

    void take(BodyPlan plan, const Evidence& e, float sum, const LimbPair& legs, const LimbPair& arms, int head) {
        auto known =
            std::find_if(evidence_.begin(), evidence_.end(), [&](const auto& entry) { return entry.first == plan; });
        if (known == evidence_.end()) known = evidence_.insert(evidence_.end(), {plan, sum});
        known->second = std::max(known->second, sum);
        if (plan == BodyPlan::human && sum > humanSum_) {
            humanSum_ = sum;
            againstHuman_ = e.against;
        }
        if (sum <= bestSum_ || sum < kLeastEvidence) return;
        bestSum_ = sum;
        best_ = PlanChoice{plan, 0, legs, arms, {}, head, {}};
    }
    float evidenceOf(BodyPlan plan) const {
        for (const auto& [known, sum] : evidence_)
            if (known == plan) return sum;
        return 0;
    }

    /// Three pairs or more of nearly equal legs along a trunk.
    void considerHexapod() {
        std::vector<LimbPair> legs;
        for (const LimbPair& pair : pairsOf_(LimbKind::insectLeg)) {
            if (isWing(pair)) continue;
            const bool alike = legs.empty() || std::abs(std::log(pair.length() / legs[0].length())) < kLongPair;
            const bool free =
                std::all_of(legs.begin(), legs.end(), [&](const LimbPair& other) { return apart(pair, other); });
            if (alike && free) legs.push_back(pair);
        }
        if (legs.size() < 3) return;
        Vec3 down{};
        for (const LimbPair& pair : legs) down += (1 / static_cast<float>(legs.size())) * pair.direction();
        std::size_t first = 0, last = 1;
        float farthest = -1;
        for (std::size_t i = 0; i < legs.size(); ++i)
            for (std::size_t k = i + 1; k < legs.size(); ++k) {
                const float way = length(legs[i].start() - legs[k].start());
                if (way <= farthest) continue;
                farthest = way;
                std::tie(first, last) = std::make_pair(i, k);
            }
        int head = findHead(tree_, known_, legs[last], legs[first]);
        const int otherHead = findHead(tree_, known_, legs[first], legs[last]);
        if (head < 0 && otherHead >= 0) {
            std::swap(first, last);
            head = otherHead;
        }
        Evidence e{1.5f};
        e.add(2 * length(down), "its legs point apart");
        for (const LimbPair& pair : legs) {
            e.add(-0.5f * std::clamp(pair.misfit, -1.0f, 1.2f), "no three pairs have the proportions of legs");
            e.add(anyNamed(pair, [](const BoneName& name) { return name.hint == NameHint::leg; }) ? 0.4f : 0, "");
            e.add(anyNamed(pair, isOfArm) ? -1.5f : 0, "it has arms");
        }
        take(BodyPlan::hexapod, e, e.sum, legs[last], legs[first], head);
    }
    static bool isOfArm(const BoneName& name) {
        return name.hint == NameHint::arm || (name.hint >= NameHint::clavicle && name.hint <= NameHint::finger);
    }

    /// One arm or one leg only.
    void considerMissing() {
        for (const int root : search_.roots()) {
            for (const LimbPair& legs : pairsOf_(LimbKind::leg))
                if (const auto arm = search_.single(root, LimbKind::arm)) consider(BodyPlan::human, legs, *arm, 1);
            for (const LimbPair& arms : pairsOf_(LimbKind::arm))
                if (const auto leg = search_.single(root, LimbKind::leg)) consider(BodyPlan::human, *leg, arms, 1);
        }
        if (best_.plan == BodyPlan::human)
            best_.missing = best_.arms.limb[1] ? "one leg is missing" : "one arm is missing";
    }

    void findMore() {
        for (const LimbPair& pair : pairsOf_(LimbKind::insectLeg)) {
            const bool free = apart(pair, best_.legs) && apart(pair, best_.arms) &&
                              (best_.head < 0 || (search_.apart(pair.limb[0]->root, best_.head) &&
                                                  search_.apart(pair.limb[1]->root, best_.head)));
            const bool fresh = std::all_of(best_.more.begin(), best_.more.end(),
                                           [&](const LimbPair& other) { return apart(pair, other); });
            if (free && fresh && pair.length() > 0.35f * best_.legs.length()) best_.more.push_back(pair);
        }
    }

    std::string whyNone() const {
        if (pairsOf_(LimbKind::leg).empty())
            return search_.roots().size() < 2 ? "no limbs leave its trunk" : "no two of its limbs are alike";
        if (humanSum_ == -std::numeric_limits<float>::infinity()) return "it has only one pair of limbs";
        return againstHuman_;
    }

    const BoneTree& tree_;
    const LimbSearch& search_;
    const KnownRoles& known_;
    bool namesTail_;
    std::array<std::vector<LimbPair>, kLimbKinds> pairs_;
    PlanChoice best_;
    float bestSum_ = -std::numeric_limits<float>::infinity();
    float humanSum_ = -std::numeric_limits<float>::infinity();
    const char* againstHuman_ = "";
    std::vector<std::pair<BodyPlan, float>> evidence_;
};

}  // namespace

PlanChoice choosePlan(const BoneTree& tree, const LimbSearch& search, const KnownRoles& known) {
    return PlanSearch(tree, search, known).run();
}

/// Beyond the shoulders and away from the hips; names count as much as a trunk's length.
int findHead(const BoneTree& tree, const KnownRoles& known, const LimbPair& legs, const LimbPair& arms) {
    if (known.head >= 0) return known.head;
    const Vec3 way = arms.start() - legs.start();
    const float trunk = length(way);
    const int root = tree.commonAncestor(legs.attach, arms.attach);
    const auto holdsLimb = [&](int bone) {
        for (const LimbPair* pair : {&legs, &arms})
            for (const auto& limb : pair->limb)
                if (limb && (tree.isWithin(limb->root, bone) || tree.isWithin(bone, limb->root))) return true;
        return false;
    };
    int best = -1;
    float most = 0.1f;
    const auto consider = [&](int child) {
        const auto at = static_cast<std::size_t>(child);
        if (tree.loose[at] || holdsLimb(child)) return;
        const int tip = tree.tip[at];
        float worth =
            dot(tree.end[static_cast<std::size_t>(tip)] - arms.start(), normalized(way)) / std::max(trunk, 1e-9f);
        worth = std::min(worth, 1.0f);
        worth += tree.headSaid[at];
        if (tree.skin[0] > 0) worth += 0.3f * static_cast<float>(tree.skin[at]) / static_cast<float>(tree.skin[0]);
        if (worth <= most) return;
        most = worth;
        best = child;
    };
    // Arms may hang on the neck, or the head on a spine that goes on below the arms.
    for (int bone = arms.attach;; bone = tree.parent(bone)) {
        for (const int child : tree.children[static_cast<std::size_t>(bone)]) consider(child);
        if (bone == root) break;
    }
    return best;
}

}  // namespace ragtop
