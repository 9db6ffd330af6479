#pragma once

#include <span>
#include <vector>

#include "ragtop/anatomy.h"
#include "ragtop/math.h"
#include "ragtop/ragdoll.h"
#include "ragtop/tunables.h"

/// Poses by the angles of anatomy, which fit any body of two arms and two legs.
namespace ragtop {

/// How one part is turned against what carries it, rad. All zero is who stands with arms that hang.
struct PartAngles {
    BodyRole role = BodyRole::other;
    BodySide side = BodySide::middle;
    float flexion = 0;    ///< forwards; of shanks backwards, of feet toes up
    float abduction = 0;  ///< away from the middle; of the trunk to the left
    float rotation = 0;   ///< about its length, outwards; of the trunk to the left
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PartAngles*) {
    visit(Tunable{.name = "role", .meaning = "the part"}, self.role);
    visit(Tunable{.name = "side", .meaning = "of the body"}, self.side);
    visit(Tunable{"flexion", "rad", -3.1416, 3.1416, "forwards; of shanks backwards, of feet toes up"}, self.flexion);
    visit(Tunable{"abduction", "rad", -3.1416, 3.1416, "away from the middle; of the trunk to the left"},
          self.abduction);
    visit(Tunable{"rotation", "rad", -3.1416, 3.1416, "about its length, outwards; of the trunk to the left"},
          self.rotation);
}

/// What a ragdoll's rest says of its body.
class BodyAxes {
public:
    /// Throws std::invalid_argument where it has no pelvis, or not a thigh on either side of it.
    explicit BodyAxes(const RagdollDef& def);

    /// Of a part: its pose in model space of who stands upright with arms that hang, x to the left, y up, z forwards.
    const Quat& zero(int part) const { return zeros_[static_cast<std::size_t>(part)]; }
    /// Index of the first part of that role and side, −1 when there is none.
    int find(BodyRole role, BodySide side) const;
    /// Rotation of x, y, z to the body's left, up and forwards, for a part that is turned so in the world.
    Quat axesOf(int part, const Quat& rotation) const { return normalized(rotation * conjugate(zero(part))); }
    const RagdollDef& def() const { return *def_; }

private:
    const RagdollDef* def_;
    std::vector<Quat> zeros_;
};

/// The turn of each joint of the definition for a pose; parts that are not named are as in who stands.
void turnsOf(const BodyAxes& axes, std::span<const PartAngles> pose, std::span<Quat> turns);

/// The world pose of each bone of who stands so with its soles on the ground: `ground` has its origin between the feet,
/// y up from it and z where the body looks. Arms of which nothing is told hang as near to the body as nothing of them
/// overlaps it. To make a Ragdoll of.
std::vector<Pose> standing(const BodyAxes& axes, const Pose& ground = {}, std::span<const PartAngles> pose = {});

}  // namespace ragtop
