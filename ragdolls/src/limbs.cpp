#include "limbs.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace ragtop {
namespace {

/// What a limb measures, as shares of its two long segments; hands and feet up to the last joint that rigs have. Humans
/// after Winter, Biomechanics and Motor Control of Human Movement, 2009, fig. 4.1; the others are middles of what there
/// is from cats to horses, and only tell joints apart from each other.
struct LimbProportions {
    float upperShare;   ///< of the upper one in both
    float endShare;     ///< what follows the lower one, over both
    float girdleShare;  ///< a clavicle, or the offset of the hip from the pelvis, over both
    std::array<NameHint, 3> hints;
    BodyRole first;
};

constexpr std::array<NameHint, 3> kArmHints{NameHint::shoulder, NameHint::elbow, NameHint::wrist};
constexpr std::array<NameHint, 3> kLegHints{NameHint::hip, NameHint::knee, NameHint::ankle};
constexpr std::array<LimbProportions, kLimbKinds> kProportions{{
    {0.56f, 0.30f, 0.33f, kArmHints, BodyRole::upperArm},
    {0.50f, 0.20f, 0.16f, kLegHints, BodyRole::thigh},
    {0.47f, 0.45f, 0.30f, kArmHints, BodyRole::upperArm},
    {0.50f, 0.55f, 0.16f, kLegHints, BodyRole::thigh},
    {0.47f, 0.60f, 0.20f, kArmHints, BodyRole::upperArm},
    {0.50f, 0.40f, 0.20f, kLegHints, BodyRole::thigh},
}};
const LimbProportions& proportionsOf(LimbKind kind) { return kProportions[static_cast<std::size_t>(kind)]; }

constexpr float kLimbReach = 0.1f;       ///< a limb is longer than this share of the longest way in the skeleton
constexpr std::size_t kMostRoots = 24;   ///< places that limbs are looked for at
constexpr std::size_t kMostJoints = 24;  ///< bones along a limb; chains and tails have more
constexpr std::size_t kMostPaths = 4;    ///< from one root to tips
constexpr std::size_t kKept = 12;        ///< ways to see a chain as a limb, of which a pair takes the best
constexpr float kUnlike = 0.3f;          ///< logarithm of the ratio of two lengths that are meant to be alike
constexpr float kNameWorth = 0.25f;      ///< a fitting name counts as much as a squared deviation of this
constexpr float kSameStart = 0.05f;      ///< of the upper segment: hips and shoulders are wider apart than this
constexpr float kEndMissing = 0.04f;     ///< a hand or foot that is only skin is less likely than one with a joint

float squared(float x) { return x * x; }

}  // namespace

BodyRole firstRole(LimbKind kind) { return proportionsOf(kind).first; }

Vec3 LimbPair::start() const { return limb[1] ? 0.5f * (limb[0]->point[0] + limb[1]->point[0]) : limb[0]->point[0]; }

Vec3 LimbPair::direction() const {
    return limb[1] ? normalized(limb[0]->direction() + limb[1]->direction()) : limb[0]->direction();
}

float LimbPair::length() const {
    return limb[1] ? 0.5f * (limb[0]->length2() + limb[1]->length2()) : limb[0]->length2();
}

float LimbPair::mean(int Limb::*number) const {
    return static_cast<float>((*limb[0]).*number + (limb[1] ? (*limb[1]).*number : 0)) / static_cast<float>(count());
}

LimbSearch::LimbSearch(const BoneTree& tree, const KnownRoles& known) : tree_(tree), known_(known) {
    std::vector<std::tuple<float, int>> found;
    for (int bone = 1; bone < tree.count(); ++bone) {
        const auto at = static_cast<std::size_t>(bone);
        const bool isForced =
            known.of[at] && (known.of[at]->role == BodyRole::thigh || known.of[at]->role == BodyRole::upperArm);
        const float through = tree.reach[at] + length(tree.at(bone) - tree.at(tree.parent(bone)));
        const bool branches = tree.children[static_cast<std::size_t>(tree.parent(bone))].size() > 1;
        const bool skinned = tree.skin[0] == 0 || tree.skin[at] > 0;
        const bool isLimb = branches && !tree.loose[at] && skinned && through > kLimbReach * tree.size;
        if (isForced)
            found.emplace_back(-2 * tree.size, bone);
        else if (isLimb)
            found.emplace_back(-through, bone);
    }
    std::sort(found.begin(), found.end());
    if (found.size() > kMostRoots) found.resize(kMostRoots);
    for (const auto& [order, bone] : found) roots_.push_back(bone);
    for (std::size_t kind = 0; kind < kLimbKinds; ++kind)
        for (const int root : roots_) fitted_[kind].push_back(fit(root, static_cast<LimbKind>(kind)));
}

const std::vector<Limb>& LimbSearch::limbs(int root, LimbKind kind) const {
    const auto at = std::find(roots_.begin(), roots_.end(), root) - roots_.begin();
    return fitted_[static_cast<std::size_t>(kind)][static_cast<std::size_t>(at)];
}

/// The way to the farthest tip, and ways to others that leave it early: a sleeve may be longer than the arm in it.
std::vector<std::vector<int>> LimbSearch::paths(int root) const {
    std::vector<std::vector<int>> result{tree_.chain(root)};
    const std::vector<int> main = result.front();
    for (const int bone : main) {
        const float left = tree_.reach[static_cast<std::size_t>(bone)];
        if (left < 0.35f * tree_.reach[static_cast<std::size_t>(root)]) break;
        for (const int child : tree_.children[static_cast<std::size_t>(bone)]) {
            const auto at = static_cast<std::size_t>(child);
            const float through = tree_.reach[at] + length(tree_.at(child) - tree_.at(bone));
            if (tree_.loose[at] || through < 0.4f * left || tree_.isWithin(main.back(), child)) continue;
            if (result.size() == kMostPaths) return result;
            result.push_back(tree_.path(root, tree_.tip[at]));
        }
    }
    return result;
}

std::vector<Limb> LimbSearch::fit(int root, LimbKind kind) const {
    std::vector<Limb> found;
    for (const std::vector<int>& path : paths(root))
        if (path.size() <= kMostJoints) fitPath(path, kind, found);
    std::sort(found.begin(), found.end(),
              [](const Limb& a, const Limb& b) { return std::tie(a.misfit, a.joint) < std::tie(b.misfit, b.joint); });
    if (found.size() > kKept) found.resize(kKept);
    return found;
}

void LimbSearch::fitPath(const std::vector<int>& path, LimbKind kind, std::vector<Limb>& into) const {
    std::vector<NameHint> names;
    for (const int bone : path) names.push_back(tree_.names[static_cast<std::size_t>(bone)].hint);
    const std::vector<NameHint> hints = jointHints(names);
    const int count = static_cast<int>(path.size());
    for (int a = 0; a < count; ++a)
        for (int b = a + 1; b < count; ++b)
            // The one behind the last is where the skin ends, or nothing.
            for (int c = b + 1; c <= count; ++c) {
                auto limb = limbAt(path, {a, b, c}, kind, hints);
                if (limb && allowed(path, *limb, kind, limb->forced)) {
                    if (limb->forced) limb->misfit -= 100;
                    into.push_back(*limb);
                }
            }
}

std::optional<Limb> LimbSearch::limbAt(const std::vector<int>& path, const std::array<int, 3>& choice, LimbKind kind,
                                       const std::vector<NameHint>& hints) const {
    const LimbProportions& usual = proportionsOf(kind);
    const auto bone = [&](int i) { return path[static_cast<std::size_t>(i)]; };
    const auto [a, b, c] = choice;
    const int count = static_cast<int>(path.size());
    const bool hasEnd = c<count, skinned = tree_.beyond(path.back())> 0;
    Limb limb;
    limb.root = path.front();
    limb.joint = {bone(a), bone(b), hasEnd ? bone(c) : -1};
    limb.point = {tree_.at(bone(a)), tree_.at(bone(b)), {}, {}};
    const Vec3 tip = tree_.end[static_cast<std::size_t>(path.back())];
    limb.upper = length(limb.point[1] - limb.point[0]);
    const float girdle = length(limb.point[0] - tree_.at(path.front()));
    if (!hasEnd && !skinned && b + 1 < count) return {};  // there is a joint farther down
    limb.point[3] = tip;
    limb.point[2] = hasEnd ? tree_.at(bone(c)) : tip;
    limb.lower = length(limb.point[2] - limb.point[1]);
    const float reach = tree_.reach[static_cast<std::size_t>(path.front())];
    if (!(limb.upper > 0.06f * reach)) return {};
    float share = 0, end = 0, both = limb.upper + limb.lower;
    if (hasEnd) {
        if (!(limb.lower > 0.06f * reach) || !(both > 0.3f * reach)) return {};
        share = limb.upper / both - usual.upperShare;
        // Whose last joint is the wrist tells nothing about the hand.
        end = c + 1 == count && !skinned ? 0.15f : length(tip - limb.point[2]) / both - usual.endShare;
    } else if (skinned) {
        if (b + 1 < count || !(limb.lower > 0.06f * reach) || !(both > 0.6f * reach)) return {};
        share = limb.upper / both - usual.upperShare / (1 + usual.endShare);
    } else {
        both = limb.upper / usual.upperShare;
        limb.lower = 0;
        limb.point[2] = limb.point[3] = limb.point[1] + (both - limb.upper) * normalized(limb.point[1] - limb.point[0]);
        share = 0.2f;
    }
    const float girdleError = std::min(girdle / both, std::abs(girdle / both - usual.girdleShare));
    limb.misfit = 3 * squared(share) + std::min(squared(end), 1.0f) + squared(girdleError) + (hasEnd ? 0 : kEndMissing);
    for (std::size_t k = 0; k < 3; ++k) {
        const int place = choice[k];
        if (place >= count) continue;
        const NameHint hint = hints[static_cast<std::size_t>(place)];
        const bool speaks = hint != NameHint::none && hint != NameHint::wing;
        const bool elsewhere = std::find(hints.begin(), hints.end(), usual.hints[k]) != hints.end();
        if (hint == usual.hints[k])
            ++limb.named;
        else if (elsewhere || speaks)
            ++limb.misnamed;
    }
    limb.misfit += kNameWorth * static_cast<float>(limb.misnamed - limb.named);
    return limb;
}

/// Bones with known roles have these or none of the limb does.
bool LimbSearch::allowed(const std::vector<int>& path, const Limb& limb, LimbKind kind, bool& forced) const {
    const int first = static_cast<int>(firstRole(kind));
    for (const int bone : path) {
        const auto& known = known_.of[static_cast<std::size_t>(bone)];
        if (!known) continue;
        const int at = static_cast<int>(std::find(limb.joint.begin(), limb.joint.end(), bone) - limb.joint.begin());
        const int wanted = static_cast<int>(known->role) - first;
        if (wanted >= 0 && wanted < 3 ? at != wanted : at < 3) return false;
        if (at < 3) forced = true;
    }
    return true;
}

bool LimbSearch::apart(int a, int b) const { return !tree_.isWithin(a, b) && !tree_.isWithin(b, a); }

std::optional<LimbPair> LimbSearch::single(int root, LimbKind kind) const {
    const std::vector<Limb>& found = limbs(root, kind);
    if (found.empty()) return {};
    LimbPair pair;
    pair.limb[0] = found.front();
    pair.attach = tree_.parent(root);
    pair.misfit = 2 * found.front().misfit;
    return pair;
}

/// m, along bones from where a limb meets another to its first joint.
float LimbSearch::wayTo(const Limb& limb, int attach) const {
    float way = 0;
    for (int bone = limb.joint[0]; bone != attach; bone = tree_.parent(bone))
        way += length(tree_.at(bone) - tree_.at(tree_.parent(bone)));
    return way;
}

/// Sides that a map or names give to a limb: −1 left, 1 right, 0 unknown.
int LimbSearch::sideOf(const Limb& limb) const {
    int sum = 0;
    for (const int bone : limb.joint)
        if (bone >= 0) sum += tree_.names[static_cast<std::size_t>(bone)].side;
    return sum < 0 ? -1 : sum > 0 ? 1 : 0;
}

std::optional<LimbPair> LimbSearch::pair(int a, int b, LimbKind kind) const {
    if (!apart(a, b)) return {};
    std::optional<LimbPair> best;
    for (const Limb& one : limbs(a, kind))
        for (const Limb& other : limbs(b, kind)) {
            const float upper = std::log(one.upper / other.upper);
            const bool lowers = one.isComplete() && other.isComplete();
            const float lower = lowers ? std::log(one.lower / other.lower) : 0.0f;
            if (!(std::abs(upper) < kUnlike && std::abs(lower) < kUnlike)) continue;
            // One beside the other in the same place is its double, for a blend or a control.
            if (length(one.point[0] - other.point[0]) + length(one.point[1] - other.point[1]) < 0.02f * tree_.size)
                continue;
            // Limbs of one body are as far from where they meet.
            const int attach = tree_.commonAncestor(a, b);
            const float apart = (wayTo(one, attach) - wayTo(other, attach)) / (one.length2() + other.length2());
            const int sides = sideOf(one) * sideOf(other);
            const float misfit = one.misfit + other.misfit + 4 * (squared(upper) + squared(lower)) +
                                 (lowers || one.isComplete() == other.isComplete() ? 0.0f : 0.1f) +
                                 (sides > 0   ? 0.5f
                                  : sides < 0 ? -0.2f
                                              : 0.0f) +
                                 16 * squared(apart) +
                                 (length(one.point[0] - other.point[0]) < kSameStart * one.upper ? 0.2f : 0.0f);
            if (best && best->misfit <= misfit) continue;
            best = LimbPair{{one, other}, attach, misfit};
        }
    return best;
}

}  // namespace ragtop
