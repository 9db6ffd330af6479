#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "broadphase/broadphase.h"
#include "contacts/ghost_contacts.h"
#include "continuous/swept_bodies.h"
#include "continuous/swept_motion.h"

/// What bodies meet on the way that they went in a step.
namespace ragtop {

/// What sweeps read: poses are those of the end of the step.
struct SweepView {
    ConstTables tables;
    const Broadphase& broadphase;
    std::span<const StartPose> starts;  ///< per awake body, of the beginning of the step
    float dt, h;                        ///< s, of the step and of a substep
    /// May a shape meet that of another body at all?
    const std::function<bool(std::uint32_t shape, std::uint32_t obstacle)>& mayCollide;

    GhostView ghosts() const { return {tables, starts, dt, h}; }
};

/// Does the ball that holds a body come near anything on which a sweep over a step of dt seconds from `start` could
/// end?
bool mayMeet(const Bodies& bodies, const Shapes& shapes, const Broadphase& broadphase, std::uint32_t body,
             const Pose& start, float dt);

/// How a body moved in a step of dt seconds: straight, and turning evenly, as many revolutions as its speed tells.
SweptPath pathOfStep(const Bodies& bodies, std::span<const StartPose> starts, float dt, std::uint32_t body);
inline SweptPath pathOfStep(const SweepView& view, std::uint32_t body) {
    return pathOfStep(view.tables.bodies, view.starts, view.dt, body);
}

/// The first surface that a body would go into on its way from a pose at the share `done` of the step to one at
/// `until`.
Meeting firstMeeting(const SweepView& view, std::uint32_t body, const Pose& start, const Pose& end, float done,
                     float until);

/// The same of one shape of it, a mesh, where that is before `first`.
void sweepMesh(const SweepView& view, std::uint32_t body, std::uint32_t shape, const Pose& start, const Pose& end,
               float done, float until, Meeting& first);

}  // namespace ragtop
