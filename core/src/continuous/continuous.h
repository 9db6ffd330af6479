#pragma once

#include <functional>

#include "base/stage_runner.h"
#include "continuous/meetings.h"
#include "ragtop/world.h"

/// Continuous collision: fast bodies are swept from where they began the step to where it has brought them, and play
/// the impacts that they have on the way (docs/adr/0012).
namespace ragtop {

/// What sweeps change; bodies and contacts are those of the view.
struct SweepTarget {
    Bodies& bodies;
    Contacts& contacts;  ///< which were struck
    SweptBodies& swept;
};

/// What an impact is like.
struct ImpactRules {
    float restitutionSpeed;  ///< m/s, slowest that bounces
    /// Seen from the obstacle.
    const std::function<ContactSurface(const Meeting& meeting)>& surfaceOf;
};

/// Sweeps the bodies that are to be, so that they do not pass what their contacts did not foresee. Serial and in order
/// of the list, but for those that meet nothing.
void sweepFastBodies(const SweepView& view, const ImpactRules& rules, SweepTarget target, StageRunner& runner);

/// Solves the impact of a body that a sweep has brought to path.from at a share of the step: for the velocities with
/// which it moves in this step, which give the rest of its path, and for those with which it leaves it. `velocityAt` is
/// how the body is turned where its velocity holds. False if the rest is to be lost.
bool solveMeeting(const SweepView& view, const ImpactRules& rules, SweepTarget target, std::uint32_t body,
                  const Meeting& meeting, float done, Quat& velocityAt, SweptPath& path);

}  // namespace ragtop
