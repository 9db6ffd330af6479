#pragma once

#include <cstdint>

#include "constraints/constraint_graph.h"
#include "direct/choice.h"
#include "ragtop/body.h"
#include "ragtop/math.h"

/// What a world keeps of each body, apart from what the solver streams through.
namespace ragtop {

/// How far a body's shapes have gone, and go.
struct BodyTravel {
    double done = 0;       ///< m, that no point of its shapes' cores has gone farther in steps
    float coreRadius = 0;  ///< m, of the ball about the centre that holds the cores of its shapes
    float ahead = 0;       ///< m, as `done`, of the coming step, going on as it does
};

/// What makes the bounds of a body's shapes anew; told by several threads.
struct BodyBounds {
    bool left = false;         ///< at the end of the last step, by some shape
    bool newVelocity = false;  ///< was given one since, which its bounds do not count
};

/// What a definition says of how a body moves.
struct BodyMotion {
    float linearDamping = 0, angularDamping = 0, gravityScale = 1;
};

/// What callers let a body do.
struct BodyOptions {
    bool allowSleep : 1 = true, continuous : 1 = true, bullet : 1 = false;
    /// 0: takes part. Else it is disabled, fixed and without proxies for the time, and has the type of one less.
    std::uint8_t heldBack : 2 = 0;
};

/// What is known of solving a body's island directly.
struct BodyDirect {
    std::int32_t steps = 0;  ///< for which it stays direct; negative: for which it may not be
    direct::Reason reason : 4 = direct::Reason::none;
    std::uint8_t failures : 4 = 0;  ///< direct solves that failed since one came to rest
    direct::SubstepPace pace;
};

/// A body's internal frame is that of its principal axes at its centre of mass.
struct alignas(64) BodyRecord {
    // One cache line of what pairs of bodies are looked at by.
    DVec3 center;  ///< m, centre of mass in the world
    BodyTravel travel;
    Quat rotation;            ///< principal axes to world
    std::uint32_t state = 0;  ///< index into the solver's arrays; 0 for fixed bodies
    BodyType type = BodyType::dynamic;
    BodyBounds bounds;
    bool frozen = false;  ///< on what does not move, and is left out of the solver

    Frame local;         ///< internal frame in the frame of the definition
    Vec3 inertia;        ///< kg m², principal moments
    float mass = 0;      ///< kg
    Vec3 force, torque;  ///< N, N m, for the next step
    BodyMotion motion;
    float radius = 0;      ///< m, of the ball about the centre that holds its shapes
    float size = 0;        ///< m, smallest size of its shapes
    float room = 0;        ///< m, how far its shape can go before it leaves its bounds, at least
    float sleepTimer = 0;  ///< s
    BodyDirect direct;
    std::uint32_t awakeIndex = kNone;                                            ///< place in the list of awake bodies
    std::uint32_t firstShape = kNone, firstContact = kNone, firstJoint = kNone;  ///< contact and joint: edge keys
    BodyOptions options;
    std::uint8_t stillSteps = 0;  ///< for which it was too slow to tell from what rests
    AxisLocks locks;
};
static_assert(sizeof(BodyRecord) == 192);

}  // namespace ragtop
