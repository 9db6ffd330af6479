#include "narrowphase/distance.h"

namespace ragtop {
namespace {

SweepHit miss(float closer) {
    SweepHit out;
    out.fraction = closer;
    return out;
}

SweepHit hitAt(float fraction, const Vec3& origin, const Vec3& translation, const Vec3& normal) {
    return {true, fraction, origin + fraction * translation, normal};
}

SweepHit hitInside(const Vec3& origin, const Vec3& translation) {
    return {true, 0, origin, normalized(-translation, {0, 1, 0})};
}

/// From the foot of the perpendicular from `center` the ray enters half a chord earlier: no cancellation far away.
SweepHit castSphere(const Vec3& center, float radius, const Vec3& origin, const Vec3& translation, float closer) {
    const Vec3 fromCenter = origin - center;
    if (lengthSquared(fromCenter) <= radius * radius) return hitInside(origin, translation);
    const float travel2 = lengthSquared(translation);
    if (!(travel2 > 0)) return miss(closer);
    const float foot = -dot(fromCenter, translation) / travel2;
    const Vec3 beside = fromCenter + foot * translation;
    const float chord2 = radius * radius - lengthSquared(beside);
    if (chord2 < 0) return miss(closer);
    const float fraction = foot - std::sqrt(chord2 / travel2);
    if (!(fraction >= 0 && fraction <= closer)) return miss(closer);
    return hitAt(fraction, origin, translation, normalized(fromCenter + fraction * translation));
}

SweepHit castCapsule(const ConvexView& shape, const Vec3& origin, const Vec3& translation, float closer) {
    const float h = shape.halfExtents.y, r = shape.radius;
    const float nearestY = origin.y < -h ? -h : origin.y > h ? h : origin.y;
    if (lengthSquared(origin - Vec3{0, nearestY, 0}) <= r * r) return hitInside(origin, translation);
    // The tube: |(o + t d) without y| = r.
    const Vec3 o{origin.x, 0, origin.z}, d{translation.x, 0, translation.z};
    const float dd = lengthSquared(d);
    if (dd > 0) {
        const float foot = -dot(o, d) / dd;
        const float chord2 = r * r - lengthSquared(o + foot * d);
        if (chord2 < 0) return miss(closer);
        const float fraction = foot - std::sqrt(chord2 / dd);
        const float y = origin.y + fraction * translation.y;
        if (fraction >= 0 && y >= -h && y <= h) {
            if (!(fraction <= closer)) return miss(closer);
            return hitAt(fraction, origin, translation, normalized(o + fraction * d));
        }
    }
    const SweepHit low = castSphere({0, -h, 0}, r, origin, translation, closer);
    const SweepHit high = castSphere({0, h, 0}, r, origin, translation, closer);
    if (low.hit && high.hit) return low.fraction < high.fraction ? low : high;
    return low.hit ? low : high;
}

/// Clips the ray by planes one at a time [Cyrus, Beck, 1978].
struct PlaneClip {
    float enter = -1, leave = 2;
    Vec3 normal;
    bool outside = false;  ///< starts in front of some plane
    bool empty = false;

    void clip(const Vec3& planeNormal, float height, float speed) {
        outside = outside || height > 0;
        if (speed == 0) {
            empty = empty || height > 0;
            return;
        }
        const float t = -height / speed;
        if (speed < 0) {
            if (t > enter) {
                enter = t;
                normal = planeNormal;
            }
        } else if (t < leave) {
            leave = t;
        }
    }

    SweepHit result(const Vec3& origin, const Vec3& translation, float closer) const {
        if (!outside) return hitInside(origin, translation);
        if (empty || enter > leave || !(enter >= 0 && enter <= closer)) return miss(closer);
        return hitAt(enter, origin, translation, normal);
    }
};

}  // namespace

SweepHit castRay(const ConvexView& shape, const Vec3& origin, const Vec3& translation, float closer) {
    PlaneClip clip;
    switch (shape.kind) {
        case ConvexKind::sphere:
            return castSphere({}, shape.radius, origin, translation, closer);
        case ConvexKind::capsule:
            return castCapsule(shape, origin, translation, closer);
        case ConvexKind::box:
            for (int i = 0; i < 3; ++i) {
                Vec3 axis;
                axis[i] = 1;
                clip.clip(axis, origin[i] - shape.halfExtents[i], translation[i]);
                clip.clip(-axis, -origin[i] - shape.halfExtents[i], -translation[i]);
            }
            break;
        case ConvexKind::hull:
            for (const Plane& plane : shape.hull->planes) {
                clip.clip(plane.normal, dot(plane.normal, origin) - plane.offset, dot(plane.normal, translation));
            }
            break;
    }
    return clip.result(origin, translation, closer);
}

/// Signs of the volumes that the ray spans with the three edges, about the origin of the ray so that two triangles with
/// a common edge see the same number there [Möller, Trumbore, 1997].
SweepHit castRay(const TriangleView& triangle, const Vec3& origin, const Vec3& translation, float closer) {
    const Vec3 a = triangle.a - origin, b = triangle.b - origin, c = triangle.c - origin;
    const Vec3 n = cross(b - a, c - a);
    const float speed = dot(n, translation);
    if (!(speed < 0)) return miss(closer);
    const float u = dot(translation, cross(b, c)), v = dot(translation, cross(c, a)), w = dot(translation, cross(a, b));
    if (u > 0 || v > 0 || w > 0) return miss(closer);
    const float fraction = dot(n, a) / speed;
    if (!(fraction >= 0 && fraction <= closer)) return miss(closer);
    SweepHit hit = hitAt(fraction, origin, translation, triangle.normal);
    hit.onFace = true;
    return hit;
}

}  // namespace ragtop
