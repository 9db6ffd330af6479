#pragma once

#include <cstdint>
#include <span>

#include "world/energy_guard.h"

/// What becomes of bodies whose step the energy guard undoes: they stay where and as fast as they were, and what
/// nothing holds goes on with its centre of mass, which no solver is needed for. Where that happens again at once,
/// repeating the step would repeat its end, so that something has to change:
///   – who solves the island: what is iterated is solved directly, and the other way round;
///   – half of the speeds against each other are lost; of jointed bodies that hang or stand, of all speeds.
/// All of this lowers energies, and what is undone for ever comes to rest.
namespace ragtop {

/// It falls back to iteration for a while: a direct solve of joints that stand open, or of motions far from its linear
/// ones, is none.
void barDirect(const GuardView& view, std::span<const std::uint32_t> group);
/// Bodies stay where they were, and joints have counted no turns. `isFree`: nothing that does not move holds or touches
/// the group.
void undoPlaces(const GuardView& view, std::span<const std::uint32_t> group, bool isFree);
/// Takes so much energy (J), or what there is of it, by undoing a share of all impulses of the step, so that momenta
/// stay among those who handed them over; tells how much that was.
double undoImpulses(const GuardView& view, std::span<const std::uint32_t> group, double energy);
/// A step that left nothing which could be mended is as if it had not been: bodies are as fast as they were too, and
/// the next begins without impulses.
void undoMotion(const GuardView& view, std::span<const std::uint32_t> group, bool isFree);

}  // namespace ragtop
