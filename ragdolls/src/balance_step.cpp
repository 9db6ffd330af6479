// A step that catches a body which its feet in place cannot hold.

#include <algorithm>
#include <cmath>

#include "balance_stand.h"
#include "leg.h"
#include "support.h"

namespace ragtop {
namespace {

constexpr float kLost = 0.005f;   ///< of the length of the legs, that the capture point is beyond the feet who step
constexpr float kTime = 0.85f;    ///< of a step, over 1/√(g/z)
constexpr float kLift = 0.07f;    ///< of the length of the legs, that a foot is lifted by
constexpr float kLanding = 0.5f;  ///< of a step, after which a foot that meets the ground has landed
constexpr float kAiming = 0.7f;   ///< of a step, up to which it is aimed
constexpr float kApart = 1.2f;    ///< of the width of a sole, that feet keep between their middles
constexpr float kBeyond = 0.15f;  ///< of the way from the other foot, that a foot goes beyond the capture point

}  // namespace

/// Where a foot that leaves the ground is to be after `time`, relative to the middle of the feet. Until then the other
/// one bears all, with its pressure p as near to the capture point ξ as its sole lets it, and ξ goes on to
/// p + (ξ − p) e^(ωt) [Koolen et al., Capturability-based analysis, 2012]. It stays on its own side.
Vec3 Balance::landing(const Stand& stand, std::size_t side, float time) const {
    const std::size_t other = 1 - side;
    const Quat& flat = feet_[other].flat;
    const Vec3 stance = level(relative(feet_[other].middle, stand.center));
    const Vec3 p =
        stance + level(rotate(flat, soles_[other].within(inverseRotate(flat, stand.capture - stance), kSoleShare)));
    const Vec3 capture = p + std::exp(stand.rate * time) * (stand.capture - p);
    Vec3 way = (1 + kBeyond) * (capture - stance);
    // Sideways it keeps apart from the other one, and no farther than the legs let it.
    const Vec3 forward = normalized(level(rotate(axes_.axesOf(legs_[other].foot, flat), {0, 0, 1})), {0, 0, 1});
    const Vec3 out = (side == 0 ? 1.0f : -1.0f) * cross(Vec3{0, 1, 0}, forward);
    const float width = 2 * std::min(length(soles_[side].halves[0]), length(soles_[side].halves[1]));
    const float across = dot(way, out);
    way += (std::max(across, kApart * width) - across) * out;
    const float most = options_.step * legs_[side].length, size = length(way);
    if (size > most) way = (most / size) * way;
    return stance + way;
}

/// With the foot that gets nearer to where the body is going to be.
void Balance::begin(const Stand& stand) {
    if (marginOf(stand.capture) > -kLost * legs_[0].length) return;
    const float time = kTime / stand.rate;
    float best = -1e9f;
    for (std::size_t side = 0; side < 2; ++side) {
        if (!feet_[1 - side].planted) continue;
        Swing next{static_cast<int>(side), 0, time, feet_[side].middle, {}};
        next.to = stand.center + landing(stand, side, time);
        // A foot that bears little leaves more of the weight where it is.
        const Swing had = std::exchange(swing_, next);
        const float caught = marginOf(stand.capture) - 0.02f * length(relative(next.to, feet_[side].middle));
        swing_ = had;
        if (caught > best) best = caught, swing_ = next;
    }
}

/// Where the foot comes from and goes to is on the ground, which may move.
void Balance::carrySwing(float dt) {
    if (!steps()) return;
    const Vec3 way = dt * feet_[static_cast<std::size_t>(1 - swing_.side)].ground;
    for (DVec3* point : {&swing_.from, &swing_.to}) *point = *point + way;
}

void Balance::swing(const Stand& stand, float dt) {
    if (!steps()) {
        begin(stand);
        return;
    }
    const auto side = static_cast<std::size_t>(swing_.side);
    swing_.age += dt;
    const bool landed = swing_.age > kLanding * swing_.time && feet_[side].planted;
    if (landed || swing_.age >= swing_.time) {
        swing_ = {};
        return;
    }
    if (swing_.age < kAiming * swing_.time) swing_.to = stand.center + landing(stand, side, swing_.time - swing_.age);
}

/// The way of a foot: s = 10 τ³ − 15 τ⁴ + 6 τ⁵ of it after τ of the time, lifted by 16 τ² (1 − τ)².
Vec3 Balance::swungTo(const Stand& stand, float age) const {
    const float t = std::clamp(age / swing_.time, 0.0f, 1.0f), s = t * t * t * (10 + t * (6 * t - 15));
    const float lift = kLift * legs_[0].length * 16 * t * t * (1 - t) * (1 - t);
    return relative(swing_.from, stand.center) + s * relative(swing_.to, swing_.from) + Vec3{0, lift, 0};
}

/// m/s², of a foot that steps.
Vec3 Balance::swungBy(float age, float dt) const {
    const Stand here{};
    return (1 / (dt * dt)) * (swungTo(here, age + dt) - 2.0f * swungTo(here, age) + swungTo(here, age - dt));
}

}  // namespace ragtop
