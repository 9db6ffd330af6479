#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/skeleton.h"
#include "ragtop/tunables.h"

/// Which bones of a skeleton are which parts of a body.
namespace ragtop {

/// What a part is. Forelegs and wings have the names of arms, since that is what they are.
enum class BodyRole : std::uint8_t {
    other,
    pelvis,
    abdomen,
    chest,
    head,  ///< with the neck, where that is no part of its own
    upperArm,
    forearm,
    hand,
    thigh,
    shank,
    foot,
    neck,  ///< of animals whose neck is long
    tail,
    wing,  ///< beside arms and legs
};

enum class BodySide : std::uint8_t { middle, left, right };

/// How a body is built.
enum class BodyPlan : std::uint8_t {
    other,
    human,      ///< two legs, two arms
    quadruped,  ///< four legs
    bird,       ///< two legs, two wings
    hexapod,    ///< three pairs of legs or more
};

/// "upper arm".
std::string_view nameOf(BodyRole role);
std::string_view nameOf(BodySide side);
std::string_view nameOf(BodyPlan plan);

/// A part of the body: the bone it begins at and those that follow up to the next segment.
struct Segment {
    BodyRole role = BodyRole::other;
    BodySide side = BodySide::middle;
    int bone = -1;         ///< where it begins
    int parent = -1;       ///< segment that carries it
    Vec3 end{};            ///< m in model space: the next joint, or its far tip
    float confidence = 1;  ///< of role and side: 0 nothing speaks for it, 1 all signs do, or a map says so
};

struct Anatomy {
    BodyPlan plan = BodyPlan::other;
    float confidence = 0;             ///< of the plan, 0 to 1
    std::vector<Segment> segments{};  ///< parents before children, the trunk first
    Vec3 up{0, 1, 0};                 ///< unit vectors in model space: towards the back or the head of who stands,
    Vec3 forward{0, 0, 1};            ///< where the toes point,
    Vec3 left{1, 0, 0};               ///< and the body's left
    std::string note{};               ///< what is missing, or what had to be guessed; may be empty

    bool isHuman() const { return plan == BodyPlan::human; }
    /// Index of the first segment of that role and side, −1 when there is none.
    int find(BodyRole role, BodySide side = BodySide::middle) const;
};

/// What a user knows about a bone. `other` says that it is none of the parts that have roles.
struct BoneRole {
    std::string bone{};
    BodyRole role = BodyRole::other;
    BodySide side = BodySide::middle;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BoneRole*) {
    visit(Tunable{.name = "bone", .meaning = "name of a bone of the skeleton"}, self.bone);
    visit(Tunable{.name = "role", .meaning = "the part that begins at it; other: none"}, self.role);
    visit(Tunable{.name = "side", .meaning = "middle, left or right of the body"}, self.side);
}

/// Finds the body in a skeleton: human, quadruped, bird or six-legged, in any pose, orientation and size. Signs are how
/// it branches, how long its bones are beside each other, which of them carry skin, how limbs lie at rest, and names;
/// none of them decides alone (docs/adr/0051). Sides need not be alike, and one arm or leg, hands, feet and the head
/// may be missing. Anything else comes back as `BodyPlan::other` with one segment per limb-sized bone.
///
/// `roles` are taken for granted. Throws std::invalid_argument on a bad skeleton, on a role of a bone that does not
/// exist, and where a role cannot be had together with the others.
Anatomy recognise(const Skeleton& skeleton, std::span<const BoneRole> roles = {});

/// Share of a role (one side of it) in the mass of a human; 0 where humans have no such part. `femaleShare` blends the
/// tables of men (0) and women (1).
double massShare(BodyRole role, double femaleShare);

}  // namespace ragtop
