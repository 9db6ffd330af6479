// Where pairs that are asked for their contacts are, four at a time.

#include "contacts/pair_places.h"

#include <cstddef>

#include "base/four_floats.h"
#include "contacts/tuning.h"

namespace ragtop {

namespace {

struct FourFrames {
    FourVectors position;
    FourQuats rotation;
};

FourQuats inLanes(const Quat* const rotations[4]) {
    FourFloats rows[4];
    for (int i = 0; i < 4; ++i) rows[i] = loadFour(&rotations[i]->x);
    transposeFour(rows);
    return {rows[0], rows[1], rows[2], rows[3]};
}

/// Each is followed by another float of its record.
FourVectors inLanes(const Vec3* const vectors[4]) {
    FourFloats rows[4];
    for (int i = 0; i < 4; ++i) rows[i] = loadFour(&vectors[i]->x);
    transposeFour(rows);
    return {rows[0], rows[1], rows[2]};
}

FourFrames inLanes(const Frame* const frames[4]) {
    static_assert(offsetof(Frame, rotation) == sizeof(Vec3));
    const Vec3* positions[4];
    const Quat* rotations[4];
    for (int i = 0; i < 4; ++i) positions[i] = &frames[i]->position, rotations[i] = &frames[i]->rotation;
    return {inLanes(positions), inLanes(rotations)};
}

/// What lanes of pairs are made of.
struct PairRows {
    const Frame *shapeA[4], *shapeB[4], *collidedAt[4];
    const Quat *rotationA[4], *rotationB[4];
    const Vec3 *vA[4], *wA[4], *vB[4], *wB[4];
    float apart[3][4];  ///< m, from the centre of A to that of B
    float radiusA[4], radiusB[4];
    float turningA[4], turningB[4];  ///< m, the same, or zero of what is fixed
    float size[4];
    float halfHeightA[4], halfHeightB[4], radiusOfA[4], radiusOfB[4];  ///< m, of pairs of capsules
    bool capsules[4];
};

/// The other pairs have no extent.
bool takeCapsules(const ConvexView& a, const ConvexView& b, int lane, PairRows& rows) {
    const bool both = a.kind == ConvexKind::capsule && b.kind == ConvexKind::capsule;
    rows.halfHeightA[lane] = both ? a.halfExtents.y : 0.0f, rows.halfHeightB[lane] = both ? b.halfExtents.y : 0.0f;
    rows.radiusOfA[lane] = both ? a.radius : 0.0f, rows.radiusOfB[lane] = both ? b.radius : 0.0f;
    rows.capsules[lane] = both;
    return both;
}

void touchCapsules(const PairRows& rows, const FourVectors& position, const FourQuats& rotation, int count,
                   PairPlace* out) {
    CapsuleTouch touches[4];
    touchFour({position, rotation, loadFour(rows.halfHeightA), loadFour(rows.halfHeightB), loadFour(rows.radiusOfA),
               loadFour(rows.radiusOfB)},
              touches);
    for (int i = 0; i < count; ++i)
        if (rows.capsules[i]) out[i].touch = touches[i];
}

/// m, that surfaces may come nearer in the coming step.
FourFloats motionAhead(const PairRows& rows, float dt) {
    const FourVectors vA = inLanes(rows.vA), wA = inLanes(rows.wA), vB = inLanes(rows.vB), wB = inLanes(rows.wB);
    return (length(vB - vA) + length(wA) * loadFour(rows.turningA) + length(wB) * loadFour(rows.turningB)) * dt;
}

/// How far a pair moves against each other, as manifolds are kept by, for what its bodies have travelled, at most: a
/// turn θ of a body counts θ R there, and here the way of B's shape seen from A beside the arc.
FourFloats motionPerTravel(const PairRows& rows, const FourVectors& inA, const FourFrames& shapeA,
                           const FourFrames& shapeB, FourFloats arc) {
    const FourFloats leverA = length(shapeA.position) + length(inA), leverB = length(shapeB.position);
    FourFloats most = {1, 1, 1, 1};
    const auto take = [&most](FourFloats reach, FourFloats turning) {
        const FourFloats ratio = reach / turning;
        const FourInts more = (turning > 0.0f) & (most < ratio);
        most = more ? ratio : most;
    };
    take(leverA + arc, loadFour(rows.turningA));
    take(leverB + arc, loadFour(rows.turningB));
    return most;
}

}  // namespace

/// A pair moves against each other by its translation and by the arc that it turns at the radius of the smaller body.
void placePairs(const ConstTables& tables, float dt, const std::uint32_t* asked, int count, PairPlace* out) {
    const Bodies& bodies = tables.bodies;
    const Shapes& shapes = tables.shapes;
    PairRows rows;
    bool anyCapsules = false;
    for (int i = 0; i < 4; ++i) {
        const ContactRecord& record = tables.contacts[asked[i < count ? i : 0]];
        const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
        rows.shapeA[i] = &shapes[record.shapeA].frame, rows.shapeB[i] = &shapes[record.shapeB].frame;
        // Pairs without a manifold are not asked how far they moved.
        const bool found = record.firstManifold != kNone;
        rows.collidedAt[i] = found ? &tables.manifolds[record.firstManifold].collidedAt : rows.shapeA[i];
        rows.rotationA[i] = &a.rotation, rows.rotationB[i] = &b.rotation;
        rows.vA[i] = &bodies.states[record.bodyA].v, rows.wA[i] = &bodies.states[record.bodyA].w;
        rows.vB[i] = &bodies.states[record.bodyB].v, rows.wB[i] = &bodies.states[record.bodyB].w;
        const Vec3 apart = relative(b.center, a.center);
        for (int axis = 0; axis < 3; ++axis) rows.apart[axis][i] = apart[axis];
        rows.radiusA[i] = a.travel.coreRadius, rows.radiusB[i] = b.travel.coreRadius;
        rows.turningA[i] = a.type == BodyType::fixed ? 0 : a.travel.coreRadius;
        rows.turningB[i] = b.type == BodyType::fixed ? 0 : b.travel.coreRadius;
        rows.size[i] = record.size;
        anyCapsules |= takeCapsules(shapes.geometries[shapes[record.shapeA].geometry].convex,
                                    shapes.geometries[shapes[record.shapeB].geometry].convex, i, rows);
    }
    const FourFrames shapeA = inLanes(rows.shapeA), shapeB = inLanes(rows.shapeB), before = inLanes(rows.collidedAt);
    const FourQuats qA = inLanes(rows.rotationA), qB = inLanes(rows.rotationB);
    const FourVectors between{loadFour(rows.apart[0]), loadFour(rows.apart[1]), loadFour(rows.apart[2])};

    // As shapeBInA does.
    const FourVectors fromA = inverseRotate(qA, between + rotate(qB, shapeB.position)) - shapeA.position;
    const FourVectors position = inverseRotate(shapeA.rotation, fromA);
    const FourQuats rotation = normalized(conjugate(shapeA.rotation) * (conjugate(qA) * (qB * shapeB.rotation)));

    const FourFloats margin = loadFour(rows.size) * tuning::kSpeculative + motionAhead(rows, dt);
    const FourFloats radiusA = loadFour(rows.radiusA), radiusB = loadFour(rows.radiusB);
    const FourFloats radius = radiusA < radiusB ? radiusA : radiusB;
    const FourQuats turn = conjugate(before.rotation) * rotation;
    const FourFloats moved = length(position - before.position) + 2.0f * length({turn.x, turn.y, turn.z}) * radius;
    const FourFloats perTravel = motionPerTravel(rows, position, shapeA, shapeB, radius);
    for (int i = 0; i < count; ++i)
        out[i] = {{{position.x[i], position.y[i], position.z[i]},
                   {rotation.x[i], rotation.y[i], rotation.z[i], rotation.w[i]}},
                  margin[i],
                  moved[i],
                  perTravel[i],
                  {}};
    if (anyCapsules) touchCapsules(rows, position, rotation, count, out);
}

}  // namespace ragtop
