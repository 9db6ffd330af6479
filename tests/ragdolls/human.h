#pragma once

#include <string>

#include "ragtop/pose.h"
#include "ragtop/ragdoll.h"
#include "ragtop/skeleton.h"

namespace ragtop {

/// A person of 1.75 m in T-pose, facing z, feet at y = 0, without names that help; bone lengths after Winter 2009.
struct HumanRig {
    Skeleton skeleton;
    int hips, spine, chest, neck, head;
    int clavicle[2], upperArm[2], forearm[2], hand[2], thigh[2], shank[2], foot[2], toe[2];  ///< left, right

    HumanRig() {
        hips = add(-1, {0, 0.96f, 0});
        spine = add(hips, {0, 1.06f, 0});
        chest = add(spine, {0, 1.20f, 0});
        neck = add(chest, {0, 1.47f, 0});
        head = add(neck, {0, 1.56f, 0.02f});
        add(head, {0, 1.75f, 0.02f});
        for (int side = 0; side < 2; ++side) {
            const float x = side == 0 ? 1.0f : -1.0f;
            clavicle[side] = add(chest, {0.03f * x, 1.42f, 0});
            upperArm[side] = add(clavicle[side], {0.19f * x, 1.43f, 0});
            forearm[side] = add(upperArm[side], {0.50f * x, 1.43f, 0});
            hand[side] = add(forearm[side], {0.75f * x, 1.43f, 0});
            for (int finger = 0; finger < 4; ++finger) {
                const float z = 0.03f - 0.02f * static_cast<float>(finger);
                const int knuckle = add(hand[side], {0.84f * x, 1.43f, z});
                add(knuckle, {0.90f * x, 1.43f, z});
            }
            thigh[side] = add(hips, {0.10f * x, 0.92f, 0});
            shank[side] = add(thigh[side], {0.10f * x, 0.50f, 0.01f});
            foot[side] = add(shank[side], {0.10f * x, 0.08f, -0.02f});
            toe[side] = add(foot[side], {0.10f * x, 0.02f, 0.13f});
        }
    }

    int add(int parent, const Vec3& position) {
        skeleton.bones.push_back({"b" + std::to_string(skeleton.bones.size()), parent, {position, {}}});
        return static_cast<int>(skeleton.bones.size()) - 1;
    }

    /// Turns and scales everything.
    void transform(const Quat& rotation, float scale) {
        for (Bone& bone : skeleton.bones) {
            bone.bind.position = scale * rotate(rotation, bone.bind.position);
            bone.bind.rotation = normalized(rotation * bone.bind.rotation);
        }
    }

    Vec3 at(int bone) const { return skeleton.bones[static_cast<std::size_t>(bone)].bind.position; }
};

constexpr double kDt = 1.0 / 60;  ///< s, a step of most tests
constexpr float kDegree = kPi / 180;

inline const HumanRig& humanRig() {
    static const HumanRig rig;
    return rig;
}

/// Turns a bone against its parent, about an axis of its own.
inline void bend(LocalPose& pose, int bone, const Vec3& axis, float angle) {
    Frame& frame = pose.bones[static_cast<std::size_t>(bone)];
    frame.rotation = normalized(frame.rotation * rotationAbout(axis, angle));
}

/// That person as a ragdoll of 75 kg.
inline const RagdollDef& human() {
    static const RagdollDef def = makeRagdoll(humanRig().skeleton, {.bodyMass = 75});
    return def;
}

/// Of that ragdoll: the part that moves a bone.
inline int partOf(int bone) { return human().bones[static_cast<std::size_t>(bone)].part; }

inline float angleBetween(const Quat& a, const Quat& b) { return length(rotationVector(conjugate(a) * b)); }

}  // namespace ragtop
