#include "debug_lines.h"

#include <algorithm>
#include <cmath>

#include "ragtop/world.h"

namespace ragtop::live {
namespace {

constexpr Color kLoad = 0x6fd08c, kLongitudinal = 0x57a7f2, kLateral = 0xf2a157, kSlip = 0xff5a4f, kBone = 0xf2e6c9;
constexpr float kSliding = 0.12f;  ///< slip, or rad of slip angle, about where tires slide as a whole

/// Forces of the ground on the wheels, a wheel's share of the weight as long as its diameter, and how fast the contact
/// slips: red where it slides.
void drawWheels(LineCollector& lines, const Vehicle& car) {
    const auto wheels = car.telemetry().wheels;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const WheelTelemetry& wheel = wheels[i];
        if (!wheel.grounded) continue;
        const float radius = car.def().wheels[i].radius, scale = 2 * radius / car.staticLoads()[i];
        const Vec3 axle = rotate(wheel.pose.rotation, {1, 0, 0});
        const Vec3 forward = normalized(cross(axle, wheel.contactNormal)), side = cross(wheel.contactNormal, forward);
        lines.arrow(wheel.contactPoint, scale * wheel.load * wheel.contactNormal, kLoad);
        lines.arrow(wheel.contactPoint, scale * wheel.longitudinalForce * forward, kLongitudinal);
        lines.arrow(wheel.contactPoint, scale * wheel.lateralForce * side, kLateral);
        const float along = std::clamp(wheel.slipRatio, -1.0f, 1.0f), across = wheel.slipAngle;
        const bool slides = std::abs(along) > kSliding || std::abs(across) > kSliding;
        const Vec3 slip = radius * (along * -forward + across * side);
        lines.line(wheel.contactPoint, wheel.contactPoint + slip, slides ? kSlip : kBone);
    }
}

void drawSkeleton(LineCollector& lines, const Ragdoll& ragdoll) {
    const std::vector<Pose> bones = ragdoll.pose();
    for (std::size_t i = 0; i < bones.size(); ++i) {
        const int parent = ragdoll.def().bones[i].parent;
        if (parent >= 0) lines.line(bones[static_cast<std::size_t>(parent)].position, bones[i].position, kBone);
        lines.sphere(bones[i], 0.015f, kBone);
    }
}

}  // namespace

void LineCollector::line(const DVec3& from, const DVec3& to, Color color) {
    segments_.push_back({relative(from, origin_), relative(to, origin_), color});
}

void LineCollector::arrow(const DVec3& from, const Vec3& along, Color color) {
    const DVec3 tip = from + along;
    line(from, tip, color);
    const float size = length(along);
    if (!(size > 0)) return;
    const Vec3 aside = 0.08f * size * perpendicular((1 / size) * along);
    for (const Vec3& side : {aside, -aside}) line(tip, tip - 0.2f * along + side, color);
}

void LineCollector::sphere(const Pose& pose, float radius, Color color) {
    for (const Vec3& axis : {Vec3{radius, 0, 0}, Vec3{0, radius, 0}, Vec3{0, 0, radius}}) {
        line(pose.position - axis, pose.position + axis, color);
    }
}

void LineCollector::frame(const Pose& pose, float size) {
    line(pose.position, transformPoint(pose, {size, 0, 0}), 0xe05040);
    line(pose.position, transformPoint(pose, {0, size, 0}), 0x50c050);
    line(pose.position, transformPoint(pose, {0, 0, size}), 0x5080e0);
}

bool showsLines(const ShowOptions& show) {
    return std::any_of(show.begin(), show.end(), [](const auto& option) {
        return option.second && option.first != "shapes" && option.first != "islands";
    });
}

std::vector<LineSegment> debugLines(const Cast& cast, const ShowOptions& show, const DVec3& origin) {
    if (!showsLines(show)) return {};
    LineCollector lines(origin);
    lines.options.shapes = false;
    lines.options.contacts = show.at("contacts");
    lines.options.joints = show.at("joints");
    lines.options.bounds = show.at("bounds");
    lines.options.centers = show.at("centers");
    cast.world->draw(lines);
    if (show.at("wheels")) {
        for (const CastVehicle& car : cast.vehicles) drawWheels(lines, *car.vehicle);
    }
    if (show.at("skeleton")) {
        for (const CastRagdoll& each : cast.ragdolls) drawSkeleton(lines, *each.ragdoll);
    }
    return lines.segments();
}

std::vector<NodeColor> islandColors(const Cast& cast, const Nodes& nodes, bool shown) {
    std::vector<NodeColor> colors;
    const auto bodies = cast.world->bodies();
    const std::vector<BodyId> first = shown ? cast.world->islands() : std::vector<BodyId>(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto node = nodes.node(bodies[i]);
        if (!node || cast.world->type(bodies[i]) != BodyType::dynamic) continue;
        colors.push_back({*node, shown ? islandColor(first[i]) : NodeColor::kOwn});
    }
    return colors;
}

}  // namespace ragtop::live
