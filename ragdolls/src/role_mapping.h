#pragma once

#include <span>
#include <vector>

#include "bone_chains.h"
#include "retarget_body.h"

namespace ragtop {

/// How one body turns as another one does.
class RoleMapping {
public:
    RoleMapping(const RetargetBody& from, const RetargetBody& to, bool keepLimits);

    /// Turns of the parts in model space for bones of the other body in its own.
    void turn(std::span<const Pose> source, std::span<Quat> parts, bool limitFeet) const;
    /// Bones for those turns, with the middle of the hip joints at `hips`, in model space.
    void place(std::span<const Pose> source, std::span<const Quat> parts, const Vec3& hips,
               std::span<Frame> bones) const;
    /// A child on that parent within the limits of its joint.
    Quat limited(int child, const Quat& parent, const Quat& turn) const;
    /// Parts that nothing of the other body stands for.
    std::vector<int> still() const;

private:
    Quat axesOf(std::span<const Pose> source, int bone) const;
    Quat wanted(std::span<const Pose> source, std::span<const Quat> parts, int part) const;
    Quat inPlane(int part, std::span<const Pose> source, const Quat& turn) const;
    Quat asAtRest(int part, std::span<const Quat> parts) const;
    int parentOf(int part) const;

    const RetargetBody& from_;
    const RetargetBody& to_;
    bool keepLimits_;
    std::vector<int> counterpart_;  ///< per part of `to`; −1: none
    std::vector<ChainBone> chains_;
    std::vector<int> chainOf_;      ///< per bone of `to`
    std::vector<int> partAt_;       ///< likewise: the part that begins at it
    int pelvis_ = -1, chest_ = -1;  ///< of `from`
};

}  // namespace ragtop
