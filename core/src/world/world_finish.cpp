// What ends a step for each body by itself.

#include <cmath>

#include "world/world_impl.h"

namespace ragtop {

/// What iterations have worn down to nothing is nothing: floats too small for their full precision scale with nothing.
static void stopVanishing(WorldImpl& world, std::uint32_t index, float gravity) {
    constexpr float kNothing = 1e-12f;  // of the speed that gravity gives in a step
    BodyState& state = world.states[index];
    const BodyRecord& body = world.bodies[index];
    const float limit = kNothing * gravity * world.dt;
    if (body.type != BodyType::dynamic) return;
    if (length(state.v) < limit) state.v = {};
    if (state.w == Vec3{} || !(length(state.w) * body.radius < limit)) return;
    state.w = {};
    world.storeMomentum(index);
}

/// Moves a pose, notes who is quiet and who was too fast for its size.
void WorldImpl::finishBody(std::size_t place) {
    const float gravity = length(settings.gravity);
    const std::uint32_t index = awakeBodies[place];
    BodyRecord& body = bodies[index];
    BodyState& state = states[index];
    startPoses[place] = {body.center, body.rotation};
    const bool lost = leftRange(index);
    if (lost) stayPut(index);
    const float turn = 2 * length(Vec3{state.dq.x, state.dq.y, state.dq.z}) * body.coreRadius;
    const float motion = length(state.dp) + turn;
    const bool fast = body.continuous && motion > tuning::kContinuousMotion * body.size;
    body.center = body.center + state.dp;
    if (state.dq != Quat{}) body.rotation = normalized(state.dq * body.rotation);
    bodyFlags[place] = lost                                       ? kOutOfRange
                       : !fast                                    ? kNotFast
                       : mayMeet(index, startPoses[place].center) ? kToSweep
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
    if (dynamics[index].spins == 0) restrictInertia(index);
}

/// All but those of independent trees, which have done it.
void WorldImpl::finishBodies() {
    const bool independent = multirate.independentCount > 0;
    if (multirate.independentCount == awakeBodies.size()) return;
    runner.parallelFor(static_cast<int>(awakeBodies.size()), 64, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            if (!independent || (multirate.marks[awakeBodies[i]] & Multirate::kIndependent) == 0) finishBody(i);
    });
}

/// Once in a step, after the last stage that reads what bears on what.
void WorldImpl::makeRoomToFinish() {
    stageMemory.begin(StageMemory::bytesOf<StartPose>(awakeBodies.size()));
    startPoses = stageMemory.take<StartPose>(awakeBodies.size());
    startPoses.resizeForOverwrite(awakeBodies.size());
    bodyFlags.resizeForOverwrite(awakeBodies.size());
}

/// World inverse inertia of bodies that do not spin by their momentum: zero for kinematic ones; for locked axes the
/// inverse of what is left of the inertia without them.
void WorldImpl::restrictInertia(std::uint32_t index) {
    const BodyRecord& body = bodies[index];
    BodyInertia& inverse = inertias[index];
    inverse = BodyInertia{.taut = inverse.taut};
    if (body.type != BodyType::dynamic) return;
    const Mat3 r = toMat3(body.rotation);
    const Mat3 m =
        r * Mat3{body.inertia.x * Vec3{1, 0, 0}, body.inertia.y * Vec3{0, 1, 0}, body.inertia.z * Vec3{0, 0, 1}} *
        transpose(r);
    const bool x = !body.locks.rotationX, y = !body.locks.rotationY, z = !body.locks.rotationZ;
    // A locked axis becomes an infinite moment: its row and column leave the matrix before it is inverted.
    const float xx = x ? m.cx.x : 1, yy = y ? m.cy.y : 1, zz = z ? m.cz.z : 1;
    const float xy = x && y ? m.cy.x : 0, xz = x && z ? m.cz.x : 0, yz = y && z ? m.cz.y : 0;
    const float cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - xz * yy;
    const float det = xx * cxx + xy * cxy + xz * cxz;
    if (!(det > 0)) return;
    const float s = 1 / det;
    inverse.xx = x ? s * cxx : 0;
    inverse.xy = x && y ? s * cxy : 0;
    inverse.xz = x && z ? s * cxz : 0;
    inverse.yy = y ? s * (xx * zz - xz * xz) : 0;
    inverse.yz = y && z ? s * (xy * xz - xx * yz) : 0;
    inverse.zz = z ? s * (xx * yy - xy * xy) : 0;
}

}  // namespace ragtop
