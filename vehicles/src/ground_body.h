#pragma once

#include <vector>

#include "point_body.h"
#include "ragtop/id.h"

namespace ragtop {

class World;

/// Where a body under a wheel is held by something else: a point of a contact that the world found.
struct Support {
    DVec3 point;
    Vec3 arm;            ///< of the point from the body's centre of mass
    Vec3 normal;         ///< unit, into the body
    Vec3 tangents[2];    ///< unit
    Vec3 otherVelocity;  ///< m/s of the other side
    float friction = 0;
    float normalMass = 0, tangentMass[2] = {};  ///< kg
    float impulse = 0, rub[2] = {};             ///< N s
    float most = 0;                             ///< N s that it is trusted to bear
};

/// A body that wheels stand on, as the car's implicit solve sees it: shared by all wheels on it, with what holds it. A
/// brick between a wheel and the road passes the whole load on, and yields as it would alone where nothing is behind
/// it. The world then solves its own contacts with the impulses of both. Where it does not find what was foreseen, as
/// at a brick that tips, the body takes the load with nothing against it; so a support is trusted with little more than
/// it bore in the last step, and no more once the body has gone through it.
struct GroundBody {
    PointBody body;  ///< zero: fixed
    DVec3 center;
    Mat3 inverseInertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  ///< body axes
    std::vector<Support> supports;
};

/// Reads the mass of a body and what holds it, once per step. Contacts with `chassis` are left out. Null: fixed ground.
void findSupports(const World& world, BodyId body, BodyId chassis, GroundBody& ground);

/// Copies place and motion at the beginning of a substep.
void beginGround(const World& world, BodyId body, GroundBody& ground);

/// Adds what the substep does to the body without the car: the speed `fall` of gravity, and its supports as they
/// pressed last.
void pressGround(GroundBody& ground, const Vec3& fall);

/// One visit to all supports: no point goes through the other side, and friction takes what its cone allows. The
/// largest change of an impulse, N s.
float visitSupports(GroundBody& ground);

}  // namespace ragtop
