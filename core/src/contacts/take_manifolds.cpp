// Which of the manifolds of before go on, and what becomes of their impulses.

#include <algorithm>

#include "constraints/contact_layout.h"
#include "contacts/contact_writer.h"

namespace ragtop {

namespace {

/// Impulses of the points of before for those of now that have the same feature.
ManifoldImpulses matchedImpulses(const ManifoldRecord& before, const ManifoldImpulses& known,
                                 const ManifoldRecord& now) {
    ManifoldImpulses carried;
    if (before.pointCount > 0) carried = known;
    for (int j = 0; j < kMaxManifoldPoints; ++j) {
        carried.impulse[j] = carried.load[j] = 0;
        if (j >= now.pointCount) continue;
        for (int k = 0; k < before.pointCount; ++k)
            if (before.feature[k] == now.feature[j]) {
                carried.impulse[j] = known.impulse[k];
                carried.load[j] = known.load[k];
                break;
            }
    }
    return carried;
}

/// Contacts of surfaces go from feature to feature as they roll and slide on each other. What a place that is gone bore
/// is borne by the nearest one of now that faces alike, so that nothing sinks until it finds its load anew.
void handOverImpulses(std::span<const ManifoldRecord> before, const ManifoldImpulses* known,
                      std::span<const ManifoldRecord> now, ManifoldImpulses* carried, float size) {
    constexpr float kNear = 0.5f, kAlike = 0.7f;  // of the size; cosine, 45°
    for (std::size_t i = 0; i < before.size(); ++i)
        for (int j = 0; j < before[i].pointCount; ++j) {
            const ManifoldRecord& old = before[i];
            if (!(known[i].impulse[j] > 0 || known[i].load[j] > 0)) continue;
            const ManifoldRecord* heir = nullptr;
            int place = 0;
            float least = kNear * kNear * size * size;
            bool kept = false;
            for (const ManifoldRecord& manifold : now) {
                const float facing = dot(manifold.normal, old.normal);
                if (facing < kAlike) continue;
                for (int k = 0; k < manifold.pointCount; ++k) {
                    kept |= &manifold == &now[i] && manifold.feature[k] == old.feature[j];
                    const float square = lengthSquared(manifold.anchorA[k] - old.anchorA[j]);
                    if (square < least) least = square, heir = &manifold, place = k;
                }
            }
            if (kept || !heir) continue;
            const float share = dot(heir->normal, old.normal);
            carried[heir - now.data()].impulse[place] += share * known[i].impulse[j];
            carried[heir - now.data()].load[place] += share * known[i].load[j];
        }
}

/// Are its points those that were found, in the same order?
bool hasSamePoints(const ManifoldRecord& before, const Manifold& found) {
    bool same = before.pointCount == found.pointCount;
    for (int j = 0; same && j < found.pointCount; ++j) same = before.feature[j] == found.points[j].feature;
    return same;
}

/// Are its points other ones than before?
bool hasOtherPoints(const ManifoldRecord& before, const ManifoldRecord& now) {
    if (before.pointCount != now.pointCount) return true;
    for (int j = 0; j < now.pointCount; ++j) {
        bool known = false;
        for (int k = 0; k < before.pointCount; ++k) known |= before.feature[k] == now.feature[j];
        if (!known) return true;
    }
    return false;
}

/// For each new manifold the old one that faces the same way, at most once; the rest take free places.
void matchManifolds(const Vec3* normals, int count, const ManifoldRecord* old, int capacity, int place[kMaxManifolds]) {
    bool used[kMaxManifolds] = {};
    for (int i = 0; i < count; ++i) {
        int best = -1;
        float bestDot = 0.9f;
        for (int k = 0; k < capacity; ++k) {
            if (used[k] || old[k].pointCount == 0) continue;
            const float d = dot(normals[i], old[k].normal);
            if (d > bestDot) bestDot = d, best = k;
        }
        place[i] = best;
        if (best >= 0) used[best] = true;
    }
    for (int i = 0; i < count; ++i) {
        if (place[i] >= 0) continue;
        int free = -1;
        for (int k = 0; k < capacity && free < 0; ++k)
            if (!used[k] && old[k].pointCount == 0) free = k;
        for (int k = 0; k < capacity && free < 0; ++k)
            if (!used[k]) free = k;
        place[i] = free;
        used[free] = true;
    }
}

bool isDeep(std::span<const Manifold> found, float size) {
    return std::any_of(found.begin(), found.end(), [&](const Manifold& manifold) {
        return std::any_of(manifold.points, manifold.points + manifold.pointCount,
                           [&](const ManifoldPoint& point) { return -point.separation > contact::kDeep * size; });
    });
}

}  // namespace

ManifoldRecord& ContactWriter::takeFirstManifolds(ContactRecord& record, std::span<const Manifold> found,
                                                  int worker) const {
    const std::span<ManifoldRecord> held = manifolds.hold(record, worker);
    record.hasPoints = true;
    record.isDeep = isDeep(found, record.size);
    for (std::size_t i = 0; i < found.size(); ++i) {
        held[i].normal = rotate(shapes[record.shapeA].frame.rotation, found[i].normal);
        placePoints(record, found[i], held[i]);
    }
    return held[0];
}

std::uint8_t ContactWriter::takeManifolds(ContactRecord& record, std::span<const Manifold> found) const {
    ManifoldRecord* old = &manifolds[record.firstManifold];
    const int count = static_cast<int>(found.size());
    record.hasPoints = count > 0;
    record.isDeep = isDeep(found, record.size);
    refreshSurfaces(record);
    const ShapeRecord& shapeA = shapes[record.shapeA];
    Vec3 normals[kMaxManifolds];
    int place[kMaxManifolds];
    for (int i = 0; i < count; ++i)
        normals[i] = rotate(shapeA.frame.rotation, found[static_cast<std::size_t>(i)].normal);
    matchManifolds(normals, count, old, record.manifoldCapacity, place);

    unsigned change = kUnchanged;
    bool written[kMaxManifolds] = {}, others = false;
    for (int i = 0; i < count; ++i) {
        const Manifold& fresh = found[static_cast<std::size_t>(i)];
        ManifoldRecord& manifold = old[place[i]];
        written[place[i]] = true;
        // Its impulses stay in its lane, and so do its surfaces.
        if (manifold.place.color != kNone && sameSubstep() && hasSamePoints(manifold, fresh) &&
            manifold.triangle == fresh.triangle) {
            manifold.normal = normals[i];
            placePoints(record, fresh, manifold);
            continue;
        }
        const ManifoldRecord before = manifold;
        const ManifoldImpulses known = impulsesOf(manifold);
        manifold.normal = normals[i];
        placePoints(record, fresh, manifold);
        others |= hasOtherPoints(before, manifold);
        writeImpulses(record, manifold, matchedImpulses(before, known, manifold));
        if (manifold.place.color == kNone)
            change |= kGraph,
                manifolds.touches[record.firstManifold + static_cast<std::size_t>(place[i])] = kUnknownTouch;
    }
    for (int k = 0; k < record.manifoldCapacity; ++k) {
        if (written[k] || old[k].pointCount == 0) continue;
        old[k].pointCount = 0;
        change |= kGraph;
        others = true;
    }
    if (others && holds(bodies, record)) change |= kPoints;
    return static_cast<std::uint8_t>(change);
}

std::uint8_t ContactWriter::takeSurfaceManifolds(ContactRecord& record, std::span<const Manifold> found) const {
    const std::span<ManifoldRecord> now = manifolds.of(record);
    ManifoldRecord before[kMaxManifolds];
    ManifoldImpulses known[kMaxManifolds], handed[kMaxManifolds];
    for (std::size_t k = 0; k < now.size(); ++k) before[k] = now[k], known[k] = impulsesOf(now[k]);
    const std::uint8_t change = takeManifolds(record, found);
    for (std::size_t k = 0; k < now.size(); ++k) handed[k] = matchedImpulses(before[k], known[k], now[k]);
    const float sizeA = shapes[record.shapeA].size, sizeB = shapes[record.shapeB].size;
    handOverImpulses({before, now.size()}, known, now, handed, sizeA < sizeB ? sizeA : sizeB);
    for (std::size_t k = 0; k < now.size(); ++k)
        if (now[k].pointCount > 0) writeImpulses(record, now[k], handed[k]);
    return change;
}

/// The points that were found as anchors in both bodies.
void ContactWriter::placePoints(const ContactRecord& record, const Manifold& found, ManifoldRecord& manifold) const {
    const ShapeRecord& shapeA = shapes[record.shapeA];
    const BodyRecord &a = bodies[record.bodyA], &b = bodies[record.bodyB];
    const Quat rotationA = a.rotation * shapeA.frame.rotation;
    const Vec3 offset = relative(b.center, a.center);
    const Vec3 originA = rotate(a.rotation, shapeA.frame.position);
    manifold.triangle = found.triangle;
    manifold.pointCount = found.pointCount;
    for (int j = 0; j < kMaxManifoldPoints; ++j) {
        const ManifoldPoint& point = found.points[j];
        const bool present = j < manifold.pointCount;
        manifold.feature[j] = present ? point.feature : 0;
        const Vec3 fromA = originA + rotate(rotationA, point.position);
        manifold.anchorA[j] = present ? transformPoint(shapeA.frame, point.position) : Vec3{};
        manifold.anchorB[j] = present ? inverseRotate(b.rotation, fromA - offset) : Vec3{};
        manifold.separation[j] = present ? point.separation : 0;
    }
}

}  // namespace ragtop
