// What ends a step for each body by itself.

#include <cmath>

#include "contacts/tuning.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

/// m, and m in a step: no place and no motion is farther. Squares of it are still far from the end of single precision.
constexpr float kFarthest = 1e15f;

bool isNear(const Vec3& a) {
    return std::abs(a.x) <= kFarthest && std::abs(a.y) <= kFarthest && std::abs(a.z) <= kFarthest;
}

/// True where a force beyond all measure, or a solver that failed, has left no motion that numbers can hold.
bool leftRange(const Bodies& bodies, std::uint32_t index, float dt) {
    const BodyState& state = bodies.states[index];
    const Quat& q = state.dq;
    const DVec3 c = bodies[index].center + state.dp;
    const bool holds = isNear(state.dp) && isNear(dt * state.v) && isNear(dt * bodies[index].radius * state.w) &&
                       std::isfinite(length(state.w)) && std::isfinite(q.x + q.y + q.z + q.w) &&
                       std::abs(c.x) <= double{kFarthest} && std::abs(c.y) <= double{kFarthest} &&
                       std::abs(c.z) <= double{kFarthest};
    return !holds;
}

/// Stays where the step began, at rest.
void stayPut(Bodies& bodies, std::uint32_t index) {
    BodyState& state = bodies.states[index];
    state.v = state.w = state.dp = {};
    state.dq = {};
    state.pull = bodies.inertias[index].taut = 0;
    bodies.histories[index].velocityBefore = bodies.histories[index].lastChange = {};
    bodies.refreshInertia(index);
}

}  // namespace

/// What iterations have worn down to nothing is nothing: floats too small for their full precision scale with nothing.
static void stopVanishing(WorldImpl& world, std::uint32_t index, float gravity) {
    constexpr float kNothing = 1e-12f;  // of the speed that gravity gives in a step
    BodyState& state = world.bodies.states[index];
    const BodyRecord& body = world.bodies[index];
    const float limit = kNothing * gravity * world.dt;
    if (body.type != BodyType::dynamic) return;
    if (length(state.v) < limit) state.v = {};
    if (state.w == Vec3{} || !(length(state.w) * body.radius < limit)) return;
    state.w = {};
    world.bodies.storeMomentum(index);
}

/// Moves a pose, notes who is quiet and who was too fast for its size.
void WorldImpl::finishBody(std::size_t place) {
    const float gravity = length(settings.gravity);
    const std::uint32_t index = bodies.awake[place];
    BodyRecord& body = bodies[index];
    BodyState& state = bodies.states[index];
    sweptBodies.starts[place] = {body.center, body.rotation};
    const bool lost = leftRange(bodies, index, dt);
    if (lost) stayPut(bodies, index);
    const float turn = 2 * length(Vec3{state.dq.x, state.dq.y, state.dq.z}) * body.coreRadius;
    const float motion = length(state.dp) + turn;
    const bool fast = body.continuous && motion > tuning::kContinuousMotion * body.size;
    body.center = body.center + state.dp;
    if (state.dq != Quat{}) body.rotation = normalized(state.dq * body.rotation);
    sweptBodies.flags[place] = lost    ? kOutOfRange
                               : !fast ? kNotFast
                               : mayMeet(bodies, shapes, broadphase, index, sweptBodies.starts[place].center)
                                   ? kToSweep
                                   : kFastClear;
    state.dp = {};
    state.dq = {};
    stopVanishing(*this, index, gravity);
    const float quiet = settings.sleepSpeed * std::sqrt(gravity * body.size);
    const float speed = length(state.v) + length(state.w) * body.radius;
    const bool still = body.type == BodyType::kinematic ? speed == 0 : speed <= quiet;
    body.sleepTimer = body.allowSleep && still ? body.sleepTimer + dt : 0;
    const float slow = Freezing::slowest(context.gravityStep);
    freezing.record(body, speed <= slow && motion <= slow * dt);
    if (bodies.dynamics[index].spins == 0) bodies.restrictInertia(index);
}

/// All but those of independent trees, which have done it.
void WorldImpl::finishBodies() {
    const bool independent = directSet.multirate.independentCount > 0;
    if (directSet.multirate.independentCount == bodies.awake.size()) return;
    runner.parallelFor(static_cast<int>(bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            if (!independent || (directSet.multirate.marks[bodies.awake[i]] & Multirate::kIndependent) == 0)
                finishBody(i);
    });
}

/// Once in a step, after the last stage that reads what bears on what.
void WorldImpl::makeRoomToFinish() {
    stageMemory.begin(StageMemory::bytesOf<StartPose>(bodies.awake.size()));
    sweptBodies.starts = stageMemory.take<StartPose>(bodies.awake.size());
    sweptBodies.starts.resizeForOverwrite(bodies.awake.size());
    sweptBodies.flags.resizeForOverwrite(bodies.awake.size());
}

}  // namespace ragtop
