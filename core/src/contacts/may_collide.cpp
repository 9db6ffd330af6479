#include "contacts/may_collide.h"

namespace ragtop {

bool filtersAgree(const Filter& a, const Filter& b) {
    if (a.group == b.group && a.group != 0) return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

bool shouldCollide(const Bodies& bodies, const Shapes& shapes, const Joints& joints, const ShapeRecord& a,
                   const ShapeRecord& b) {
    if (a.body == b.body || !(bodies.moves(a.body) || bodies.moves(b.body))) {
        const bool sensorPair = (a.sensor || b.sensor) && a.body != b.body;
        if (!sensorPair) return false;
    }
    if (shapes.geometries[a.geometry].isMesh() && shapes.geometries[b.geometry].isMesh() && !bodies.moves(a.body) &&
        !bodies.moves(b.body))
        return false;
    if (!filtersAgree(a.filter, b.filter)) return false;
    for (std::uint32_t key = bodies[a.body].firstJoint; key != kNone; key = joints[key >> 1].edges[key & 1].next) {
        const JointRecord& joint = joints[key >> 1];
        const std::uint32_t other = (key & 1) != 0 ? joint.bodyA : joint.bodyB;
        if (other != b.body) continue;
        if (!std::visit([](const auto& def) { return def.bodies.collide; }, joint.def)) return false;
    }
    return true;
}

}  // namespace ragtop
