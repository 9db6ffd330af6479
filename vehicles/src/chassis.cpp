#include "chassis.h"

namespace ragtop {

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
        part.material = def.chassis.material;
        part.filter = def.chassis.filter;
        body.shapes.push_back(std::move(part));
    }
    body.pose = {placement.position, rotationAbout({0, 1, 0}, placement.heading)};
    body.linearVelocity = placement.speed * rotate(body.pose.rotation, {0, 0, 1});
    body.mass = chassisMass(def.chassis);
    return body;
}

}  // namespace ragtop
