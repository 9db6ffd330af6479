#pragma once

#include "narrowphase/four_triangles.h"
#include "narrowphase/triangle_feature.h"

namespace ragtop {

/// `nearestOnTriangle` for four triangles side by side, with the same operations in the same order.
struct NearestFour {
    FourVectors point;
    FourFloats square;  ///< m², of its distance
    FourFloats height;  ///< m, of the point asked about above the planes
    FourInts inside;    ///< it lies on the face
    FourInts place;     ///< 0 face, 1 + i edge, 4 + i vertex

    Vec3 pointAt(int lane) const { return {point.x[lane], point.y[lane], point.z[lane]}; }
    Feature featureAt(int lane) const {
        const int at = place[lane];
        return at == 0 ? Feature{} : at < 4 ? Feature{Feature::edge, at - 1} : Feature{Feature::vertex, at - 4};
    }
};

/// Of a point, seen from it.
inline NearestFour nearestOnFour(const TriangleView* const triangles[4], const Vec3& from) {
    const FourTriangles t(triangles, from);
    const FourVectors(&v)[3] = t.v;
    const FourVectors& n = t.n;
    const FourVectors zero{};

    NearestFour out;
    FourVectors best = zero;
    FourFloats least = {};
    out.inside = FourInts{-1, -1, -1, -1};
    out.place = FourInts{};
    for (int i = 0; i < 3; ++i) {
        const int j = i == 2 ? 0 : i + 1;
        const FourVectors e = v[j] - v[i], r = zero - v[i];
        const FourInts outside = ~(dot(cross(n, e), r) >= 0.0f);
        const FourFloats along = dot(r, e), ee = dot(e, e);
        const FourInts atStart = along <= 0.0f, atEnd = ~atStart & (along >= ee);
        const FourVectors near = select(atStart, v[i], select(atEnd, v[j], v[i] + (along / ee) * e));
        const FourVectors way = zero - near;
        const FourFloats square = dot(way, way);
        const FourInts better = outside & (out.inside | ~(square >= least));
        out.inside &= ~outside;
        least = better ? square : least;
        best = select(better, near, best);
        const FourInts place = atStart ? spread(4 + i) : atEnd ? spread(4 + j) : spread(1 + i);
        out.place = better ? place : out.place;
    }
    const FourFloats offset = dot(n, zero - v[0]);
    out.point = select(out.inside, zero - offset * n, best);
    out.square = dot(out.point, out.point);
    out.height = 0.0f - dot(n, v[0]);
    return out;
}

}  // namespace ragtop
