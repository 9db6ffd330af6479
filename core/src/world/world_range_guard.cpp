#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>

#include "world/world_impl.h"

namespace ragtop {

namespace {

/// m, and m in a step: no place and no motion is farther. Squares of it are still far from the end of single precision.
constexpr float kFarthest = 1e15f;

bool isNear(const Vec3& a) {
    return std::abs(a.x) <= kFarthest && std::abs(a.y) <= kFarthest && std::abs(a.z) <= kFarthest;
}

}  // namespace

/// True where a force beyond all measure, or a solver that failed, has left no motion that numbers can hold.
bool WorldImpl::leftRange(std::uint32_t index) const {
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
void WorldImpl::stayPut(std::uint32_t index) {
    BodyState& state = bodies.states[index];
    state.v = state.w = state.dp = {};
    state.dq = {};
    state.pull = bodies.inertias[index].taut = 0;
    bodies.histories[index].velocityBefore = bodies.histories[index].lastChange = {};
    bodies.refreshInertia(index);
}

/// Constraints of a body begin without a guess, or as if they had just been made.
void WorldImpl::forgetImpulses(std::uint32_t index, bool anew) {
    for (std::uint32_t key = bodies[index].firstContact; key != kNone; key = contacts.next(key)) {
        ContactRecord& record = contacts[key >> 1];
        record.bearsLoad = false;
        for (const ManifoldRecord& manifold : manifolds.of(record)) contactWriter().writeImpulses(record, manifold, {});
    }
    for (std::uint32_t key = bodies[index].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
        JointSim& joint = joints.sims[key >> 1];
        if (!anew) {
            rescaleJoint(joint, 0);
            continue;
        }
        JointSim fresh{};
        fresh.stateA = joint.stateA, fresh.stateB = joint.stateB;
        joint = fresh;
        compile(key >> 1);
    }
}

/// Whether a body can be given this. What is no number throws, but not within a step: there it is left out, and counts.
bool WorldImpl::takes(bool finite, const char* what) {
    if (finite) return true;
    if (!inStep) throw std::invalid_argument(std::string(what) + " is not finite");
    std::atomic_ref(outOfRange).fetch_add(1, std::memory_order_relaxed);
    return false;
}

/// One body's failure is not to be that of all it touches.
void WorldImpl::stopOutOfRange() {
    for (std::size_t i = 0; i < bodies.awake.size(); ++i) {
        if (sweptBodies.flags[i] != kOutOfRange) continue;
        sweptBodies.flags[i] = kNotFast;
        ++outOfRange;
        forgetImpulses(bodies.awake[i]);
    }
}

}  // namespace ragtop
