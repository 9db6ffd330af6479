#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>

#include "base/aligned_array.h"
#include "base/stage_memory.h"
#include "model/bodies.h"
#include "narrowphase/manifold.h"
#include "ragtop/math.h"

/// Continuous collision: what a step knows of bodies that went far for their size.
namespace ragtop {

/// What a fast body meets first on its way (meetings.h).
struct Meeting {
    bool hit = false;
    float fraction = 1;  ///< of the path that was swept
    std::uint32_t shape = 0, obstacle = 0;
    Manifold touch;  ///< in the frame of the obstacle, the normal towards the shape
};

/// How far a body went in a step.
enum BodyFlag : std::uint8_t {
    kNotFast,
    kFastClear,  ///< went far for its size, but past nothing
    kToSweep,    ///< went far for its size
    kSwept,      ///< met something on its way
    kOutOfRange
};

/// An impact of a swept body, for the step's events.
struct SweptImpact {
    std::uint32_t contact, triangle;
    DVec3 point;
    Vec3 normal;  ///< from A to B
    float speed, impulse;
};

/// Where bodies began the step and how far they went, from its end to its events.
struct SweptBodies {
    explicit SweptBodies(std::pmr::memory_resource* memory) : flags(memory), impacts(memory) {}

    std::span<const StartPose> startPoses() const { return {starts.begin(), starts.end()}; }

    AlignedArray<BodyFlag> flags;       ///< per awake body
    StageArray<StartPose> starts;       ///< per awake body, in memory of the stage that finishes bodies
    AlignedArray<SweptImpact> impacts;  ///< of this step, for its events
};

}  // namespace ragtop
