#include "wheel_ground.h"

#include <algorithm>
#include <cmath>

#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Cosines to the axis below which ground is a wall: of what an edge has for a normal in the plane of the wheel, which
/// climbs what is nine tenths of its radius high, and of a face: a corner of the wheel's hull is that far from ahead.
constexpr float kSteepestEdge = 0.1f, kSteepestFace = 0.19f;

/// What is around the start of the path has no normal there: the wheel is beside it or in it, not above.
bool isGround(const Hit& hit, const WheelPath& path) {
    const float across = dot(hit.normal, path.axle), inPlane = std::sqrt(std::max(1 - across * across, 0.0f));
    return hit && hit.fraction > 0 && dot(hit.normal, path.axis) > kSteepestEdge * inPlane;
}

/// Is that a wall, where it is a face?
bool isWall(const Hit& hit, const WheelPath& path) { return !(dot(hit.normal, path.axis) > kSteepestFace); }

/// A cast of a ball ends within its tolerance at what has no triangles, which a stiff tire feels: where the ball lies
/// on a face, a ray tells where that is.
bool lieOnFace(const World& world, const QueryFilter& filter, const WheelPath& path, Hit& hit) {
    constexpr float kOneFace = 0.995f;
    if (hit.onFace) return true;
    const DVec3 center = path.start + hit.fraction * path.translation;
    const Hit face = world.castRay({center, -kFaceReach * path.radius * hit.normal}, filter);
    if (!face || !(face.body == hit.body) || !(dot(face.normal, hit.normal) > kOneFace)) return false;
    hit.point = face.point;
    hit.normal = face.normal;
    return true;
}

/// Does the wheel lie as the ball does? Beyond the tread the shoulder of the tire passes by, and what the side meets is
/// none of this. Of what is as steep as a wall circles tell whether it is one, or an edge.
bool liesAsWheel(const World& world, const QueryFilter& filter, const WheelPath& path, Hit& hit) {
    constexpr float kMostDeeper = 2e-3f;  // of the radius, by which a rim may be deeper than the ball
    const float beside = dot(relative(hit.point, path.start) - hit.fraction * path.translation, path.axle);
    if (!(std::abs(beside) <= kTread * path.halfWidth) || isWall(hit, path)) return false;
    const float deeper = std::abs(dot(hit.normal, path.axle)) * kTread * path.halfWidth;
    return lieOnFace(world, filter, path, hit) || deeper < kMostDeeper * path.radius;
}

/// The highest that circles across a wheel lie on, as where the middle of the wheel does.
struct Highest {
    Hit hit;
    float rise = 0;  ///< m along the axis, of the hub from the path's start

    void offer(const Hit& found, float rises) {
        if (hit && !(rises > rise)) return;
        hit = found;
        rise = rises;
    }
};

/// Straight down.
void offerFloor(const World& world, const QueryFilter& filter, const WheelPath& path, float aside, Highest& highest) {
    const Vec3 reach = path.translation - path.radius * path.axis;
    const Hit hit = world.castRay({path.start + aside * path.axle, reach}, filter);
    if (!isGround(hit, path) || isWall(hit, path)) return;
    const std::optional<Vec3> lowest = lowestPoint(hit.normal, path.axle, path.radius);
    if (!lowest) return;
    highest.offer(hit, dot(relative(hit.point, path.start) - *lowest, hit.normal) / dot(path.axis, hit.normal));
}

/// An edge that a ball lies on: the line between what is before it and what is on top.
struct Edge {
    Vec3 along, inward;  ///< unit; inward from the hub, across the axis
    Hit ball;
};

constexpr float kNear = 5e-3f;  ///< of the radius: how far beside an edge its faces are looked for

/// What a ray at an edge meets a little below it, from before.
Hit faceBelow(const World& world, const QueryFilter& filter, const WheelPath& path, const Edge& edge,
              const DVec3& point) {
    const float near = kNear * path.radius;
    return world.castRay({point - near * (path.axis + edge.inward), 2 * near * edge.inward}, filter);
}

std::optional<Edge> edgeUnder(const World& world, const QueryFilter& filter, const WheelPath& path, const Hit& ball) {
    const Vec3 inward = normalized(dot(ball.normal, path.axis) * path.axis - ball.normal);
    Edge edge{{}, inward, ball};
    const float near = kNear * path.radius;
    const Hit face = faceBelow(world, filter, path, edge, ball.point);
    const Hit top = world.castRay({ball.point + near * (path.axis + inward), -2 * near * path.axis}, filter);
    if (!face || !top || !(face.body == ball.body) || !(top.body == ball.body)) return {};
    edge.along = cross(face.normal, top.normal);
    if (!(length(edge.along) > 0.1f)) return {};
    edge.along = normalized(edge.along);
    return edge;
}

/// Where a circle meets it: at q from where the hub starts, and |q − x a| = R in the plane of the circle.
void offerEdge(const World& world, const QueryFilter& filter, const WheelPath& path, const Edge& edge, float aside,
               Highest& highest) {
    constexpr float kLeast = 0.05f;  // sine between edge and circle
    const Vec3 left = path.axle, at = relative(edge.ball.point, path.start);
    const float across = dot(edge.along, left);
    if (!(std::abs(across) > kLeast)) return;
    const Vec3 met = at + ((aside - dot(at, left)) / across) * edge.along;
    const Vec3 q = met - dot(met, left) * left, up = path.axis - dot(path.axis, left) * left;
    const float squared = dot(up, up), b = dot(q, up) / squared;
    const float c = (dot(q, q) - path.radius * path.radius) / squared;
    if (!(b * b > c)) return;
    const float rise = b + std::sqrt(b * b - c);
    Vec3 normal = normalized(cross(cross(left, q - rise * up), edge.along));
    if (dot(normal, path.axis) < 0) normal = -normal;
    Hit hit = edge.ball;
    hit.normal = normal;
    const std::optional<Vec3> lowest = lowestPoint(normal, left, path.radius);
    if (!lowest || !isGround(hit, path)) return;
    if (!(faceBelow(world, filter, path, edge, path.start + met).body == hit.body)) return;
    hit.point = path.start + (rise * path.axis + *lowest);
    highest.offer(hit, rise);
}

Hit castCircles(const World& world, const QueryFilter& filter, const WheelPath& path, const Hit& ball) {
    Highest highest;
    const std::optional<Edge> edge = isGround(ball, path) ? edgeUnder(world, filter, path, ball) : std::nullopt;
    for (const float side : {0.0f, -kTread, kTread}) {
        offerFloor(world, filter, path, side * path.halfWidth, highest);
        if (edge) offerEdge(world, filter, path, *edge, side * path.halfWidth, highest);
    }
    return highest.hit;
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

}  // namespace

std::optional<Vec3> lowestPoint(const Vec3& normal, const Vec3& axle, float radius) {
    constexpr float kFlattest = 0.2f;  // sine between axle and normal below which it lies on its side
    const Vec3 inWheel = normal - dot(normal, axle) * axle;
    const float across = length(inWheel);
    if (!(across > kFlattest)) return {};
    return (-radius / across) * inWheel;
}

void findGround(const World& world, const QueryFilter& query, const WheelPath& path, GroundPlane& plane) {
    Hit hit = world.castShape(Sphere{path.radius}, Quat{}, {path.start, path.translation}, query);
    if (!isGround(hit, path) || !liesAsWheel(world, query, path, hit)) hit = castCircles(world, query, path, hit);
    take(world, hit, plane);
}

void findPoint(const World& world, const QueryFilter& query, const WheelPath& path, GroundPlane& plane) {
    const Hit hit = world.castRay({path.start, path.translation}, query);
    take(world, isGround(hit, path) ? hit : Hit{}, plane);
}

void movePlane(const GroundPlane& plane, const Pose& now, DVec3& point, Vec3& normal) {
    const Quat turn = now.rotation * conjugate(plane.pose.rotation);
    point = now.position + rotate(turn, relative(plane.point, plane.pose.position));
    normal = rotate(turn, plane.normal);
}

}  // namespace ragtop
