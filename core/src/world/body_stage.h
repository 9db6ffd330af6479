#pragma once

#include <cstdint>

#include "activity/activity.h"
#include "broadphase/broadphase.h"
#include "continuous/swept_bodies.h"
#include "model/bodies.h"
#include "model/shapes.h"
#include "ragtop/settings.h"

namespace ragtop {

/// What begins and ends a step for each body by itself; on any thread.
struct BodyStage {
    Bodies& bodies;
    const Shapes& shapes;
    const Broadphase& broadphase;
    SweptBodies& sweptBodies;  ///< where each began, and whether it went far
    Freezing& freezing;
    const SolverContext& context;
    const WorldSettings& settings;
    float dt;

    /// Accelerations and damping of the substeps, from the forces given, which this uses up.
    void prepare(std::uint32_t body) const;
    /// Moves the pose of a place in the list of awake bodies, notes who is quiet and who was too fast for its size.
    void finish(std::size_t awakePlace) const;

private:
    void stopVanishing(std::uint32_t body, float gravity) const;
};

}  // namespace ragtop
