#include "wheel_ground.h"

#include <cmath>

#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr float kSteepest = 0.2f;  ///< cosine between strut and normal beyond which a surface is a wall to the wheel

/// What is around the start of the path has no normal there: the wheel is beside it or in it, not above.
bool isGround(const Hit& hit, const WheelPath& path) {
    return hit && hit.fraction > 0 && dot(hit.normal, path.axis) > kSteepest;
}

Hit castBall(const World& world, const QueryFilter& filter, const WheelPath& path) {
    const Hit hit = world.castShape(Sphere{path.radius}, Quat{}, {path.start, path.translation}, filter);
    if (!isGround(hit, path)) return {};
    const float beside = dot(relative(hit.point, path.start) - hit.fraction * path.translation, path.axle);
    return std::abs(beside) <= path.halfWidth ? hit : Hit{};
}

Hit castRays(const World& world, const QueryFilter& filter, const WheelPath& path) {
    Hit highest;
    const Vec3 reach = path.translation - path.radius * path.axis;
    for (const float side : {0.0f, -0.9f, 0.9f}) {
        const Hit hit = world.castRay({path.start + side * path.halfWidth * path.axle, reach}, filter);
        if (isGround(hit, path) && (!highest || hit.fraction < highest.fraction)) highest = hit;
    }
    return highest;
}

}  // namespace

void findGround(const World& world, BodyId chassis, const Filter& filter, const WheelPath& path, GroundPlane& plane) {
    const QueryFilter query{.category = filter.category, .mask = filter.mask, .ignore = chassis};
    Hit hit = castBall(world, query, path);
    if (!hit) hit = castRays(world, query, path);
    plane.found = hit ? 1 : 0;
    if (!hit) return;
    const Material material = world.material(hit.shape);
    plane.point = hit.point;
    plane.pose = world.pose(hit.body);
    plane.body = hit.body;
    plane.normal = hit.normal;
    plane.surfaceVelocity = rotate(plane.pose.rotation, material.surfaceVelocity);
    plane.friction = material.friction;
    plane.surface = hit.surface;
    plane.moves = world.type(hit.body) == BodyType::fixed ? 0 : 1;
}

void movePlane(const GroundPlane& plane, const Pose& now, DVec3& point, Vec3& normal) {
    const Quat turn = now.rotation * conjugate(plane.pose.rotation);
    point = now.position + rotate(turn, relative(plane.point, plane.pose.position));
    normal = rotate(turn, plane.normal);
}

}  // namespace ragtop
