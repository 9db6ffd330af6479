#pragma once

#include <cstdint>

#include "constraints/constraint_graph.h"
#include "direct/choice.h"
#include "narrowphase/manifold.h"
#include "ragtop/body.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"

/// What a world keeps of each object, apart from what the solver streams through. All plain data, linked by indices, so
/// that a saved world is a copy of memory.
namespace ragtop {

/// A body's internal frame is that of its principal axes at its centre of mass.
struct BodyRecord {
    DVec3 center;            ///< m, centre of mass in the world
    Quat rotation;           ///< principal axes to world
    Frame local;             ///< internal frame in the frame of the definition
    Vec3 inertia;            ///< kg m², principal moments
    float mass = 0;          ///< kg
    Vec3 force, torque;      ///< N, N m, for the next step
    float linearDamping = 0, angularDamping = 0, gravityScale = 1;
    float size = 0;          ///< m, smallest size of its shapes
    float radius = 0;        ///< m, of the ball about the centre that holds its shapes
    float sleepTimer = 0;    ///< s
    std::int32_t directSteps = 0;        ///< steps for which its island stays direct; negative: for which it may not be
    std::uint32_t state = 0;             ///< index into the solver's arrays; 0 for fixed bodies
    std::uint32_t awakeIndex = kNone;    ///< place in the list of awake bodies
    std::uint32_t firstShape = kNone, firstContact = kNone, firstJoint = kNone;  ///< contact and joint: edge keys
    BodyType type = BodyType::dynamic;
    bool allowSleep = true, continuous = true, bullet = false;
    AxisLocks locks;
    direct::Reason directReason = direct::Reason::none;
    std::uint64_t userData = 0;
};

struct ShapeRecord {
    Frame frame;  ///< in the body's internal frame
    Filter filter;
    Material material;
    std::uint32_t body = 0, next = kNone;
    std::uint32_t geometry = 0;  ///< index into the world's geometry table
    std::uint32_t proxy = kNone;
    float size = 0;
    bool isStaticTree = false, sensor = false, reportsMotion = false, inMoveBuffer = false;
    std::uint64_t userData = 0;
};

/// A pair of shapes whose enlarged bounds overlap. Contacts and joints hang in two lists, one per body; an edge key is
/// 2 · index + side.
struct Edge {
    std::uint32_t previous = kNone, next = kNone;
};

struct ContactRecord {
    std::uint32_t shapeA = 0, shapeB = 0, bodyA = 0, bodyB = 0;
    Edge edges[2];
    SeparationCache cache;
    std::uint32_t firstManifold = kNone;   ///< one record, or kMaxManifolds of them for meshes and height fields
    std::uint32_t awakeIndex = kNone;      ///< place in the list of awake contacts
    Frame collidedAt;                      ///< B's shape in A's when the manifolds were found
    float collidedMargin = 0;              ///< m, with this margin
    float motion = 0;                      ///< m, of one relative to the other in this step, if they go on as they do
    bool collided = false;
    std::uint8_t manifoldCapacity = 1;
    bool isMesh = false, sensor = false, touching = false, reportsMotion = false;
    bool struck = false;                   ///< by a sweep in this step
};

/// One direction of a contact. Its geometry moves with the bodies: a point is two anchors, one in each body, that met
/// half way between the surfaces when it was found. While in the graph its impulses live in its lane; otherwise here.
struct ManifoldRecord {
    GraphPlace place;
    std::uint32_t contact = 0;
    std::int32_t pointCount = 0;
    Vec3 normal;                        ///< in A's internal frame, from A to B
    std::uint32_t triangle = 0;
    std::uint32_t feature[kMaxManifoldPoints] = {};
    Vec3 anchorA[kMaxManifoldPoints], anchorB[kMaxManifoldPoints];  ///< m, in the bodies' internal frames
    float separation[kMaxManifoldPoints] = {};                      ///< m, when found
    float impulse[kMaxManifoldPoints] = {}, load[kMaxManifoldPoints] = {};
    Vec3 frictionImpulse, rollImpulse;
    Vec3 stick;                         ///< m, how far B has slipped on A since they stick
    float twistImpulse = 0;
    bool sliding = false;
    bool loaded = false;                ///< at the end of the last step, of contacts that report their motion
    float substep = 0;                  ///< s, the substep that the impulses belong to
};

/// A manifold where the bodies are now.
struct PlacedManifold {
    Vec3 normal;                                ///< world axes, from A to B
    Vec3 offset;                                ///< m, from the centre of A, or of B if A is static, to that of B
    Vec3 anchor[kMaxManifoldPoints];            ///< m, half way between the anchors, from the same centre
    float separation[kMaxManifoldPoints] = {};  ///< m
};

struct JointRecord {
    JointDef def;
    GraphPlace place;
    std::uint32_t bodyA = 0, bodyB = 0;  ///< 0 is the world
    Edge edges[2];
};

}  // namespace ragtop
