#include "chassis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <vector>

namespace ragtop {
namespace {

/// The turn that takes up to where a strut points.
Quat strutRotation(const WheelDef& wheel) { return rotationBetween({0, 1, 0}, normalized(wheel.suspension.axis)); }

/// A wheel about its hub as what is beside, before and behind it meets it: round, its corners as far out of
/// the circle as its sides are in it. A corner looks ahead, so that a wall meets it beside the hub, as long as the car
/// leans by less than half of a side. In a frame whose y is the strut's axis.
ConvexHull wheelHull(const WheelDef& wheel) {
    constexpr int kSides = 16;
    const float out = 2 / (1 + std::cos(kPi / kSides));
    constexpr float kThinnest = 0.02f, kWidest = 20;  // half of its width over its radius, of what has a hull
    const float radius = out * wheel.radius;
    const float half = std::clamp(0.5f * wheel.width, kThinnest * radius, kWidest * radius);
    const Quat fromChassis = conjugate(strutRotation(wheel));
    std::vector<Vec3> points;
    for (int i = 0; i < kSides; ++i) {
        const Vec3 spoke = rotate(rotationAbout({1, 0, 0}, 2 * kPi * static_cast<float>(i) / kSides), {0, 1, 0});
        for (const float across : {-half, half})
            points.push_back(rotate(fromChassis, Vec3{across, 0, 0} + radius * spoke));
    }
    return ConvexHull(points);
}

}  // namespace

Material shapeMaterial(const VehicleDef& def, std::size_t shape) {
    constexpr float kPatch = 0.3f;  // of a radius, half of the length of a patch that is squashed as under a car
    constexpr float kLoss = 0.2f;   // of what rubber takes up when it is squashed [Gent, Walter 2006]
    // An edge of bodywork is dented for good: a roof bears three weights within 127 mm [49 CFR 571.216a], so that one
    // dents it by this share of a passenger car's wheels' radius, and by as much to either side.
    constexpr float kDent = 0.14f;
    const std::size_t bodywork = def.chassis.shapes.size();
    float rocking = 0;
    if (shape >= bodywork) {
        rocking = kLoss * kPatch * def.wheels[shape - bodywork].radius;
    } else {
        for (const WheelDef& wheel : def.wheels) rocking += wheel.radius;
        rocking *= kDent / static_cast<float>(def.wheels.size());
    }
    Material material = def.chassis.material;
    material.rollingResistance = std::max(material.rollingResistance, std::min(rocking, 1.0f));
    return material;
}

Quat wheelRotation(const Vec3& axle) {
    const Vec3 ahead = normalized(Vec3{-axle.z, 0, axle.x}, {0, 0, 1});
    return rotationFromAxes(axle, cross(ahead, axle), ahead);
}

/// A wheel turns about its strut to steer, and leans as its axle does.
Frame wheelShapeFrame(const WheelDef& wheel, const Vec3& hub, const Vec3& axle) {
    const float angle = arcTan2(-axle.z, axle.x);
    const Quat lean = axle.y == 0 ? Quat{} : wheelRotation(axle) * rotationAbout({0, 1, 0}, -angle);
    return {hub, normalized(lean * strutRotation(wheel) * rotationAbout({0, 1, 0}, angle))};
}

std::string whyAnotherShape(const WheelDef& now, const WheelDef& next) {
    const Vec3 axis = normalized(now.suspension.axis), nextAxis = normalized(next.suspension.axis);
    const std::tuple<const char*, float, float> numbers[] = {{"/radius", now.radius, next.radius},
                                                             {"/width", now.width, next.width},
                                                             {"/suspension/axis/0", axis.x, nextAxis.x},
                                                             {"/suspension/axis/1", axis.y, nextAxis.y},
                                                             {"/suspension/axis/2", axis.z, nextAxis.z}};
    for (const auto& [name, kept, given] : numbers) {
        if (kept == given) continue;
        char text[96];
        std::snprintf(text, sizeof text, "%s is %.7g, must stay %.7g", name, static_cast<double>(given),
                      static_cast<double>(kept));
        return text;
    }
    return {};
}

MassProperties chassisMass(const ChassisDef& def) {
    std::vector<MassProperties> parts;
    for (const ChassisShape& shape : def.shapes) parts.push_back(transformed(massOf(shape.shape, 1), shape.frame));
    MassProperties whole = combined(parts);
    const float scale = def.mass / whole.mass;
    whole.mass = def.mass;
    whole.inertia = {scale * whole.inertia.cx, scale * whole.inertia.cy, scale * whole.inertia.cz};
    if (def.centerOfMass) whole.center = *def.centerOfMass;
    if (def.inertia) whole.inertia = {{def.inertia->x, 0, 0}, {0, def.inertia->y, 0}, {0, 0, def.inertia->z}};
    return whole;
}

BodyDef chassisBody(const VehicleDef& def, const VehiclePlacement& placement) {
    BodyDef body;
    for (const ChassisShape& shape : def.chassis.shapes) {
        ShapeDef part;
        part.geometry = shape.shape;
        part.frame = shape.frame;
        part.material = shapeMaterial(def, body.shapes.size());
        part.filter = def.chassis.filter;
        body.shapes.push_back(std::move(part));
    }
    for (const WheelDef& wheel : def.wheels) {
        ShapeDef part;
        part.geometry = wheelHull(wheel);
        part.frame = wheelShapeFrame(wheel, wheel.position, {1, 0, 0});
        part.material = shapeMaterial(def, body.shapes.size());
        part.filter = def.chassis.filter;
        part.givesWay = true;
        body.shapes.push_back(std::move(part));
    }
    body.pose = {placement.position, rotationAbout({0, 1, 0}, placement.heading)};
    body.linearVelocity = placement.speed * rotate(body.pose.rotation, {0, 0, 1});
    body.mass = chassisMass(def.chassis);
    return body;
}

}  // namespace ragtop
