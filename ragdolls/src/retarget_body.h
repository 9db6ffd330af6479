#pragma once

#include <array>
#include <vector>

#include "ragtop/body_pose.h"
#include "ragtop/pose.h"

namespace ragtop {

/// Where a foot meets the ground, in its bone.
struct FootPoints {
    int part = -1;
    Vec3 joint{}, heel{}, ball{}, tip{};  ///< m; where it has no toes that bend, the ball is its tip
    float halfWidth = 0;                  ///< m, of the sole
};

/// What clips are carried over by: axes of each part that lie alike in all bodies, however they rest.
struct RetargetBody {
    /// Throws std::invalid_argument where it has no pelvis, or not a thigh on either side of it.
    explicit RetargetBody(const RagdollDef& def);

    const RagdollDef& def;
    BodyAxes body;
    Skeleton skeleton;
    Quat heading{};                    ///< of x to the left, y up, z forwards in model space
    std::vector<Quat> axes{};          ///< per bone: those of its part, in it
    std::vector<int> carrier{};        ///< per part: the joint that carries it, −1: none
    std::array<int, 2> thighs{};       ///< left, right
    std::array<FootPoints, 2> feet{};  ///< left, right
    Vec3 hips{};                       ///< m, between the hip joints at rest
    float ground = 0;                  ///< m, of the soles at rest
    float height = 1;                  ///< m, of the hip joints over the soles of straight legs

    const RagdollPart& part(int index) const { return def.parts[static_cast<std::size_t>(index)]; }
    Vec3 jointInBone(int part) const;
    Vec3 jointAtRest(int part) const { return transformPoint(this->part(part).bind, jointInBone(part)); }

private:
    Vec3 lateral(BodyRole role) const;
    void findHeading();
    Quat restAxes(int part) const;
    Quat limbAxes(int part) const;
    void placeFeet(std::vector<Quat>& rest);
    float placeFoot(std::size_t side, std::vector<Quat>& rest);
    void putOnSole(FootPoints& foot, const Quat& lies) const;
};

/// The joint at the far end of a part, or −1: the first that it carries.
int jointBeyond(const RagdollDef& def, int part);

}  // namespace ragtop
