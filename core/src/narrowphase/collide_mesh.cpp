#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <type_traits>

#include "narrowphase/box_on_triangles.h"
#include "narrowphase/manifold_set.h"
#include "narrowphase/nearest_four.h"
#include "narrowphase/surface_mover.h"
#include "narrowphase/triangle_contact.h"

/// A convex shape on a surface of triangles. Every triangle is tested on its own; then a contact whose direction the
/// whole surface could not give (it would lie inside a neighbouring face) turns to the face normal or goes.
namespace ragtop {
namespace {

/// Of the size: how far the centre may be behind a face that still pushes it out.
constexpr float kBehind = 0.25f;
/// Of the size: how deep under a face a contact may lie whose own direction was refused. Deeper ones belong to a face
/// beside it.
constexpr float kDeepest = 0.25f;
/// Of the size: how near a way has to come to a surface to meet it.
constexpr float kMeets = 1e-3f;
/// Sine of the angle by which a neighbour may rise above the plane of a contact.
constexpr float kRise = 0.01f;
/// Of the size: what lies this near to a point of the surface is at it.
constexpr float kAtPoint = 1e-3f;
/// Of the size: how much farther than where it is the triangles around a shape are remembered.
constexpr float kRoom = 0.5f;

template <class Surface>
class SurfaceContacts {
public:
    /// `known`: what is remembered of the surface here, if anything is.
    SurfaceContacts(const Surface& surface, const Mover& mover, const Approach& approach,
                    NearTriangles* known = nullptr)
        : surface_(surface),
          mover_(mover),
          approach_(approach),
          looksAhead_(approach.looksAhead()),
          origin_(mover.position),
          known_(known),
          set_(mover.size) {}

    int run(std::span<Manifold> out) {
        const Bounds bounds = mover_.bounds();
        gather(bounds);
        if (mover_.shape->kind == ConvexKind::sphere && gatheredAll_) {
            visitGatheredWithSphere();
        } else if (mover_.box) {
            visitWithBox(bounds);
        } else {
            const auto visitOne = [this](const TriangleView& view) {
                visit(view);
                return true;
            };
            forEachNear(bounds, visitOne);
        }
        if (aheadCount_ > 0) touchAhead(bounds);
        return set_.write(mover_.position, out);
    }

private:
    /// Keeps the triangles around the mover, so that what lies at its contacts is found without another walk.
    void gather(const Bounds& bounds) {
        const Vec3 reach = reachAt(max(abs(bounds.lower), abs(bounds.upper)));
        gathered_ = {bounds.lower - reach, bounds.upper + reach};
        const auto keep = [this](const TriangleView& view) {
            gatheredAll_ = nearCount_ < kMostNear;
            if (gatheredAll_) std::construct_at(&near_[nearCount_++], view);
            return gatheredAll_;
        };
        if constexpr (std::is_same_v<Surface, MeshData>) {
            if (known_) return forEachTriangle(surface_, gathered_, kRoom * mover_.size, *known_, keep);
        }
        forEachTriangle(surface_, gathered_, keep);
    }

    /// As forEachTriangle.
    template <class Visit>
    void forEachNear(const Bounds& bounds, Visit&& visitOne) const {
        if (!gatheredAll_ || !contains(gathered_, bounds)) return forEachTriangle(surface_, bounds, visitOne);
        for (int i = 0; i < nearCount_; ++i) {
            const TriangleView& view = near_[i];
            if (overlaps(boundsOfTriangle(view.a, view.b, view.c), bounds) && !visitOne(view)) return;
        }
    }

    /// How far around a place of the mesh the corners there may lie.
    Vec3 reachAt(const Vec3& place) const {
        constexpr float kRounding = 1e-6f;  // eight units in the last place
        const float near = kAtPoint * mover_.size;
        return Vec3{near, near, near} + kRounding * abs(place);
    }

    void visit(const TriangleView& view) {
        const TriangleHull t(view, mover_.position);
        const float height = dot(t.normal(), mover_.center) - t.planes[0].offset;
        if (height < -kBehind * mover_.size) return;
        if (mover_.shape->kind == ConvexKind::sphere) return takeSphere(view, t, nearestTo(t, height));
        TriangleContact contact;
        touch(view, t, contact);
        takeContact(view, t, contact);
    }

    void touch(const TriangleView& view, const TriangleHull& t, TriangleContact& contact) const {
        if (mover_.shape->kind == ConvexKind::sphere) return touchSphere(t, nearestTo(t, -t.planes[0].offset), contact);
        if (mover_.box) return touchBoxAgain(view, t, contact);
        if (mover_.hull) return touchHull(t, contact);
        Manifold m;
        pairs::hullCapsule(t.view(), mover_.p, mover_.q, mover_.shape->radius, mover_.margin, m);
        contact.take(m);
    }

    void takeContact(const TriangleView& view, const TriangleHull& t, TriangleContact& contact) {
        if (contact.count == 0) return;
        const float gap = leastSeparation(contact.all());
        if (looksAhead_ && gap > approach_.near) return noteAhead(view);
        point(t, contact);
        // What it is beside now it may come over, and what it is before it may pass.
        const bool maybe = contact.count == 0 || (gap > 0 && !(contact.normal == t.normal()));
        if (looksAhead_ && maybe) return noteAhead(view);
        set_.add(contact.normal, contact.all(), t.index);
    }

    void noteAhead(const TriangleView& view) {
        if (aheadCount_ < kMostNear) std::construct_at(&ahead_[aheadCount_], view);
        ++aheadCount_;
    }

    /// More than are remembered are found again; points of near ones among them are known already.
    template <class Visit>
    void forEachAhead(const Bounds& bounds, Visit&& visitOne) {
        const auto visitAll = [&](const TriangleView& view) {
            visitOne(view);
            return true;
        };
        if (aheadCount_ > kMostNear) return forEachNear(bounds, visitAll);
        for (int i = 0; i < aheadCount_; ++i) visitOne(ahead_[i]);
    }

    /// What lies ahead is touched where the mover meets it on its way, which each of the planes that it comes to turns
    /// along itself; beyond, it would be inside of the surface. What it does not meet is touched where the way ends.
    void touchAhead(const Bounds& bounds) {
        constexpr int kMostTurns = 4;  // of a way
        std::uint32_t met[kMostTurns];
        Vec3 gone{}, last{};
        Approach left = approach_;
        left.near = kMeets * mover_.size;
        int turns = 0;
        while (turns < kMostTurns) {
            left.way = set_.slid(left.way, gone, approach_.near);
            // Nearly the same directions are one to the set.
            left.way -= std::min(0.0f, dot(left.way, last)) * last;
            float share = 1;
            TriangleContact first;
            const auto meet = [&](const TriangleView& view) {
                for (int k = 0; k < turns; ++k)
                    if (met[k] == view.index) return;
                TriangleContact contact;
                if (!meets(view, gone, left, contact, share)) return;
                first = contact;
                met[turns] = view.index;
            };
            forEachAhead(bounds, meet);
            if (first.count == 0) break;
            gone += share * left.way;
            left.way *= 1 - share;
            last = first.normal;
            add(first, gone, met[turns++]);
        }
        if (turns < kMostTurns) gone += left.way;
        forEachAhead(bounds, [&](const TriangleView& view) {
            TriangleContact contact;
            touchAt(gone, view, contact);
            if (contact.count > 0) point(TriangleHull(view, origin_), contact);
            add(contact, gone, view.index);
        });
        origin_ = mover_.position;
    }

    /// Does the mover, where it has gone already, meet a triangle before a share of the way that is left? Then that
    /// share and the contact there: over its face where its plane is reached, or with what of it is reached first.
    bool meets(const TriangleView& view, const Vec3& gone, const Approach& left, TriangleContact& contact,
               float& share) {
        origin_ = mover_.position + gone;
        const float above = mover_.above(TriangleHull(view, origin_).planes[0]), along = dot(left.way, view.normal);
        if (above + along > -left.near) return false;
        if (above >= 0 && above < -along * share && touchesAt(gone + above / -along * left.way, view, contact) &&
            contact.normal == view.normal) {
            share = above / -along;
            return true;
        }
        touchAt(gone, view, contact);
        const float there = goToMeet(
            left, contact, [&](float part, TriangleContact& at) { touchAt(gone + part * left.way, view, at); });
        if (!(there < share) || contact.count == 0 || !touchesAt(gone + there * left.way, view, contact)) return false;
        share = there;
        return true;
    }

    /// Does the surface push the mover where it has gone?
    bool touchesAt(const Vec3& gone, const TriangleView& view, TriangleContact& contact) {
        touchAt(gone, view, contact);
        if (contact.count > 0) point(TriangleHull(view, origin_), contact);
        return contact.count > 0 && leastSeparation(contact.all()) <= approach_.near;
    }

    /// Adds a contact that is found where the mover has gone, with the separations of now; none where the mover is
    /// behind its plane now, which it passes.
    void add(TriangleContact& contact, const Vec3& gone, std::uint32_t triangle) {
        for (ManifoldPoint& at : contact.all()) at.separation -= dot(gone, contact.normal);
        if (contact.count > 0 && leastSeparation(contact.all()) >= -approach_.near)
            set_.add(contact.normal, contact.all(), triangle);
    }

    /// The contact with a triangle where the mover has gone some of its way.
    void touchAt(const Vec3& gone, const TriangleView& view, TriangleContact& contact) {
        origin_ = mover_.position + gone;
        const TriangleHull t(view, origin_);
        contact.clear();
        const float height = dot(t.normal(), mover_.center) - t.planes[0].offset;
        if (height >= -kBehind * mover_.size) touch(view, t, contact);
    }

    /// Turns a contact to where the surface may push, or leaves it out, and names its points.
    void point(const TriangleHull& t, TriangleContact& contact) const {
        if (mover_.shape->kind == ConvexKind::sphere) {
            if (!mayPointAtSphere(t, nearestTo(t, -t.planes[0].offset), contact.normal)) contact.clear();
            return;
        }
        bool onFace = contact.normal == t.normal();
        if (!onFace && !mayPoint(t, contact)) {
            onFace = true;
            turnToFace(t, contact);
        }
        nameFeatures(contact, onFace, t.index);
    }

    void touchHull(const TriangleHull& t, TriangleContact& contact) const {
        const HullView triangle = t.view();
        const HullView& hull = mover_.hull->view();
        const SeparatingAxis front = alongAxis(triangle, hull, 1, 0, 0);
        if (front.separation > mover_.margin) return;
        const SeparatingAxis axis = chooseAxis(triangle, hull, mover_.margin, mover_.size, front).best;
        if (axis.separation > mover_.margin) return;
        if (axis.kind == 1) {
            contact.normal = t.normal();
            contact.count = clipToFace(triangle, 0, hull, mover_.margin, mover_.size, false, contact.points);
            if (contact.count > 0) return;
        }
        Manifold m;
        pairs::hullContact(triangle, hull, axis, mover_.margin, mover_.size, m);
        // Overlap found along the face normal, but not over the face: a neighbour has it.
        if (axis.kind == 1 && m.pointCount > 0 && m.normal == t.normal()) return;
        contact.take(m);
    }

    void visitWithBox(const Bounds& bounds) {
        TriangleView copies[4];
        const TriangleView* four[4];
        int count = 0;
        forEachNear(bounds, [&](const TriangleView& view) {
            copies[count] = view;
            four[count] = &copies[count];
            if (++count == 4) visitFourWithBox(four, 4), count = 0;
            return true;
        });
        if (count == 0) return;
        for (int k = count; k < 4; ++k) four[k] = four[0];
        visitFourWithBox(four, count);
    }

    void visitFourWithBox(const TriangleView* const (&four)[4], int count) {
        const BoxAxes axes = findBoxAxes(*mover_.box, FourTriangles(four, mover_.position), mover_.margin,
                                         kBehind * mover_.size);
        for (unsigned touches = axes.touches & ((1u << count) - 1); touches != 0; touches &= touches - 1) {
            const int k = std::countr_zero(touches);
            const TriangleHull t(*four[k], mover_.position);
            TriangleContact contact;
            touchBox(t, axes, k, contact);
            takeContact(*four[k], t, contact);
        }
    }

    /// One triangle, where the mover has gone some of its way.
    void touchBoxAgain(const TriangleView& view, const TriangleHull& t, TriangleContact& contact) const {
        const TriangleView* const four[4] = {&view, &view, &view, &view};
        const BoxAxes axes =
            findBoxAxes(*mover_.box, FourTriangles(four, origin_), mover_.margin, kBehind * mover_.size);
        if (axes.touches != 0) touchBox(t, axes, 0, contact);
    }

    void touchBox(const TriangleHull& t, const BoxAxes& axes, int lane, TriangleContact& contact) const {
        const TurnedBox& box = *mover_.box;
        const CornersAndNormal triangle{t.vertices, t.normal()};
        const int axis = axes.axis[lane];
        const float separation = axes.separation[lane];
        switch (axes.kind(lane)) {
            case BoxAxes::kTriangle:
                contact.normal = t.normal();
                contact.count = boxFaceOnTriangle(box, triangle, mover_.margin, contact.points);
                break;
            case BoxAxes::kBoxFace:
                contact.count = triangleOnBoxFace(box, triangle, axis, mover_.margin, contact.normal, contact.points);
                break;
            case BoxAxes::kEdges:
                contact.count = edgesOfBoxAndTriangle(box, triangle, axis, separation, mover_.margin, contact.normal,
                                                      contact.points);
                break;
        }
        if (contact.count > 0) return;
        Vec3 corners[8];
        for (int i = 0; i < 8; ++i) corners[i] = box.corner(i);
        Manifold m;
        pairs::cornerContact(t.vertices, corners, t.view().center, {0, 0, 0, separation, contact.normal},
                             mover_.margin, m);
        // Overlap found along the face normal, but not over the face: a neighbour has it.
        if (axis == 0 && m.pointCount > 0 && m.normal == t.normal()) return;
        contact.take(m);
    }

    void visitGatheredWithSphere() {
        constexpr float kRounding = 1e-5f;  // some 80 units in the last place
        const float reach = mover_.shape->radius + mover_.margin, most = (1 + kRounding) * reach * reach;
        for (int first = 0; first < nearCount_; first += 4) {
            const int count = nearCount_ - first < 4 ? nearCount_ - first : 4;
            const TriangleView* four[4];
            for (int k = 0; k < 4; ++k) four[k] = &near_[k < count ? first + k : first];
            const NearestFour nearest = nearestOnFour(four, mover_.position);
            const FourInts inFront = nearest.height >= -kBehind * mover_.size;
            unsigned touches = lanesWhere(inFront & (nearest.inside | (nearest.square <= most))) & ((1u << count) - 1);
            for (; touches != 0; touches &= touches - 1) {
                const int k = std::countr_zero(touches);
                const TriangleHull t(*four[k], mover_.position);
                takeSphere(*four[k], t, {nearest.pointAt(k), nearest.featureAt(k), nearest.height[k]});
            }
        }
    }

    /// Where a triangle is nearest to the centre of a sphere, and how far above its plane the centre is.
    struct NearestPoint {
        Vec3 at;
        Feature feature;
        float height = 0;
    };

    static NearestPoint nearestTo(const TriangleHull& t, float height) {
        NearestPoint nearest;
        nearest.at = nearestOnTriangle(t.vertices, t.normal(), {}, nearest.feature);
        nearest.height = height;
        return nearest;
    }

    void touchSphere(const TriangleHull& t, const NearestPoint& nearest, TriangleContact& contact) const {
        const bool onFace = nearest.feature.kind == Feature::face;
        const float distance = onFace ? nearest.height : length(nearest.at);
        const float separation = distance - mover_.shape->radius;
        contact.clear();
        if (separation > mover_.margin || (!onFace && !(nearest.height >= 0 && distance > 0))) return;
        contact.normal = onFace ? t.normal() : (-1.0f / distance) * nearest.at;
        contact.points[contact.count++] = {nearest.at + 0.5f * separation * contact.normal, separation, kPointFeature};
    }

    void takeSphere(const TriangleView& view, const TriangleHull& t, const NearestPoint& seen) {
        TriangleContact contact;
        touchSphere(t, seen, contact);
        if (contact.count == 0) return;
        if (looksAhead_ && contact.points[0].separation > approach_.near) return noteAhead(view);
        if (mayPointAtSphere(t, seen, contact.normal)) set_.add(contact.normal, contact.all(), t.index);
    }

    bool mayPointAtSphere(const TriangleHull& t, const NearestPoint& nearest, const Vec3& normal) const {
        const Feature& feature = nearest.feature;
        if (feature.kind == Feature::face) return true;
        // A corner is reported by a neighbour too if any edge there is active.
        const int index = feature.index, before = index == 0 ? 2 : index - 1;
        const bool active = edgeIsActive(t, index) || (feature.kind == Feature::vertex && edgeIsActive(t, before));
        return active && isOutermost(nearest.at, normal);
    }

    /// May the surface push along m.normal where the contact is? Not from behind, not from a flat or concave edge, and
    /// not where a neighbour rises above the plane of the contact.
    bool mayPoint(const TriangleHull& t, const TriangleContact& contact) const {
        if (dot(contact.normal, t.normal()) < -kRise) return false;
        const Feature feature = featureAlong(t, contact.normal);
        if (feature.kind == Feature::face) return false;
        if (feature.kind == Feature::edge && !edgeIsActive(t, feature.index)) return false;
        Vec3 at = t.vertices[feature.index];
        if (feature.kind == Feature::edge) {
            int deepest = 0;
            for (int i = 1; i < contact.count; ++i) {
                if (contact.points[i].separation < contact.points[deepest].separation) deepest = i;
            }
            const Vec3 e = t.vertices[feature.index == 2 ? 0 : feature.index + 1] - at;
            const float along = dot(contact.points[deepest].position - at, e) / lengthSquared(e);
            at += (along < 0 ? 0.0f : along > 1 ? 1.0f : along) * e;
        }
        return isOutermost(at, contact.normal);
    }

    /// Do all triangles at a point of the surface lie below the plane through it?
    bool isOutermost(const Vec3& at, const Vec3& normal) const {
        const float near = kAtPoint * mover_.size;
        const Vec3 place = origin_ + at, reach = reachAt(place);
        bool outermost = true;
        forEachNear({place - reach, place + reach}, [&](const TriangleView& view) {
            const TriangleHull other(view, origin_);
            Feature feature;
            const Vec3 nearest = nearestOnTriangle(other.vertices, other.normal(), at, feature);
            if (lengthSquared(nearest - at) > 4 * lengthSquared(reach)) return true;
            for (const Vec3& vertex : other.vertices) {
                const Vec3 way = vertex - at;
                const float rise = dot(normal, way) - near;
                if (rise > 0 && rise * rise > kRise * kRise * lengthSquared(way)) outermost = false;
            }
            return outermost;
        });
        return outermost;
    }

    /// Replaces a refused contact by that of the face alone; none when the shape is not over it or too deep under it.
    void turnToFace(const TriangleHull& t, TriangleContact& contact) const {
        const float twice = 2 * leastSeparation(contact.all()), usual = -kDeepest * mover_.size;
        const float limit = twice < usual ? twice : usual;
        contact.normal = t.normal();
        if (mover_.box) {
            contact.count =
                boxFaceOnTriangle(*mover_.box, {t.vertices, t.normal()}, mover_.margin, contact.points);
        } else if (mover_.hull) {
            contact.count =
                clipToFace(t.view(), 0, mover_.hull->view(), mover_.margin, mover_.size, false, contact.points);
        } else {
            const pairs::Rod rod{mover_.p, mover_.q, mover_.shape->radius, mover_.margin, mover_.size};
            contact.count = pairs::segmentOnFace(t.view(), 0, rod, contact.points);
        }
        int kept = 0;
        for (int i = 0; i < contact.count; ++i) {
            if (contact.points[i].separation >= limit) contact.points[kept++] = contact.points[i];
        }
        contact.count = kept;
    }

    static constexpr int kMostNear = 48;  ///< gathered at a time, in groups of four

    const Surface& surface_;
    const Mover& mover_;
    const Approach& approach_;
    const bool looksAhead_;
    Vec3 origin_;  ///< of the axes that contacts are seen in: the mover's, or where it has gone to
    NearTriangles* known_;
    ManifoldSet set_;
    Bounds gathered_;
    bool gatheredAll_ = true;
    int nearCount_ = 0;
    int aheadCount_ = 0;
    union {  // not filled with zeros first
        TriangleView near_[kMostNear];
    };
    union {
        TriangleView ahead_[kMostNear];
    };
};

}  // namespace

int collide(const MeshData& a, const ConvexView& b, const Frame& bInA, float margin, std::span<Manifold> out,
            const Approach& approach) {
    const Mover mover(b, bInA, margin);
    return SurfaceContacts<MeshData>(a, mover, approach).run(out);
}

int collide(const MeshData& a, const ConvexView& b, const Frame& bInA, float margin, NearTriangles& near,
            std::span<Manifold> out, const Approach& approach) {
    const Mover mover(b, bInA, margin);
    return SurfaceContacts<MeshData>(a, mover, approach, &near).run(out);
}

int collide(const HeightFieldData& a, const ConvexView& b, const Frame& bInA, float margin, std::span<Manifold> out,
            const Approach& approach) {
    const Mover mover(b, bInA, margin);
    return SurfaceContacts<HeightFieldData>(a, mover, approach).run(out);
}

}  // namespace ragtop
