#pragma once

#include "point_body.h"

namespace ragtop {

/// One direction of a patch between two bodies, with what a unit impulse along it does to them: pushing and looking at
/// speeds takes a few products then. Velocities are those of the first body over the second.
struct PatchRow {
    Vec3 along;                                ///< unit
    Vec3 moment, groundMoment;                 ///< r × d, of the arms
    Vec3 turn, groundTurn;                     ///< rad/s by a unit impulse; zero where the ground is fixed
    float inverseMass = 0, groundInverse = 0;  ///< 1/kg
    float belt = 0;                            ///< m/s of the ground's surface, of all of ground that nothing pushes
};

/// On ground that stands still.
inline PatchRow rowOf(const Vec3& along, const PointBody& body, const Vec3& arm, const Vec3& belt) {
    PatchRow row{along, cross(arm, along), {}, {}, {}, body.inverseMass, 0, dot(belt, along)};
    row.turn = body.inverseInertia * row.moment;
    return row;
}

/// The same on ground that moves.
inline PatchRow rowOf(const Vec3& along, const PointBody& body, const Vec3& arm, const PointBody& ground,
                      const Vec3& groundArm, const Vec3& belt) {
    PatchRow row = rowOf(along, body, arm, belt);
    row.groundInverse = ground.inverseMass;
    row.groundMoment = cross(groundArm, along);
    if (ground.inverseMass > 0)
        row.groundTurn = ground.inverseInertia * row.groundMoment;
    else
        row.belt += dot(ground.v, along) + dot(ground.w, row.groundMoment);
    return row;
}

inline float speedAlong(const PatchRow& row, const PointBody& body, const PointBody& ground) {
    const float of = dot(body.v, row.along) + dot(body.w, row.moment) - row.belt;
    if (!(row.groundInverse > 0)) return of;
    return of - dot(ground.v, row.along) - dot(ground.w, row.groundMoment);
}

inline void push(const PatchRow& row, PointBody& body, PointBody& ground, float impulse) {
    body.v += row.inverseMass * impulse * row.along;
    body.w += impulse * row.turn;
    if (!(row.groundInverse > 0)) return;
    ground.v += -row.groundInverse * impulse * row.along;
    ground.w += -impulse * row.groundTurn;
}

/// Speed along the first row's direction by a unit impulse along the second's, of the same patch.
inline float inverseMassBetween(const PatchRow& a, const PatchRow& b) {
    const float one = (a.inverseMass + a.groundInverse) * dot(a.along, b.along) + dot(a.moment, b.turn);
    return a.groundInverse > 0 ? one + dot(a.groundMoment, b.groundTurn) : one;
}

}  // namespace ragtop
