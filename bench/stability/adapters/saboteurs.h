#pragma once

#include <span>

#include "../engine.h"

namespace ragtop::stability {

/// Ragtop with something wrong with it on purpose, to show that a row can fail:
///
///   hollow        bodies pass through each other
///   tilted        gravity is turned by 45° about a level axis
///   frozen        nothing moves
///   weightless    there is no gravity
///   frictionless  there is no friction, in joints neither
///   drifting      bodies shift by 1 mm/s, each its own way
///   energetic     kinetic energy grows by 1 % a second
///   late          what is told of bodies is a step old
///   limitless     joints have no limits
///   nan           after three steps no body is anywhere
///
/// In the order in which rows are tried with them.
std::span<const EngineKind> saboteurKinds();

}  // namespace ragtop::stability
