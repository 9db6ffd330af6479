#pragma once

#include <atomic>
#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"

namespace ragtop {

/// What a step finds of an awake contact; the last three come beside the others: that it may be a ghost, that other
/// points hold a body on what does not move, and that it had no manifold before.
enum ContactChange : std::uint8_t { kUnchanged = 0, kApart = 1, kGraph = 2, kCloses = 4, kPoints = 8, kFound = 16 };

/// A contact for which a step found a change, of ContactChange.
struct ChangedContact {
    std::uint32_t contact;
    std::uint8_t change;
};

/// What a step finds of contacts, from colliding them to telling its events. Nothing of it is saved.
struct ContactFinds {
    explicit ContactFinds(std::pmr::memory_resource* memory)
        : change(memory),
          changed(memory),
          shiftedBodies(memory),
          closing(memory),
          fresh(memory),
          laneTouches(memory),
          dirty(memory) {}

    AlignedArray<std::uint8_t> change;  ///< per awake contact: a ContactChange, and later whether it is to be asked
    AlignedArray<ChangedContact> changed;
    AlignedArray<std::uint32_t> shiftedBodies;  ///< that other points of the ground hold than before
    AlignedArray<std::uint32_t> closing;        ///< that may be ghosts, or woke in this step
    AlignedArray<std::uint32_t> fresh;          ///< manifolds made in this step, of bodies that have not moved yet
    AlignedArray<std::uint8_t> laneTouches;     ///< per lane of a colour, a ManifoldTouch
    AlignedArray<std::uint32_t> dirty;          ///< that came since events were told, or were struck before
    bool allDirty = true;                       ///< all contacts are to be asked whether they touch
    bool surfacesForgotten = false;             ///< lanes are to be told anew what the surfaces are
    bool motionReported = false;                ///< has any shape told of its motion?
    std::atomic<bool> anySensor{false};         ///< is any awake contact one?
};

}  // namespace ragtop
