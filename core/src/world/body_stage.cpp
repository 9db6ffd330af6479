#include "world/body_stage.h"

#include <algorithm>
#include <cmath>

#include "contacts/tuning.h"
#include "continuous/meetings.h"

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

void BodyStage::prepare(std::uint32_t index) const {
    BodyRecord& body = bodies[index];
    BodyDynamics& d = bodies.dynamics[index];
    const float h = context.h * static_cast<float>(body.direct.pace.stepFactor);
    d.linearDecay = 1 / (1 + h * body.motion.linearDamping);
    d.angularDecay = 1 / (1 + h * body.motion.angularDamping);
    const float inverseMass = bodies.states[index].invMass;
    // What has no mass has accelerations in place of forces (model/kinematic_slopes.h).
    d.acceleration =
        inverseMass > 0 ? body.motion.gravityScale * settings.gravity + inverseMass * body.force : body.force;
    d.torque = body.torque;
    // The forces of joints turn with the bodies: taking them for smooth would feed energy into every swing.
    // What joined bodies have in common is smooth, and is theirs by Articulations::move.
    d.translates = (inverseMass > 0 ? body.firstJoint == kNone : body.force != Vec3{}) ? 1.0f : 0.0f;
    const bool isAlone = body.firstJoint == kNone && body.firstContact == kNone;
    if (d.spins != 0) d.spins = isAlone ? BodyDynamics::kSpinsAlone : BodyDynamics::kSpins;
    body.force = {};
    body.torque = {};
    bodies.histories[index].rotation = body.rotation;
}

/// What iterations have worn down to nothing is nothing: floats too small for their full precision scale with nothing.
void BodyStage::stopVanishing(std::uint32_t index, float gravity) const {
    constexpr float kVanishing = 1e-12f;  // of the speed that gravity gives in a step
    BodyState& state = bodies.states[index];
    const BodyRecord& body = bodies[index];
    const float limit = kVanishing * gravity * dt;
    if (body.type != BodyType::dynamic) return;
    if (length(state.v) < limit) state.v = {};
    if (state.w == Vec3{} || !(length(state.w) * body.radius < limit)) return;
    state.w = {};
    bodies.storeMomentum(index);
}

void BodyStage::finish(std::size_t place) const {
    const float gravity = length(settings.gravity);
    const std::uint32_t index = bodies.awake[place];
    BodyRecord& body = bodies[index];
    BodyState& state = bodies.states[index];
    const StartPose start{body.center, body.rotation};
    sweptBodies.starts[place] = start;
    const bool lost = leftRange(bodies, index, dt);
    if (lost) stayPut(bodies, index);
    const float turn = 2 * length(Vec3{state.dq.x, state.dq.y, state.dq.z}) * body.travel.coreRadius;
    const float motion = length(state.dp) + turn;
    const bool fast = body.options.continuous && motion > tuning::kContinuousMotion * body.size;
    body.center = body.center + state.dp;
    if (state.dq != Quat{}) body.rotation = normalized(state.dq * body.rotation);
    sweptBodies.flags[place] = lost    ? kOutOfRange
                               : !fast ? kNotFast
                               : mayMeet(bodies, shapes, broadphase, index, {start.center, start.rotation}, dt)
                                   ? kToSweep
                                   : kFastClear;
    state.dp = {};
    state.dq = {};
    stopVanishing(index, gravity);
    const float quiet = settings.sleepSpeed * std::sqrt(gravity * body.size);
    // What is moved out of an overlap has no speed.
    const float speed = std::max(length(state.v) + length(state.w) * body.radius, motion / dt);
    const bool still = body.type == BodyType::kinematic ? speed == 0 : speed <= quiet;
    body.sleepTimer = body.options.allowSleep && still ? body.sleepTimer + dt : 0;
    const float slow = Freezing::slowest(context.gravityStep);
    freezing.record(body, speed <= slow);
    if (bodies.dynamics[index].spins == 0) bodies.restrictInertia(index);
}

}  // namespace ragtop
