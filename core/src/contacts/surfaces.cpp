#include "contacts/surfaces.h"

#include <cmath>

namespace ragtop {

namespace {

/// How far the friction of a material with a grain is from that of one without.
float unevenness(const Material& material) {
    return material.crossFriction > 1 ? material.crossFriction : 1 / material.crossFriction;
}

}  // namespace

float combined(CombineRule a, float valueA, CombineRule b, float valueB) {
    switch (a > b ? a : b) {
        case CombineRule::geometricMean:
            return std::sqrt(valueA * valueB);
        case CombineRule::average:
            return 0.5f * (valueA + valueB);
        case CombineRule::minimum:
            return valueA < valueB ? valueA : valueB;
        case CombineRule::product:
            return valueA * valueB;
        case CombineRule::maximum:
            break;
    }
    return valueA > valueB ? valueA : valueB;
}

ContactSurface surfaceOf(const Bodies& bodies, const Shapes& shapes, std::uint32_t indexA, std::uint32_t indexB,
                         std::uint32_t triangle) {
    const ShapeRecord &shapeA = shapes[indexA], &shapeB = shapes[indexB];
    const BodyRecord &bodyA = bodies[shapeA.body], &bodyB = bodies[shapeB.body];
    const Material& a = shapes.materialAt(shapeA, triangle);
    const Material& b = shapeB.material;
    ContactSurface surface;
    surface.friction = combined(a.frictionRule, a.friction, b.frictionRule, b.friction);
    if (a.slidingShare < 1 || b.slidingShare < 1) {
        const float sliding =
            combined(a.frictionRule, a.slidingShare * a.friction, b.frictionRule, b.slidingShare * b.friction);
        surface.slidingShare = sliding < surface.friction ? sliding / surface.friction : 1.0f;
    }
    surface.restitution = combined(a.restitutionRule, a.restitution, b.restitutionRule, b.restitution);
    surface.rollingResistance = a.rollingResistance > b.rollingResistance ? a.rollingResistance : b.rollingResistance;
    surface.spinningResistance =
        a.spinningResistance > b.spinningResistance ? a.spinningResistance : b.spinningResistance;
    const float unevenA = a.grain == Vec3{} ? 1 : unevenness(a), unevenB = b.grain == Vec3{} ? 1 : unevenness(b);
    if (unevenA > 1 || unevenB > 1) {
        const bool ofA = unevenA >= unevenB;
        surface.grain = rotate(definitionRotation(ofA ? bodyA : bodyB), ofA ? a.grain : b.grain);
        surface.crossFriction = ofA ? a.crossFriction : b.crossFriction;
    }
    if (a.surfaceVelocity != Vec3{} || b.surfaceVelocity != Vec3{})
        surface.surfaceVelocity =
            rotate(definitionRotation(bodyB), b.surfaceVelocity) - rotate(definitionRotation(bodyA), a.surfaceVelocity);
    return surface;
}

PairInfo pairInfo(const Bodies& bodies, const Shapes& shapes, std::uint32_t shapeA, std::uint32_t shapeB) {
    const ShapeRecord &a = shapes[shapeA], &b = shapes[shapeB];
    return {shapes.id(shapeA), shapes.id(shapeB), bodies.id(a.body), bodies.id(b.body), a.userData, b.userData};
}

bool turnsUnderContact(const Shapes& shapes, const ContactRecord& record) {
    return shapes.geometries[shapes[record.shapeA].geometry].convex.radius +
               shapes.geometries[shapes[record.shapeB].geometry].convex.radius >
           0;
}

}  // namespace ragtop
