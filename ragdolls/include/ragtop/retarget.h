#pragma once

#include <string>
#include <vector>

#include "ragtop/clip.h"
#include "ragtop/ragdoll.h"
#include "ragtop/tunables.h"

/// Animations of one body for another.
namespace ragtop {

struct RetargetOptions {
    float rate = 60;         ///< keys per second
    bool keepFeet = true;    ///< feet that stand in the clip stand on one spot of the ground
    bool keepLimits = true;  ///< joints stay within the limits of the ragdoll
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RetargetOptions*) {
    visit(Tunable{"rate", "1/s", 5, 1000, "keys per second"}, self.rate);
    visit(Tunable{"keepFeet", "", 0, 1, "feet that stand in the clip stand on one spot of the ground"}, self.keepFeet);
    visit(Tunable{"keepLimits", "", 0, 1, "joints stay within the limits of the ragdoll"}, self.keepLimits);
}

/// Empty when the options are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const RetargetOptions& options);

struct Retargeted {
    Clip clip{};               ///< of the bones of the other body, `skeletonOf` its definition
    float scale = 1;           ///< of ways: how high its hips stand over how high those of the clip do
    std::vector<int> still{};  ///< parts of it that nothing in the clip's body stands for; they stay as they hang
    int stances = 0;           ///< times that a foot was held where it stood
};

/// What `clip`, of the bones of `from`, is for the bones of `to`. Parts go by role and side, and turn as what they are
/// of a body (thigh along thigh, knee axis along knee axis), so that bones may lie, and rest poses be, as they like;
/// bones between parts, fingers and toes by their share of the chain they are in. Ways are scaled by the height of the
/// hips. A body may rest in a stride: which way it looks and how its feet lie on the ground are found from both sides.
/// A clip that ends in the pose it began with goes on repeating. With docs/adr/0093-retargeting.md.
///
/// Throws std::invalid_argument on a clip that is not of `from`, on bad options, and where a body has no pelvis or
/// misses a thigh.
Retargeted retarget(const Clip& clip, const RagdollDef& from, const RagdollDef& to,
                    const RetargetOptions& options = {});

/// Where a body goes, and how it heads, apart from what it does.
struct RootMotion {
    std::vector<float> times{};  ///< s, rising
    std::vector<Frame> keys{};   ///< level: from how the body stood at first, in model space
};

/// Takes the level way and the heading of the first bone out of a clip of that body: the clip then stays in its place,
/// and `key * what is left` at each of `times` is what it was. Throws std::invalid_argument where the clip is not of
/// it.
RootMotion takeRootMotion(Clip& clip, const Skeleton& skeleton);

}  // namespace ragtop
