#pragma once

#include <cstdint>

#include "constraints/constraint_graph.h"
#include "model/body_record.h"
#include "narrowphase/manifold.h"
#include "ragtop/body.h"
#include "ragtop/coupling.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "solve/contact_places.h"

/// What a world keeps of each object, apart from what the solver streams through. All plain data, linked by indices, so
/// that a saved world is a copy of memory.
namespace ragtop {

struct alignas(64) ShapeRecord {
    Frame frame;  ///< in the body's internal frame
    float size = 0;
    std::uint32_t body = 0, next = kNone;
    std::uint32_t geometry = 0;  ///< index into the world's geometry table
    std::uint32_t proxy = kNone;
    bool isStaticTree = false, inMoveBuffer = false;
    bool reportsMotion = false;
    bool sensor : 1 = false, givesWay : 1 = false;
    Filter filter;
    Material material;
    std::uint64_t userData = 0;
};

/// Contacts and joints hang in two lists, one per body; an edge key is 2 · index + side.
struct Edge {
    std::uint32_t previous = kNone, next = kNone;
};
struct ContactLinks {
    Edge edges[2];
};

/// A pair of shapes whose enlarged bounds overlap: one cache line. Two of three in a pile have no points; those have no
/// manifold either.
struct alignas(64) ContactRecord {
    std::uint32_t shapeA = 0, shapeB = 0, bodyA = 0, bodyB = 0;
    /// m, travels of both bodies up to which nothing can touch, or the manifolds are kept; 0: unknown.
    double until = 0;
    float aheadMost = 0;                  ///< m, that both may go in a step for which the manifolds are kept
    float size = 0;                       ///< m, of the smaller shape
    std::uint32_t firstManifold = kNone;  ///< of manifoldCapacity one after the other, while there are points
    std::uint32_t awakeIndex = kNone;     ///< place in the list of awake contacts
    union {
        SeparationCache cache = {};
        std::uint32_t nearTriangles;  ///< of a mesh: where they are remembered; kNone: nowhere
    };
    std::uint8_t manifoldCapacity = 1;  ///< kMaxManifolds for meshes and height fields
    bool isMesh = false, sensor = false, touching = false, reportsMotion = false;
    bool struck = false;       ///< by continuous collision in this step
    bool hasPoints = false;    ///< has some manifold points?
    bool bearsLoad = false;    ///< did its first manifold at the end of the last step?
    bool isDeep = false;       ///< are some of these deeper than a load presses them (contact::kDeep)?
    bool surfaceOpen = false;  ///< what its lanes say of surfaces may have changed
    std::uint8_t loaded = 0;   ///< a bit per manifold: at the end of the last step, where motion is reported
    float collidedMargin = 0;  ///< m, that its manifolds were found with
};
static_assert(sizeof(ContactRecord) == 64 && kMaxManifolds == 8);

/// One direction of a contact. Its geometry moves with the bodies: a point is two anchors, one in each body, that met
/// half way between the surfaces when it was found.
struct ManifoldRecord : ManifoldAnchors {
    GraphPlace place;
    std::uint32_t contact = 0;
    std::uint32_t triangle = 0;
    std::uint32_t feature[kMaxManifoldPoints] = {};
    Frame collidedAt;              ///< B's shape in A's when a contact's manifolds were found; of its first one
    std::uint32_t stored = kNone;  ///< index of its impulses while it has no lane; none: they are zero
};
static_assert(sizeof(ManifoldRecord) == 192);

/// The impulses of a manifold, which are in its lane while it is in the graph.
struct ManifoldImpulses {
    float impulse[kMaxManifoldPoints] = {}, load[kMaxManifoldPoints] = {};  ///< N s
    Vec3 frictionImpulse, rollImpulse;
    Vec3 stick;  ///< m, how far B has slipped on A since they stick
    float twistImpulse = 0;
    float substep = 0;  ///< s, that they belong to
    bool sliding = false;
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
    std::uint32_t firstCoupling = kNone;  ///< kMostParts · coupling + part
};

/// Hangs in a list of each of its joints.
struct CouplingRecord {
    CouplingDef def;
    std::uint32_t next[CouplingDef::kMostParts] = {kNone, kNone, kNone, kNone};
};

}  // namespace ragtop
