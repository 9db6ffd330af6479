#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "narrowphase/collide.h"
#include "narrowphase/distance.h"
#include "ragtop/shape.h"
#include "shapes/hull.h"
#ifdef RAGTOP_WITH_CCD
#include <ccd/ccd.h>
#include <ccd/quat.h>
#endif

/// Random placements and slow, double-precision or foreign answers to what the narrow phase computes.
namespace ragtop {

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}
    /// Uniform in [low, high).
    float uniform(float low, float high) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return low + (high - low) * static_cast<float>(state_ >> 40) * 0x1p-24f;
    }
    Vec3 inBox(float half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    Vec3 direction() {
        for (;;) {
            const Vec3 v = inBox(1);
            const float square = lengthSquared(v);
            if (square > 0.01f && square < 1) return normalized(v);
        }
    }
    Vec3 vector(float shortest, float longest) {
        const float length = uniform(shortest, longest);
        return length * direction();
    }
    Quat rotation(float most = kPi) {
        const Vec3 axis = direction();
        return rotationAbout(axis, uniform(-most, most));
    }

private:
    std::uint64_t state_;
};

inline ConvexView sphereView(float radius) { return {ConvexKind::sphere, radius, {}, nullptr}; }
inline ConvexView capsuleView(float radius, float halfHeight) {
    return {ConvexKind::capsule, radius, {0, halfHeight, 0}, nullptr};
}
inline ConvexView boxView(const Vec3& half) { return {ConvexKind::box, 0, half, nullptr}; }
inline ConvexView hullView(const HullData& data) { return {ConvexKind::hull, 0, {}, &data}; }

inline std::vector<Vec3> randomPoints(Random& random, int count, float size) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) points.push_back(size * random.vector(0.6f, 1));
    return points;
}

inline Manifold collided(const ConvexView& a, const ConvexView& b, const Frame& bInA, float margin = 0) {
    SeparationCache cache;
    Manifold out;
    collide(a, b, bInA, margin, cache, out);
    return out;
}

inline float deepest(const Manifold& m) {
    float least = m.points[0].separation;
    for (int i = 1; i < m.pointCount; ++i) least = std::min(least, m.points[i].separation);
    return least;
}

inline void expectNear(const Vec3& actual, const Vec3& expected, float tolerance) {
    EXPECT_LE(length(actual - expected), tolerance)
        << "(" << actual.x << ", " << actual.y << ", " << actual.z << ") instead of (" << expected.x << ", "
        << expected.y << ", " << expected.z << ")";
}

/// Corners and candidate axes of a polyhedron in double precision.
struct ExactHull {
    std::vector<DVec3> vertices, normals, edges;

    ExactHull(const ConvexView& view, const Frame& frame) {
        const BoxHull box(view.halfExtents);
        const HullView hull = view.kind == ConvexKind::box ? box.view() : viewOf(*view.hull);
        for (const Vec3& v : hull.vertices) vertices.push_back(turn(frame.rotation, DVec3(v)) + frame.position);
        for (const Plane& p : hull.planes) normals.push_back(turn(frame.rotation, DVec3(p.normal)));
        for (const HullData::Edge& e : hull.edges) edges.push_back(vertices[e.to] - vertices[e.from]);
    }
    static DVec3 crossOf(const DVec3& a, const DVec3& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    static double dotOf(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    static DVec3 turn(const Quat& q, const DVec3& v) {
        const DVec3 u(q.x, q.y, q.z), t = 2.0 * crossOf(u, v);
        return v + q.w * t + crossOf(u, t);
    }
};

/// How far B is from A along the unit direction n.
inline double separationAlong(const ExactHull& a, const ExactHull& b, const DVec3& n) {
    double high = -1e300, low = 1e300;
    for (const DVec3& v : a.vertices) high = std::max(high, ExactHull::dotOf(v, n));
    for (const DVec3& v : b.vertices) low = std::min(low, ExactHull::dotOf(v, n));
    return low - high;
}

/// The greatest separation along all normals of faces and products of edges: minus the depth when positive overlap.
inline double separationOf(const ExactHull& a, const ExactHull& b) {
    double best = -1e300;
    const auto attempt = [&](const DVec3& n) {
        const double length = std::sqrt(ExactHull::dotOf(n, n));
        if (length < 1e-9) return;
        const DVec3 unit = (1 / length) * n;
        best = std::max({best, separationAlong(a, b, unit), separationAlong(a, b, -1.0 * unit)});
    };
    for (const DVec3& n : a.normals) attempt(n);
    for (const DVec3& n : b.normals) attempt(n);
    for (const DVec3& e : a.edges) {
        for (const DVec3& f : b.edges) attempt(ExactHull::crossOf(e, f));
    }
    return best;
}

#ifdef RAGTOP_WITH_CCD
/// A shape as libccd sees it.
struct CcdShape {
    const ConvexView& view;
    Frame frame;

    static void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
        const auto& self = *static_cast<const CcdShape*>(object);
        const DVec3 d(direction->v[0], direction->v[1], direction->v[2]);
        const double length = std::sqrt(ExactHull::dotOf(d, d));
        const DVec3 n = (1 / length) * d;
        const Vec3 core = supportOfCore(self.view, inverseRotate(self.frame.rotation, toVec3(n)));
        const DVec3 p = ExactHull::turn(self.frame.rotation, DVec3(core)) + self.frame.position +
                        static_cast<double>(self.view.radius) * n;
        ccdVec3Set(out, p.x, p.y, p.z);
    }
    static void center(const void* object, ccd_vec3_t* out) {
        const auto& self = *static_cast<const CcdShape*>(object);
        const Vec3 c = transformPoint(self.frame, self.view.hull ? self.view.hull->center : Vec3{});
        ccdVec3Set(out, c.x, c.y, c.z);
    }
};

inline ccd_t ccdSettings() {
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = CcdShape::support;
    ccd.center1 = ccd.center2 = CcdShape::center;
    ccd.max_iterations = 500;
    ccd.epa_tolerance = 1e-6;
    return ccd;
}
#endif

}  // namespace ragtop
