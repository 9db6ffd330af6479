#include "wheel_ground.h"

#include <cmath>

#include "ragtop/world.h"

namespace ragtop {
namespace {

/// What is around the start of the path has no normal there: the wheel is beside it or in it, not above.
bool isGround(const Hit& hit, const WheelPath& path) {
    return hit && hit.fraction > 0 && dot(hit.normal, path.axis) > kSteepest;
}

/// A cast of a ball ends within its tolerance, which a stiff tire feels: where the ball lies on a face, a ray tells
/// where that is.
void polish(const World& world, const QueryFilter& filter, const WheelPath& path, Hit& hit) {
    constexpr float kOneFace = 0.995f, kReach = 1.1f;
    const DVec3 center = path.start + hit.fraction * path.translation;
    const Hit face = world.castRay({center, -kReach * path.radius * hit.normal}, filter);
    if (!face || !(face.body == hit.body) || !(dot(face.normal, hit.normal) > kOneFace)) return;
    hit.point = face.point;
    hit.normal = face.normal;
}

Hit castBall(const World& world, const QueryFilter& filter, const WheelPath& path) {
    Hit hit = world.castShape(Sphere{path.radius}, Quat{}, {path.start, path.translation}, filter);
    if (!isGround(hit, path)) return {};
    const float beside = dot(relative(hit.point, path.start) - hit.fraction * path.translation, path.axle);
    // Beyond it the shoulder of the tire passes by, and what the side meets is none of this.
    constexpr float kTread = 0.8f;
    if (!(std::abs(beside) <= kTread * path.halfWidth)) return {};
    polish(world, filter, path, hit);
    return hit;
}

Hit castRays(const World& world, const QueryFilter& filter, const WheelPath& path) {
    Hit highest;
    const Vec3 reach = path.translation - path.radius * path.axis;
    for (const float side : {0.0f, -0.8f, 0.8f}) {
        const Hit hit = world.castRay({path.start + side * path.halfWidth * path.axle, reach}, filter);
        if (isGround(hit, path) && (!highest || hit.fraction < highest.fraction)) highest = hit;
    }
    return highest;
}

void take(const World& world, const Hit& hit, GroundPlane& plane) {
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

QueryFilter queryOf(const Filter& filter, BodyId chassis) {
    return {.category = filter.category, .mask = filter.mask, .ignore = chassis};
}

}  // namespace

void findGround(const World& world, BodyId chassis, const Filter& filter, const WheelPath& path, GroundPlane& plane) {
    const QueryFilter query = queryOf(filter, chassis);
    Hit hit = castBall(world, query, path);
    if (!hit) hit = castRays(world, query, path);
    take(world, hit, plane);
}

void findPoint(const World& world, BodyId chassis, const Filter& filter, const WheelPath& path, GroundPlane& plane) {
    const Hit hit = world.castRay({path.start, path.translation}, queryOf(filter, chassis));
    take(world, isGround(hit, path) ? hit : Hit{}, plane);
}

void movePlane(const GroundPlane& plane, const Pose& now, DVec3& point, Vec3& normal) {
    const Quat turn = now.rotation * conjugate(plane.pose.rotation);
    point = now.position + rotate(turn, relative(plane.point, plane.pose.position));
    normal = rotate(turn, plane.normal);
}

}  // namespace ragtop
