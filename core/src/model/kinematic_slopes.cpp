#include "model/kinematic_slopes.h"

#include <algorithm>

namespace ragtop {

namespace {

/// What two changes in a row have in common.
Vec3 common(const Vec3& last, const Vec3& now) {
    const float square = lengthSquared(now);
    return square > 0 ? std::clamp(dot(last, now) / square, 0.0f, 1.0f) * now : Vec3{};
}

void speedUp(Bodies& bodies, const KinematicSlope& slope, const Vec3& a, const Vec3& alpha, int substeps) {
    BodyState& state = bodies.states[slope.body];
    const float h = slope.dt / static_cast<float>(substeps);
    state.v = slope.v - 0.5f * slope.dt * a;
    // As if the substep before had changed it as much: the position map takes the acceleration for a smooth one.
    bodies.histories[slope.body].velocityBefore = state.v - h * a;
    // Turning goes by the velocity at the end of each substep, whose mean is half a substep ahead.
    state.w = slope.w - 0.5f * (slope.dt + h) * alpha;
    bodies[slope.body].force = a;
    bodies[slope.body].torque = alpha;
}

}  // namespace

std::size_t KinematicSlopes::placeOf(std::uint32_t body) const {
    const auto at = std::lower_bound(slopes_.begin(), slopes_.end(), body,
                                     [](const KinematicSlope& slope, std::uint32_t b) { return slope.body < b; });
    return static_cast<std::size_t>(at - slopes_.begin());
}

bool KinematicSlopes::holds(std::size_t place, std::uint32_t body) const {
    return place < slopes_.size() && slopes_[place].body == body;
}

void KinematicSlopes::record(const Bodies& bodies, std::uint32_t body, float lastStep) {
    const std::uint32_t generation = bodies.slots.generation(body);
    const std::size_t place = placeOf(body);
    if (holds(place, body) && slopes_[place].generation == generation) return;
    if (!holds(place, body)) {
        slopes_.push({});
        std::copy_backward(slopes_.begin() + place, slopes_.end() - 1, slopes_.end());
    }
    const BodyState& state = bodies.states[body];
    slopes_[place] = {body, generation, lastStep, state.v, state.w, {}, {}};
}

void KinematicSlopes::replace(Bodies& bodies, std::uint32_t body, const Vec3& v, const Vec3& w) {
    const std::size_t place = placeOf(body);
    if (!holds(place, body)) return;
    slopes_[place].v = v;
    slopes_[place].w = w;
    bodies.dynamics[body].acceleration = bodies.dynamics[body].torque = {};
}

void KinematicSlopes::begin(Bodies& bodies, float dt, int substeps) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < slopes_.size(); ++i) {
        KinematicSlope slope = slopes_[i];
        const std::uint32_t body = slope.body;
        if (bodies.slots.generation(body) != slope.generation || bodies[body].type != BodyType::kinematic ||
            !bodies.isAwake(body))
            continue;
        const BodyState& state = bodies.states[body];
        const float perSecond = 2 / (slope.dt + dt);  // from the middle of one step to that of the next
        const Vec3 a = perSecond * (state.v - slope.v), alpha = perSecond * (state.w - slope.w);
        const Vec3 smooth = common(slope.acceleration, a), turning = common(slope.angularAcceleration, alpha);
        if (a == Vec3{} && alpha == Vec3{}) continue;
        slope = {body, slope.generation, dt, state.v, state.w, a, alpha};
        if (smooth != Vec3{} || turning != Vec3{}) speedUp(bodies, slope, smooth, turning, substeps);
        slopes_[kept++] = slope;
    }
    slopes_.resizeForOverwrite(kept);
}

void KinematicSlopes::end(Bodies& bodies) const {
    for (const KinematicSlope& slope : slopes_) {
        bodies.states[slope.body].v = slope.v;
        bodies.states[slope.body].w = slope.w;
    }
}

}  // namespace ragtop
