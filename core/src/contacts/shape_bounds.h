#pragma once

#include <cstdint>
#include <span>

#include "base/stage_runner.h"
#include "broadphase/broadphase.h"
#include "model/bodies.h"
#include "model/shapes.h"

namespace ragtop {

/// The bounds of shapes in the trees of the broad phase: enlarged, and counting the motion of the coming step, so that
/// few leave theirs.
struct ShapeBounds {
    Bodies& bodies;
    Shapes& shapes;
    Broadphase& broadphase;
    float dt;  ///< s, of the step

    /// Where a shape is and, going on as it does, will be after so many seconds.
    Bounds tightBounds(const ShapeRecord& shape, float ahead) const;
    void insertProxy(std::uint32_t shape) const;
    void removeProxy(std::uint32_t shape) const;
    /// The shape looks for partners in the next step.
    void markMoved(std::uint32_t shape) const;
    /// Bounds that are made now leave room; where there are several shapes, the one that has least is not known.
    void giveRoom(std::uint32_t body) const;
    /// Bounds made at the end of a step count the motion of the next one, going on as it does; what was set going since
    /// is not in them.
    void recordNewVelocity(std::uint32_t body) const;
    /// `all`: this step is longer than the one that bounds were made for, as the first one is. What moves is met in
    /// this step; obstacles that stand still are swept to, and looked for in the next one.
    void coverNewVelocities(bool all) const;
    /// Bounds that were left since the poses of `starts`, one per awake body, are enlarged in place; their shapes look
    /// for partners in the next step, in the order of the bodies.
    void refit(std::span<const StartPose> starts, StageRunner& runner) const;

private:
    void coverMotion(std::uint32_t body) const;
};

}  // namespace ragtop
