#include <algorithm>
#include <cmath>
#include <utility>

#include "retargeting.h"

/// Feet that stand in a clip, on one spot in another body.
namespace ragtop {
namespace {

constexpr float kNear = 1e-3f;      ///< of the height of the hips, that what stands may be from its spot
constexpr float kMostDrop = 0.08f;  ///< likewise, of the hips
constexpr float kTilted = 0.01f;    ///< likewise, of heel over ball, that only the ball stands
constexpr int kDropSteps = 8, kHalvings = 6, kLimitRounds = 6;

}  // namespace

bool Retargeting::haveFeet() const {
    return from_.feet[0].part >= 0 && from_.feet[1].part >= 0 && to_.feet[0].part >= 0 && to_.feet[1].part >= 0;
}

bool Retargeting::holdsFeet() const { return options_.keepFeet && haveFeet() && legs_[0] && legs_[1]; }

/// `ground`: m/s, how it moves below a body that walks on the spot.
std::vector<Retargeting::Hold> Retargeting::holdsOf(std::size_t side, const Vec3& ground, int& stances) {
    const float rate = 1 / step();
    const Stances found = stancesOf(onGround(sourceWays_[side], ground, rate), sourceGround_, from_.height, rate);
    for (const Stances::Stance& stance : found.all)
        stances += stance.last >= before_ && stance.first <= before_ + steps_;
    const FootWay own = onGround(ownWay(side), scale_ * ground, rate);
    const std::vector<Vec3> offsets = heldOffsets(own, found, to_.ground, to_.height, rate);
    std::vector<Hold> holds;
    for (std::size_t i = 0; i < moments_.size(); ++i) {
        place(moments_[i]);
        const Vec3 ankle = pointNow(to_.feet[side].part, to_.feet[side].joint) + offsets[i];
        holds.push_back({ankle, found.heel[i], found.ball[i]});
    }
    return holds;
}

/// Returns how many stances there are.
int Retargeting::holdFeet() {
    const Vec3 ground = before_ > 0 ? groundVelocity(sourceWays_, from_.height, 1 / step()) : Vec3{};
    int stances = 0;
    const Holds holds{holdsOf(0, ground, stances), holdsOf(1, ground, stances)};
    lowerHips(holds);
    for (std::size_t i = 0; i < moments_.size(); ++i) {
        place(moments_[i]);
        for (std::size_t side = 0; side < 2; ++side) {
            const Leg& leg = *legs_[side];
            const Reached to = reached(moments_[i], leg, side, holds[side][i], 0);
            for (const auto& [part, turn] :
                 {std::pair{leg.thigh, to.thigh}, {leg.shank, to.shank}, {leg.foot, to.foot}})
                moments_[i].parts[static_cast<std::size_t>(part)] = turn;
        }
    }
    return stances;
}

/// The least drop, m, that leaves what stands where it is; none where no drop does.
template <class Misses>
float Retargeting::leastDrop(Misses misses) const {
    const float near = kNear * to_.height, first = misses(0);
    if (first < near) return 0;
    float enough = 0;
    for (int i = 1; i <= kDropSteps; ++i) {
        enough = kMostDrop * to_.height * static_cast<float>(i) / kDropSteps;
        if (misses(enough) < near) break;
        if (i == kDropSteps) return 0;
    }
    float less = enough - kMostDrop * to_.height / kDropSteps;
    for (int i = 0; i < kHalvings; ++i)
        (misses(0.5f * (less + enough)) < near ? enough : less) = 0.5f * (less + enough);
    return enough;
}

/// As far as what stands is within reach, and within the limits of the hips: a knee that bends spares the hip.
void Retargeting::lowerHips(const Holds& holds) {
    std::vector<float> drop(moments_.size(), 0.0f);
    for (std::size_t i = 0; i < moments_.size(); ++i) {
        place(moments_[i]);
        for (std::size_t side = 0; side < 2; ++side) {
            const Hold& hold = holds[side][i];
            if (!hold.heel && !hold.ball) continue;
            const auto misses = [&](float lower) { return reached(moments_[i], *legs_[side], side, hold, lower).miss; };
            drop[i] = std::max(drop[i], leastDrop(misses));
        }
    }
    drop = smoothAbove(drop, window());
    for (std::size_t i = 0; i < moments_.size(); ++i) moments_[i].hips.y -= drop[i];
}

/// From the joint, in the bone of a foot that is turned so: of what is to stand the lower end.
Vec3 Retargeting::standsOn(const FootPoints& foot, const Hold& hold, const Quat& turn) const {
    float onHeel = hold.heel ? 1.0f : 0.0f;
    if (hold.heel == hold.ball) {
        const float higher = dot(rotate(turn, foot.heel - foot.ball), rotate(to_.heading, {0, 1, 0}));
        onHeel = std::clamp(0.5f - 0.5f * higher / (kTilted * to_.height), 0.0f, 1.0f);
    }
    return onHeel * foot.heel + (1 - onHeel) * foot.ball - foot.joint;
}

/// With the hips lower by that. Where the joints do not let the foot lie as it is to, what stands of it stays.
Retargeting::Reached Retargeting::reached(const Moment& moment, const Leg& leg, std::size_t side, const Hold& hold,
                                          float lower) const {
    const auto part = [&](int index) { return moment.parts[static_cast<std::size_t>(index)]; };
    const Vec3 hip = rotate(to_.heading, pointNow(leg.thigh, leg.hipInThigh) - Vec3{0, lower, 0});
    const int pelvis = to_.def.joints[static_cast<std::size_t>(leg.hip)].parent;
    const Vec3 wanted = rotate(to_.heading, hold.ankle);
    Vec3 ankle = wanted, stands;
    Reached to;
    for (int round = 0; round < kLimitRounds; ++round) {
        const Leg::Bent bent = leg.reachFrom(to_.def, part(leg.thigh), hip, part(leg.foot), ankle);
        to.thigh = mapping_.limited(leg.thigh, part(pelvis), bent.thigh);
        to.shank = mapping_.limited(leg.shank, to.thigh, to.thigh * conjugate(bent.thigh) * bent.shank);
        to.foot = mapping_.limited(leg.foot, to.shank, part(leg.foot));
        if (round == 0) stands = standsOn(to_.feet[side], hold, to.foot);
        ankle = wanted + rotate(part(leg.foot), stands) - rotate(to.foot, stands);
    }
    const Vec3 knee = hip + rotate(to.thigh, leg.kneeInThigh - leg.hipInThigh);
    to.miss = length(knee + rotate(to.shank, leg.ankleInShank - leg.kneeInShank) - ankle);
    return to;
}

}  // namespace ragtop
