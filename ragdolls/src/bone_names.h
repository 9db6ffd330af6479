#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ragtop {

/// Which joint or part a name speaks of. Names never decide alone: they weigh against proportions.
enum class NameHint : std::uint8_t {
    none,
    pelvis,
    spine,
    chest,
    neck,
    head,
    clavicle,
    shoulder,
    elbow,
    wrist,
    finger,
    hip,
    knee,
    ankle,
    toe,
    tail,
    wing,
    shoulderOrClavicle,  ///< "LeftShoulder" is either, by what else there is
    arm,                 ///< some bone of an arm
    leg,                 ///< some bone of a leg
};

struct BoneName {
    NameHint hint = NameHint::none;
    int side = 0;        ///< −1 left, 1 right, 0 unknown
    int end = 0;         ///< 1 of the front legs, −1 of the hind ones, 0 unknown
    bool beast = false;  ///< paws, hooves and hocks
    bool loose = false;  ///< a control, or hair, cloth or a thing carried: no part of the body
};

BoneName readName(const std::string& name);

/// The hints of a limb from its root to its tip, with "arm", "leg" and "shoulder" replaced by the joints they mean
/// beside the other names, or by nothing where they mean none.
std::vector<NameHint> jointHints(std::span<const NameHint> chain);

}  // namespace ragtop
