#pragma once

#include "base/stage_runner.h"
#include "model/bodies.h"
#include "model/joints.h"

/// What springs lead their bodies by between steps (constraints/spring_lead.h).
namespace ragtop {

/// After joints came, went or changed.
void collectSprings(Joints& joints, const ConstraintGraph& graph);
/// Before the first substep of h seconds, and after the last one.
enum class Lead { begin, end };
void leadSprings(Joints& joints, Bodies& bodies, float h, Lead when, StageRunner& runner);

}  // namespace ragtop
