#pragma once

#include <array>
#include <span>

#include "four.h"

namespace ragtop {

/// Four spring bones: what they are, where the animation has them between the last frame and this one, and how they
/// move.
struct SpringGroup {
    static constexpr int kLanes = 4;

    // What they are.
    bool roots = true;                  ///< carried by the animation alone, else by other spring bones too:
    std::array<int, kLanes> carrier{};  ///< number of a bone, group · kLanes + lane
    FourVec3 axis{};                    ///< unit, from the joint to the weight, in the bone
    Four length{}, radius{};            ///< m
    Four stiffness{}, damping{};        ///< 1/s², 1/s: ω², 2ζω
    Four sag{}, inertia{};              ///< 1/s² that gravity pulls with, 1/m: ω² tan(sag), inertia/L
    Four leastCosine{};                 ///< of the swing

    // The animation from the last frame to this one, s in [0, 1]: a + s (b − a) + s (s − 1) bow.
    FourQuat from{}, to{}, bow{};  ///< the bone's rotation
    FourQuat turnRate{};           ///< mean of the last frame, 1/s
    FourVec3 shift{}, shiftBow{};  ///< m, of the joint: b − a and bow
    FourVec3 shiftRate{};          ///< m/s, mean of the last frame
    FourVec3 offset{};             ///< m, of the joint at this frame: in the carrier, of roots from the set's origin

    // How they move, in axes that the carrier's bend turns along with it.
    FourVec3 direction{}, speed{};  ///< unit, and its rate in 1/s
    FourQuat rest{}, pace{};        ///< the animation's rotation and its mean rate in the last substep, 1/s
    FourVec3 mean{}, last{};        ///< m/s, of the animation's joint: mean of the last substep, and at its end

    // Where that has them.
    FourQuat carried{};  ///< `bend` of the carrier
    FourQuat bend{},
        rotation{};    ///< from the animation's axes to the world's, of what the bone carries; and of the bone
    FourVec3 joint{};  ///< m, from the set's origin
};

/// A ball, a capsule or a half-space at a time of a substep, from the set's origin.
struct PlacedCollider {
    bool plane = false;
    Vec3 a{}, b{};     ///< ends of the core, m; of a half-space a point of it, and its normal
    float radius = 0;  ///< m
};

/// One substep of all groups.
struct SpringPass {
    float h = 0, before = 0;   ///< s, of this substep and of the one before it
    float begin = 0, end = 1;  ///< of the frame
    Vec3 gravity{};
    bool fresh = false;  ///< nothing is known of motion before: it went on as it does now
    std::span<const PlacedCollider> colliders{};
};

/// Bones of `group` as they hang at rest at the end of a pass.
void settle(SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass);
/// Bones of `group` keep bend and swing relative to the animation, wherever it has them now.
void carry(SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass);
/// One substep; carriers have made theirs.
void advance(SpringGroup& group, std::span<const SpringGroup> groups, const SpringPass& pass);

}  // namespace ragtop
