#pragma once

#include <cstdint>

#include "ragtop/id.h"
#include "ragtop/math.h"

/// What happened in the last step. Spans of events are valid until the next step; their order depends on the scene
/// alone.
namespace ragtop {

/// Two shapes that began or ended touching.
struct ContactEvent {
    ShapeId shapeA, shapeB;
    BodyId bodyA, bodyB;
    bool operator==(const ContactEvent&) const = default;
};

/// An impact, slide or roll of two surfaces, for shapes with `reportsMotion`: for sounds, sparks, skid marks.
struct SurfaceEvent {
    enum class Kind : std::uint8_t {
        impact,  ///< they met in this step at `speed` along the normal
        slide,   ///< they slide past each other at `speed`
        roll,    ///< one rolls on the other; `speed` is that of the contact point along the surface
    };
    Kind kind = Kind::impact;
    ShapeId shapeA, shapeB;
    BodyId bodyA, bodyB;
    std::uint32_t surfaceA = 0, surfaceB = 0;  ///< Material::surface of the two
    DVec3 point;                               ///< m
    Vec3 normal;                               ///< from A to B
    float speed = 0;                           ///< m/s
    float impulse = 0;                         ///< N s, along the normal during the step
};

/// A body that fell asleep or woke.
struct SleepEvent {
    BodyId body;
    bool asleep = false;
};

/// A joint that broke under more force or torque than its definition allows; it has been destroyed.
struct JointBreak {
    JointId joint;
    BodyId bodyA, bodyB;         ///< null: the world
    std::uint64_t userData = 0;  ///< of the joint
    Vec3 force;                  ///< N, of A on B, mean over the step
    Vec3 torque;                 ///< N m, likewise
};

/// One contact point as the solver left it.
struct ContactPoint {
    DVec3 point;           ///< m, half way between the surfaces
    float separation = 0;  ///< m, negative when overlapping
    float impulse = 0;     ///< N s along the normal, during the last substep
};

/// A manifold: a pair that touches, or one direction of it where a pair touches in several.
struct Contact {
    ShapeId shapeA, shapeB;
    BodyId bodyA, bodyB;
    Vec3 normal;  ///< from A to B
    int pointCount = 0;
    ContactPoint points[4];
    Vec3 frictionForce;     ///< N, mean over the last substep, on B
    float normalForce = 0;  ///< N, mean over the last substep, on B
};

}  // namespace ragtop
