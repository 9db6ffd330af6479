#include "narrowphase/four_capsules.h"

#include "narrowphase/clip.h"
#include "narrowphase/round_constants.h"

namespace ragtop {

namespace {

FourFloats clamped(FourFloats v) {
    const FourFloats none = {}, one = none + 1.0f;
    v = v < 0.0f ? none : v;
    return v > 1.0f ? one : v;
}

struct FourClosest {
    FourVectors pointA, pointB;
};

/// As closestOnSegments.
FourClosest closestOnFour(const FourVectors& p, const FourVectors& d, const FourVectors& q, const FourVectors& e) {
    const FourFloats none = {};
    const FourVectors r = p - q;
    const FourFloats dd = dot(d, d), ee = dot(e, e), de = dot(d, e), dr = dot(d, r), er = dot(e, r);
    const FourFloats denominator = dd * ee - de * de;
    const FourInts longA = dd > 0.0f, longB = ee > 0.0f;
    const FourInts skew = longA & (denominator > kParallelSegments * dd * ee);
    FourFloats s = skew ? clamped((de * er - dr * ee) / denominator) : none;
    const FourFloats asked = (de * s + er) / ee, t = longB ? clamped(asked) : none;
    const FourFloats again = clamped((de * t - dr) / dd), alone = clamped(-dr / dd);
    s = (longA & longB & (asked != t)) ? again : s;
    s = (longA & ~longB) ? alone : s;
    return {p + s * d, q + t * e};
}

}  // namespace

void touchFour(const FourCapsules& pairs, CapsuleTouch (&out)[4]) {
    const FourFloats none = {};
    const FourVectors p{none, -pairs.halfHeightA, none}, d = -2.0f * p;
    const FourVectors halfB = rotate(pairs.rotation, {none, pairs.halfHeightB, none});
    const FourVectors q = pairs.position - halfB, e = 2.0f * halfB;
    const FourClosest near = closestOnFour(p, d, q, e);
    const FourVectors way = near.pointB - near.pointA;
    const FourFloats distance = length(way), separation = distance - pairs.radiusA - pairs.radiusB;
    const FourVectors normal = (1.0f / distance) * way;
    const FourVectors point = near.pointA + (pairs.radiusA + 0.5f * separation) * normal;
    const FourVectors across = cross(d, e);
    const FourInts crossing = dot(across, across) > kNearlyParallel * dot(d, d) * dot(e, e);
    const FourInts single = crossing & (distance > 0.0f);
    for (int i = 0; i < 4; ++i)
        out[i] = {{normal.x[i], normal.y[i], normal.z[i]},
                  {point.x[i], point.y[i], point.z[i]},
                  separation[i],
                  single[i] != 0};
}

int takeTouch(const CapsuleTouch& touch, float margin, Manifold& out) {
    out.pointCount = touch.separation > margin ? 0 : 1;
    out.gap = touch.separation > margin ? touch.separation : margin;
    if (out.pointCount == 0) return 0;
    out.normal = touch.normal;
    out.points[0] = {touch.point, touch.separation, kPointFeature};
    return 1;
}

}  // namespace ragtop
