#include "ragtop/anatomy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <tuple>

#include "bone_tree.h"

namespace ragtop {
namespace {

/// Two mirrored chains of bones that begin at the same bone.
struct LimbPair {
    int attach = -1;
    std::array<int, 2> root{-1, -1};
    float reach = 0;
    Vec3 across{};  ///< from the second limb to the first, unit
};

/// The joints of a limb: shoulder, elbow, wrist and fingertip, or hip, knee, ankle and toe.
struct LimbJoints {
    std::array<int, 3> joint{-1, -1, -1};
    int tip = -1;
};

/// What a limb of a human measures, as shares of its two long segments [Winter, Biomechanics and Motor Control of
/// Human Movement, 2009, fig. 4.1]; hands and feet up to the last joint that rigs have.
struct LimbProportions {
    float upperShare;   ///< of the upper one in both
    float endShare;     ///< what follows the lower one, over both
    float girdleShare;  ///< a clavicle, or the offset of the hip from the pelvis, over both
    std::array<NameHint, 3> hints;
};
constexpr LimbProportions kArm{0.56f, 0.30f, 0.33f, {NameHint::shoulder, NameHint::elbow, NameHint::wrist}};
constexpr LimbProportions kLeg{0.50f, 0.20f, 0.16f, {NameHint::hip, NameHint::knee, NameHint::ankle}};

constexpr float kLimbReach = 0.15f;    ///< a limb is longer than this share of the longest path in the skeleton
constexpr float kMirrorError = 0.25f;  ///< deviation from a mirror image, over the distance between the limbs

class Recognition {
public:
    explicit Recognition(const Skeleton& skeleton) : skeleton_(skeleton), tree_(skeleton) {}

    Anatomy run() const {
        Anatomy anatomy;
        anatomy.note = findHuman(anatomy);
        if (!anatomy.humanoid) segmentOther(anatomy);
        return anatomy;
    }

private:
    const Vec3& at(int bone) const { return skeleton_.bones[static_cast<std::size_t>(bone)].bind.position; }
    int parent(int bone) const { return skeleton_.bones[static_cast<std::size_t>(bone)].parent; }
    const std::string& name(int bone) const { return skeleton_.bones[static_cast<std::size_t>(bone)].name; }
    float reach(int bone) const { return tree_.reach[static_cast<std::size_t>(bone)]; }
    const std::vector<int>& children(int bone) const { return tree_.children[static_cast<std::size_t>(bone)]; }
    int boneCount() const { return static_cast<int>(skeleton_.bones.size()); }

    /// Corresponding points of two mirrored chains differ along one common direction.
    std::optional<LimbPair> mirrored(int attach, int a, int b) const {
        const float longer = std::max(reach(a), reach(b));
        if (std::abs(reach(a) - reach(b)) > 0.1f * longer) return {};
        const std::vector<int> chainA = tree_.chain(skeleton_, a), chainB = tree_.chain(skeleton_, b);
        const std::size_t count = std::min(chainA.size(), chainB.size());
        if (count < 2) return {};
        Vec3 sum{};
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 difference = at(chainA[i]) - at(chainB[i]);
            sum += dot(sum, difference) < 0 ? -difference : difference;
        }
        const Vec3 across = normalized(sum);
        float error = 0, distance = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 difference = at(chainA[i]) - at(chainB[i]);
            const float along = dot(difference, across);
            error += length(difference - along * across);
            distance += std::abs(along);
        }
        if (!(error < kMirrorError * distance)) return {};
        return LimbPair{attach, {a, b}, std::min(reach(a), reach(b)) + length(at(a) - at(attach)), across};
    }

    std::vector<LimbPair> findPairs() const {
        const float shortest = kLimbReach * reach(0);
        std::vector<LimbPair> pairs;
        for (int bone = 0; bone < boneCount(); ++bone)
            for (const int a : children(bone))
                for (const int b : children(bone)) {
                    if (b <= a || reach(a) < shortest || reach(b) < shortest) continue;
                    if (const auto pair = mirrored(bone, a, b)) pairs.push_back(*pair);
                }
        std::sort(pairs.begin(), pairs.end(), [](const LimbPair& a, const LimbPair& b) {
            return std::tie(b.reach, a.attach, a.root) < std::tie(a.reach, b.attach, b.root);
        });
        return pairs;
    }

    bool inLimb(int bone, const LimbPair& pair) const {
        return isWithin(skeleton_, bone, pair.root[0]) || isWithin(skeleton_, bone, pair.root[1]);
    }

    /// The farthest that bones reach from the attachment of `pair`, apart from its limbs and the way to `other`.
    float beyond(const LimbPair& pair, const LimbPair& other) const {
        float farthest = 0;
        for (const int child : children(pair.attach)) {
            if (child == pair.root[0] || child == pair.root[1] || isWithin(skeleton_, other.attach, child)) continue;
            farthest = std::max(farthest, reach(child) + length(at(child) - at(pair.attach)));
        }
        return farthest;
    }

    /// Legs hang from where the body ends; arms from where it goes on to a head, or else farther from the root.
    bool legsFirst(const LimbPair& a, const LimbPair& b) const {
        const float beyondA = beyond(a, b), beyondB = beyond(b, a);
        if ((beyondA > 0) != (beyondB > 0)) return beyondB > 0;
        if (isWithin(skeleton_, b.attach, a.attach)) return true;
        if (isWithin(skeleton_, a.attach, b.attach)) return false;
        return beyondA < beyondB;
    }

    using Chain = std::vector<int>;
    using Choice = std::array<int, 3>;

    /// Squared deviation from human proportions when the joints are those places of the chain; a fitting name counts
    /// as much as a deviation of a half. Infinite where the segments are too short for a limb.
    float deviation(const Chain& chain, const Choice& choice, const Choice& named, const LimbProportions& human) const {
        const auto point = [&](int i) { return at(chain[static_cast<std::size_t>(i)]); };
        const auto [a, b, c] = choice;
        const float upper = length(point(b) - point(a)), both = upper + length(point(c) - point(b));
        if (!(both > 0.3f * reach(chain.front()))) return std::numeric_limits<float>::infinity();
        const float share = upper / both - human.upperShare;
        const float end = length(at(chain.back()) - point(c)) / both - human.endShare;
        const float girdle = length(point(a) - point(0)) / both;
        const float girdleError = std::min(girdle, std::abs(girdle - human.girdleShare));
        float cost = share * share + end * end + girdleError * girdleError;
        for (std::size_t k = 0; k < 3; ++k)
            if (choice[k] == named[k]) cost -= 0.25f;
        return cost;
    }

    /// Picks the joints of a limb out of chains that may hold clavicles, twist bones and fingers. Chains of equal
    /// length are judged together, so that both sides get the same bones.
    bool findJoints(std::span<const Chain> chains, const LimbProportions& human, std::span<LimbJoints> found) const {
        const int count = static_cast<int>(chains[0].size());
        std::array<Choice, 2> named{};
        for (std::size_t side = 0; side < chains.size(); ++side) named[side] = firstNamed(chains[side], human.hints);
        Choice best{};
        float least = std::numeric_limits<float>::infinity();
        for (int a = 0; a < count; ++a)
            for (int b = a + 1; b < count; ++b)
                for (int c = b + 1; c < count; ++c) {
                    float cost = 0;
                    for (std::size_t side = 0; side < chains.size(); ++side)
                        cost += deviation(chains[side], {a, b, c}, named[side], human);
                    if (cost >= least) continue;
                    least = cost;
                    best = {a, b, c};
                }
        if (least == std::numeric_limits<float>::infinity()) return false;
        for (std::size_t side = 0; side < chains.size(); ++side) {
            for (std::size_t k = 0; k < 3; ++k) found[side].joint[k] = chains[side][static_cast<std::size_t>(best[k])];
            found[side].tip = chains[side].back();
        }
        return true;
    }

    bool findJoints(const LimbPair& pair, const LimbProportions& human, std::array<LimbJoints, 2>& found) const {
        const std::array<Chain, 2> chains{tree_.chain(skeleton_, pair.root[0]), tree_.chain(skeleton_, pair.root[1])};
        const std::span<const Chain> both(chains);
        const std::span<LimbJoints> into(found);
        if (chains[0].size() == chains[1].size()) return findJoints(both, human, into);
        return findJoints(both.first(1), human, into.first(1)) && findJoints(both.last(1), human, into.last(1));
    }

    Choice firstNamed(const Chain& chain, const std::array<NameHint, 3>& hints) const {
        Choice named{-1, -1, -1};
        for (std::size_t i = 0; i < chain.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (named[k] < 0 && hintOf(name(chain[i])) == hints[k]) named[k] = static_cast<int>(i);
        return named;
    }

    /// Among what grows from the shoulders apart from the arms, the head rises highest.
    int findHead(const LimbPair& arms, const Vec3& up) const {
        int head = -1;
        float highest = 0;
        for (const int child : children(arms.attach)) {
            if (inLimb(child, arms)) continue;
            float height = 0;
            for (int bone = child; bone < boneCount(); ++bone) {
                if (!isWithin(skeleton_, bone, child)) continue;
                height = std::max(height, dot(at(bone) - at(arms.attach), up));
                // An unnamed head is one without deeper bones; a named one beats a feather on a hat.
                if (hintOf(name(bone)) == NameHint::head) height += reach(0);
            }
            if (height > highest) {
                highest = height;
                head = child;
            }
        }
        return head;
    }

    /// Tries pairs of mirrored limbs, longest first, as legs and arms; what was wrong with the last, or a remark.
    std::string findHuman(Anatomy& anatomy) const {
        const std::vector<LimbPair> pairs = findPairs();
        if (pairs.empty()) return "no human: no two mirrored limbs grow from one bone";
        std::string note = "no human: only one pair of mirrored limbs";
        for (std::size_t second = 1; second < pairs.size(); ++second)
            for (std::size_t first = 0; first < second; ++first) {
                const LimbPair &a = pairs[first], &b = pairs[second];
                if (a.attach == b.attach || inLimb(a.attach, b) || inLimb(b.attach, a)) continue;
                const bool inOrder = legsFirst(a, b);
                note = tryHuman(anatomy, inOrder ? a : b, inOrder ? b : a);
                if (anatomy.humanoid) return note;
            }
        return note;
    }

    std::string tryHuman(Anatomy& anatomy, const LimbPair& legs, const LimbPair& arms) const {
        std::array<LimbJoints, 2> leg, arm;
        if (!findJoints(legs, kLeg, leg) || !findJoints(arms, kArm, arm))
            return "no human: a limb has fewer than three joints";
        const auto mean = [&](int a, int b) { return 0.5f * (at(a) + at(b)); };
        const Vec3 hips = mean(leg[0].joint[0], leg[1].joint[0]);
        const Vec3 ankles = mean(leg[0].joint[2], leg[1].joint[2]);
        const Vec3 shoulders = mean(arm[0].joint[0], arm[1].joint[0]);
        const Vec3 spine = normalized(shoulders - hips);
        if (dot(spine, normalized(ankles - hips)) > -0.5f) return "no human: the legs do not continue the spine";
        const int head = findHead(arms, spine);
        if (head < 0) return "no human: nothing rises between the arms";

        if (dot(arms.across, legs.across) * dot(arms.across, legs.across) < 0.5f)
            return "no human: arms and legs are mirrored in different planes";
        orient(anatomy, legs, leg, normalized(spine - normalized(ankles - hips)));
        anatomy.humanoid = true;
        buildTrunk(anatomy, commonAncestor(skeleton_, tree_, legs.attach, arms.attach), arms, head);
        for (std::size_t side = 0; side < 2; ++side) {
            addLimb(anatomy, leg[side], BodyRole::thigh, 0);
            addLimb(anatomy, arm[side], BodyRole::upperArm, chestSegment(anatomy));
        }
        return anatomy.note;
    }

    static int chestSegment(const Anatomy& anatomy) {
        int chest = 0;
        for (std::size_t i = 0; i < anatomy.segments.size(); ++i)
            if (anatomy.segments[i].role == BodyRole::chest) chest = static_cast<int>(i);
        return chest;
    }

    /// Up is along the legs and spine, forward where the toes point, left what is left of that (left = up × forward).
    void orient(Anatomy& anatomy, const LimbPair& legs, const std::array<LimbJoints, 2>& leg, const Vec3& along) const {
        const Vec3 across = legs.across;
        anatomy.up = normalized(along - dot(along, across) * across);
        const Vec3 sagittal = normalized(cross(across, anatomy.up));
        Vec3 toes{};
        float shank = 0;
        for (const LimbJoints& joints : leg) {
            toes += at(joints.tip) - at(joints.joint[2]);
            shank += length(at(joints.joint[2]) - at(joints.joint[1]));
        }
        float ahead = dot(toes, sagittal);
        if (std::abs(ahead) < 0.05f * shank) {
            const int named = sideHintOf(name(legs.root[0]));
            ahead = named != 0 ? static_cast<float>(-named) : skinAhead(leg, sagittal);
            if (ahead == 0) {
                ahead = sagittal.z >= 0 ? 1.0f : -1.0f;
                anatomy.note = "which way it faces was guessed: it has neither toes nor named sides";
            }
        }
        anatomy.forward = ahead < 0 ? -sagittal : sagittal;
        anatomy.left = cross(anatomy.up, anatomy.forward);
    }

    /// How far the skin of the feet lies ahead of the ankles.
    float skinAhead(const std::array<LimbJoints, 2>& leg, const Vec3& sagittal) const {
        float sum = 0;
        if (skeleton_.skin.empty()) return sum;
        for (const LimbJoints& joints : leg)
            for (const Vec3& vertex : skeleton_.skin[static_cast<std::size_t>(joints.joint[2])])
                sum += dot(vertex - at(joints.joint[2]), sagittal);
        return sum;
    }

    /// Pelvis, abdomen and chest share the bones from the fork of the legs to the arms; the chest begins at the joint
    /// nearest to the middle between the lowest spine joint and the neck. With fewer bones parts are left out.
    void buildTrunk(Anatomy& anatomy, int pelvis, const LimbPair& arms, int head) const {
        std::vector<int> path;
        for (int bone = arms.attach; bone != pelvis; bone = parent(bone)) path.push_back(bone);
        std::reverse(path.begin(), path.end());
        const auto height = [&](int bone) { return dot(at(bone), anatomy.up); };
        const auto add = [&](BodyRole role, int bone) {
            const int carrier = static_cast<int>(anatomy.segments.size()) - 1;
            if (carrier >= 0) anatomy.segments.back().end = at(bone);
            anatomy.segments.push_back({role, BodySide::middle, bone, carrier, at(bone)});
        };
        add(BodyRole::pelvis, pelvis);
        if (path.size() >= 2) {
            const float middle = 0.5f * (height(path.front()) + height(head));
            std::size_t chest = 1;
            for (std::size_t i = 2; i < path.size(); ++i)
                if (std::abs(height(path[i]) - middle) < std::abs(height(path[chest]) - middle)) chest = i;
            add(BodyRole::abdomen, path.front());
            add(BodyRole::chest, path[chest]);
        } else if (path.size() == 1) {
            add(BodyRole::chest, path.front());
        }
        add(BodyRole::head, head);
        Segment& top = anatomy.segments.back();
        top.end = at(head) + highestAbove(head, anatomy.up) * anatomy.up;
    }

    float highestAbove(int head, const Vec3& up) const {
        float highest = 0;
        for (int bone = head; bone < boneCount(); ++bone) {
            if (!isWithin(skeleton_, bone, head)) continue;
            highest = std::max(highest, dot(at(bone) - at(head), up));
            if (skeleton_.skin.empty()) continue;
            for (const Vec3& vertex : skeleton_.skin[static_cast<std::size_t>(bone)])
                highest = std::max(highest, dot(vertex - at(head), up));
        }
        return highest;
    }

    void addLimb(Anatomy& anatomy, const LimbJoints& limb, BodyRole first, int carrier) const {
        const Vec3 pelvis = at(anatomy.segments[0].bone);
        const bool left = dot(at(limb.joint[1]) - pelvis, anatomy.left) > 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 end = k < 2 ? at(limb.joint[k + 1]) : at(limb.tip);
            const auto role = static_cast<BodyRole>(static_cast<int>(first) + static_cast<int>(k));
            anatomy.segments.push_back({role, left ? BodySide::left : BodySide::right, limb.joint[k], carrier, end});
            carrier = static_cast<int>(anatomy.segments.size()) - 1;
        }
    }

    /// Bones that are long for their skeleton begin segments; the bar rises until there are at most 24.
    void segmentOther(Anatomy& anatomy) const {
        anatomy.up = {0, 1, 0};
        anatomy.forward = {0, 0, 1};
        anatomy.left = {1, 0, 0};
        for (float bar = 0.06f;; bar *= 1.25f) {
            anatomy.segments.clear();
            std::vector<int> segmentOf(skeleton_.bones.size(), 0);
            for (int bone = 0; bone < boneCount(); ++bone) {
                const bool begins = bone == 0 || beginsSegment(anatomy, segmentOf, bone, bar * reach(0));
                int& segment = segmentOf[static_cast<std::size_t>(bone)];
                segment = bone == 0 ? -1 : segmentOf[static_cast<std::size_t>(parent(bone))];
                if (!begins) continue;
                anatomy.segments.push_back({BodyRole::other, BodySide::middle, bone, segment, farEnd(bone)});
                segment = static_cast<int>(anatomy.segments.size()) - 1;
            }
            if (anatomy.segments.size() <= 24) return;
        }
    }

    bool beginsSegment(const Anatomy& anatomy, const std::vector<int>& segmentOf, int bone, float least) const {
        const int carrier = segmentOf[static_cast<std::size_t>(parent(bone))];
        const Vec3& start = at(anatomy.segments[static_cast<std::size_t>(carrier)].bone);
        return length(farEnd(bone) - at(bone)) >= least && length(at(bone) - start) >= 0.5f * least;
    }

    /// The farthest child, or the farthest skin of a bone that has none.
    Vec3 farEnd(int bone) const {
        Vec3 end = at(bone);
        const auto consider = [&](const Vec3& point) {
            if (lengthSquared(point - at(bone)) > lengthSquared(end - at(bone))) end = point;
        };
        for (const int child : children(bone)) consider(at(child));
        if (children(bone).empty() && !skeleton_.skin.empty())
            for (const Vec3& vertex : skeleton_.skin[static_cast<std::size_t>(bone)]) consider(vertex);
        return end;
    }

    const Skeleton& skeleton_;
    BoneTree tree_;
};

}  // namespace

Anatomy recognise(const Skeleton& skeleton) {
    if (const std::string problem = whyInvalid(skeleton); !problem.empty())
        throw std::invalid_argument("skeleton: " + problem);
    return Recognition(skeleton).run();
}

}  // namespace ragtop
