#pragma once

#include <cstdint>
#include <optional>

#include "ragtop/id.h"
#include "ragtop/math.h"

namespace ragtop {

class World;
struct QueryFilter;

/// Cosine between strut and normal beyond which nothing holds up a wheel. Which ground is a wall to one is
/// findGround's.
inline constexpr float kSteepest = 0.02f;
/// Of half of a wheel's width: its tread, beyond which the shoulder of the tire passes by.
inline constexpr float kTread = 0.8f;
/// Radii from the hub within which the ground below a wheel is looked for.
inline constexpr float kFaceReach = 1.1f;
/// m/s at which a wheel comes out of ground that it has not come into.
inline constexpr float kLiftSpeed = 0.1f;

/// The plane on which a wheel stands during a step. Trivially copyable without padding: it is saved as it is.
struct GroundPlane {
    DVec3 point;  ///< at the beginning of the step
    Pose pose;    ///< of the body there
    BodyId body;
    Vec3 normal{0, 1, 0};
    Vec3 surfaceVelocity;  ///< m/s, world axes: of a conveyor
    float friction = 0;
    std::uint32_t surface = 0;
    std::uint32_t found = 0;  ///< 0: nothing below; the rest is of the last ground
    std::uint32_t moves = 0;  ///< the body is not fixed
};
static_assert(sizeof(GroundPlane) == 112);

/// The lowest point of a wheel from its hub, over a plane of normal n: straight down in the wheel's own plane. Empty
/// where the wheel lies on its side.
std::optional<Vec3> lowestPoint(const Vec3& normal, const Vec3& axle, float radius);

/// Where to look: a wheel of `radius` moves from `start`, clear above its highest place, by `translation`.
struct WheelPath {
    DVec3 start;
    Vec3 translation;
    Vec3 axis;  ///< unit, along which the hub rises
    Vec3 axle;  ///< unit, to the left
    float radius = 0, halfWidth = 0;
};

/// Finds the ground. A ball of the wheel's radius lies on faces, and on edges that its wheel meets from ahead, as the
/// wheel does. What is beside the wheel's plane meets the rims of the tread before the ball, or not at all: there three
/// circles across the width decide, by rays down and ahead.
void findGround(const World& world, const QueryFilter& query, const WheelPath& path, GroundPlane& plane);

/// The same by a ray alone, along the path through the middle of the wheel.
void findPoint(const World& world, const QueryFilter& query, const WheelPath& path, GroundPlane& plane);

/// The plane's point and normal when the ground has moved from `plane.pose` to `now`.
void movePlane(const GroundPlane& plane, const Pose& now, DVec3& point, Vec3& normal);

}  // namespace ragtop
