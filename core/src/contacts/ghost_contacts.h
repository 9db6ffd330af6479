#pragma once

#include <cstdint>
#include <span>

#include "base/stage_runner.h"
#include "contacts/tables.h"

/// Ghost contacts, at seams between bodies. What slides from one tile of a floor to the next meets the side of the next
/// one, or its edge, before it is over it: of all directions that keep the two apart the narrow phase takes the one
/// with the widest gap. Where a body already touches something along a plane that has the other obstacle behind it,
/// that plane keeps them apart, and the contact with the other obstacle has nothing to do (docs/adr/0019).
namespace ragtop {

/// What tells ghost contacts from others: the tables, and how far the step goes.
struct GhostView {
    ConstTables tables;
    /// Per awake body, where the step began; empty while bodies are still there.
    std::span<const StartPose> starts;
    float dt, h;  ///< s, of the step and of a substep
};

/// May a contact that has points be one? Only what moves, closes by more than a little, is about to meet and bears no
/// load yet is looked at.
bool mayBeGhost(const GhostView& view, const ContactRecord& contact, const ManifoldRecord& manifold);

/// Is a point closed already, or by the end of the step?
bool willMeet(const GhostView& view, const ContactRecord& contact, const ManifoldRecord& manifold, int point);

/// Takes the points of those contacts of `closing` that are ghosts out of this step: `contacts` and `graph` are those
/// of the view. Their lanes are written anew in the next one.
void leaveOutGhosts(const GhostView& view, std::span<const std::uint32_t> closing, Contacts& contacts,
                    ConstraintGraph& graph, StageRunner& runner);

/// Is what a shape touches between it and an obstacle, on a path from one pose to another that bulges by so many metres
/// between them?
bool isKeptApart(const GhostView& view, std::uint32_t shape, std::uint32_t obstacle, const Pose& start, const Pose& end,
                 float bulge);

}  // namespace ragtop
