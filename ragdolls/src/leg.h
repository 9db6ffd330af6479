#pragma once

#include <optional>
#include <span>

#include "ragtop/body_pose.h"

namespace ragtop {

/// A leg of thigh, shank and foot: which joints turn how for a foot to be somewhere.
struct Leg {
    int hip = -1, knee = -1, ankle = -1;    ///< joints of the definition
    int thigh = -1, shank = -1, foot = -1;  ///< parts
    Vec3 hipInPelvis{}, hipInThigh{}, kneeInThigh{}, kneeInShank{}, ankleInShank{}, ankleInFoot{};  ///< m
    Vec3 kneeAxis{};                                                                                ///< in the thigh
    Range kneeRange{};                                                                              ///< rad
    float length = 0;  ///< m, of thigh and shank

    /// Rotations of the parts, in the axes of the pelvis' pose, that take the foot there; as near as the leg reaches.
    struct Bent {
        Quat thigh{}, shank{}, foot{};
    };
    Bent reach(const BodyAxes& axes, const Quat& pelvis, const Vec3& hip, const Quat& foot, const Vec3& ankle) const;
    /// The same, the thigh turning the shortest way from where it is, `from`.
    Bent reachFrom(const RagdollDef& def, const Quat& from, const Vec3& hip, const Quat& foot, const Vec3& ankle) const;
};

/// None where a part or joint of it is missing or the knee is no hinge.
std::optional<Leg> legOf(const BodyAxes& axes, BodySide side);
/// Turn of a joint between parts that are turned so.
Quat turnOf(const RagdollJoint& joint, const Quat& parent, const Quat& child);

}  // namespace ragtop
