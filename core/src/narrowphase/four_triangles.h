#pragma once

#include <cstddef>

#include "base/four_floats.h"
#include "shapes/geometry.h"

namespace ragtop {

/// Four triangles side by side.
struct FourTriangles {
    FourVectors v[3];  ///< corners
    FourVectors n;     ///< normals

    /// Seen from `origin`.
    FourTriangles(const TriangleView* const triangles[4], const Vec3& origin) {
        static_assert(offsetof(TriangleView, activeEdges) == 12 * sizeof(float));
        FourFloats rows[3][4];
        for (int i = 0; i < 4; ++i)
            for (int part = 0; part < 3; ++part) rows[part][i] = loadFour(&triangles[i]->a.x + 4 * part);
        for (auto& part : rows) transposeFour(part);
        const FourVectors from = spread(origin);
        v[0] = FourVectors{rows[0][0], rows[0][1], rows[0][2]} - from;
        v[1] = FourVectors{rows[0][3], rows[1][0], rows[1][1]} - from;
        v[2] = FourVectors{rows[1][2], rows[1][3], rows[2][0]} - from;
        n = {rows[2][1], rows[2][2], rows[2][3]};
    }
};

}  // namespace ragtop
