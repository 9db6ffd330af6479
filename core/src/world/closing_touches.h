#pragma once

#include <cstdint>
#include <span>

#include "base/aligned_array.h"
#include "direct/closing_point.h"
#include "ragtop/math.h"

/// Contact points between bodies of a group, and between these and what is fixed, beside which the group's joints are
/// closed: what closes a joint drives no part into another.
namespace ragtop {

struct ClosingView;

/// A contact point, and how near its surfaces may come: an overlap with which the step began may stay, since contacts
/// push bodies out slowly on purpose.
struct ClosingTouch {
    std::uint32_t bodyA = 0, bodyB = 0;
    Vec3 normal;            ///< in A's internal frame, from A to B
    Vec3 anchorA, anchorB;  ///< m, in the bodies' internal frames
    float separation = 0;   ///< m, where the anchors met
    float least = 0;        ///< m, of separation; 0 or below
    float size = 0;         ///< m, of the smaller body
    bool isInner = false;   ///< both bodies are of the group
};

/// Those of a group of the energy guard.
void findTouches(const ClosingView& world, std::span<const std::uint32_t> group, AlignedArray<ClosingTouch>& touches);
/// Adds points of convex parts that have come into each other where the step knew of no contact, or not of this side of
/// it, by more than so many of their sizes; `again` if that was done before. Tells whether there are any.
bool addMissedTouches(const ClosingView& world, std::span<const std::uint32_t> group, float sizes, bool again,
                      AlignedArray<ClosingTouch>& touches);
/// Where they are now.
void placeTouches(const ClosingView& world, std::span<const ClosingTouch> touches,
                  AlignedArray<direct::ClosingPoint>& points);
/// How much nearer than they may parts of the group are to each other, in sizes of the smaller one; 0 where none is.
float deepestTouch(const ClosingView& world, std::span<const ClosingTouch> touches);
/// The same of a group whose touches were not found.
float deepestTouch(const ClosingView& world, std::span<const std::uint32_t> group);

}  // namespace ragtop
