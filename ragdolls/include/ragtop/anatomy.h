#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/skeleton.h"

/// Which bones of a skeleton are which parts of a human.
namespace ragtop {

enum class BodyRole : std::uint8_t {
    other,
    pelvis,
    abdomen,
    chest,
    head,  ///< with the neck
    upperArm,
    forearm,
    hand,
    thigh,
    shank,
    foot,
};

enum class BodySide : std::uint8_t { middle, left, right };

/// "upper arm".
std::string_view nameOf(BodyRole role);
std::string_view nameOf(BodySide side);

/// A part of the body: the bone it begins at and those that follow up to the next segment.
struct Segment {
    BodyRole role = BodyRole::other;
    BodySide side = BodySide::middle;
    int bone = -1;    ///< where it begins
    int parent = -1;  ///< segment that carries it
    Vec3 end{};       ///< m in model space: the next joint, or its far tip
};

struct Anatomy {
    bool humanoid = false;
    std::vector<Segment> segments{};  ///< parents before children; of a humanoid: pelvis first
    Vec3 up{0, 1, 0};                 ///< unit vectors in model space: towards the head,
    Vec3 forward{0, 0, 1};            ///< where the toes point,
    Vec3 left{1, 0, 0};               ///< and the body's left
    std::string note{};               ///< what was missing for a human, or what had to be guessed; may be empty
};

/// Finds the human in a skeleton by its branching and proportions, in any orientation; names only help where those
/// leave a choice. Anything else comes back as `humanoid == false` with one segment per limb-sized bone.
Anatomy recognise(const Skeleton& skeleton);

/// Share of a role (one side of it) in the mass of the body; 0 for `other`. `femaleShare` blends the tables of men
/// (0) and women (1).
double massShare(BodyRole role, double femaleShare);

}  // namespace ragtop
