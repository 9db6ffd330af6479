#pragma once

#include <cstddef>
#include <span>

#include "ragtop/math.h"
#include "ragtop/ragdoll.h"

/// Poses of ragdolls in few bytes, for a network or a recording: 110 for a human of 16 parts. The same bytes
/// everywhere.
namespace ragtop {

/// Bytes of a packed pose.
std::size_t packedSize(const RagdollDef& def);

/// Packs one world pose per part, as Ragdoll::partPoses gives them, into packedSize(def) bytes: rotations in 32 bits,
/// to 0.22°; the place of the root to 0.25 mm, that of each other part, to 0.9 mm, as it differs from where its joint
/// and what was packed before would have it, by up to 31 mm along each axis, which is more than joints open. False, and
/// nothing is written, where a size is wrong or a part is no number or further than 524 km from the origin.
bool pack(const RagdollDef& def, std::span<const Pose> parts, std::span<std::byte> into);
/// False, and nothing is written, where a size is wrong. Any bytes give a pose.
bool unpack(const RagdollDef& def, std::span<const std::byte> from, std::span<Pose> parts);

/// World poses of all bones, from those of the parts that carry them. False where a size is wrong.
bool poseOfBones(const RagdollDef& def, std::span<const Pose> parts, std::span<Pose> bones);

}  // namespace ragtop
