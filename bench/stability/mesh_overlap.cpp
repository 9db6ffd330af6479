#include "mesh_overlap.h"

#include <algorithm>
#include <cmath>

#include "extremes.h"
#include "ragtop/surface_mesh.h"

namespace ragtop::stability {
namespace {

/// A closed part of a body where it is, corners from a common origin.
struct Solid {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    Bounds bounds;
    bool ground = false;  ///< a height field: all below it is inside
};

Solid placed(const Shape& shape, const Frame& frame) {
    const SurfaceMesh mesh = surfaceOf(shape);
    const Vec3 size = surfaceScale(shape);
    Solid solid;
    solid.ground = std::holds_alternative<HeightField>(shape);
    for (const Vec3& v : mesh.vertices) solid.vertices.push_back(transformPoint(frame, scale(size, v)));
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        solid.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    solid.bounds = {solid.vertices[0], solid.vertices[0]};
    for (const Vec3& v : solid.vertices) solid.bounds = {min(solid.bounds.lower, v), max(solid.bounds.upper, v)};
    return solid;
}

void addSolids(const Shape& shape, const Frame& frame, std::vector<Solid>& into) {
    if (const auto* compound = std::get_if<Compound>(&shape)) {
        for (const CompoundPart& part : compound->parts) addSolids(part.shape, frame * part.frame, into);
    } else {
        into.push_back(placed(shape, frame));
    }
}

bool contains(const Bounds& b, const Vec3& p) {
    return p.x >= b.lower.x && p.y >= b.lower.y && p.z >= b.lower.z && p.x <= b.upper.x && p.y <= b.upper.y &&
           p.z <= b.upper.z;
}

bool isBelow(const Solid& ground, const Vec3& p) {
    for (const Triangle& t : ground.triangles) {
        const Vec3 a = ground.vertices[t.a] - p, b = ground.vertices[t.b] - p, c = ground.vertices[t.c] - p;
        // Areas of the corners as seen from above.
        const float u = b.z * c.x - b.x * c.z, v = c.z * a.x - c.x * a.z, w = a.z * b.x - a.x * b.z;
        if (u >= 0 && v >= 0 && w >= 0 && u + v + w > 0) return u * a.y + v * b.y + w * c.y > 0;
    }
    return false;
}

/// Σ of the solid angles of the triangles is 4π inside and 0 outside [Van Oosterom, Strackee, The Solid Angle of a
/// Plane Triangle, 1983].
bool isInside(const Solid& solid, const Vec3& p) {
    if (solid.ground) return isBelow(solid, p);
    double sum = 0;
    for (const Triangle& t : solid.triangles) {
        const Vec3 a = solid.vertices[t.a] - p, b = solid.vertices[t.b] - p, c = solid.vertices[t.c] - p;
        const double la = static_cast<double>(length(a)), lb = static_cast<double>(length(b)),
                     lc = static_cast<double>(length(c));
        const auto d = [](const Vec3& u, const Vec3& v) { return static_cast<double>(dot(u, v)); };
        sum += 2 * std::atan2(d(a, cross(b, c)), la * lb * lc + d(a, b) * lc + d(b, c) * la + d(c, a) * lb);
    }
    return sum > 6.28;
}

/// [Ericson 2005, ch. 5.1.5]
float distanceTo(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto toSegment = [&](const Vec3& u, const Vec3& v) {
        const Vec3 e = v - u;
        const float ee = lengthSquared(e);
        const float t = ee > 0 ? std::clamp(dot(p - u, e) / ee, 0.0f, 1.0f) : 0.0f;
        return length(p - u - t * e);
    };
    const Vec3 n = normalized(cross(b - a, c - a));
    const bool over =
        dot(cross(n, b - a), p - a) >= 0 && dot(cross(n, c - b), p - b) >= 0 && dot(cross(n, a - c), p - c) >= 0;
    if (over) return std::abs(dot(n, p - a));
    return std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
}

double depthOf(const Vec3& p, const Solid& solid) {
    if (!contains(solid.bounds, p) || !isInside(solid, p)) return 0;
    float least = INFINITY;
    for (const Triangle& t : solid.triangles)
        least = smaller(least, distanceTo(p, solid.vertices[t.a], solid.vertices[t.b], solid.vertices[t.c]));
    return static_cast<double>(least);
}

double deepest(const Solid& from, const Solid& in) {
    double most = 0;
    constexpr int kPieces = 4;
    for (const Triangle& t : from.triangles) {
        const std::uint32_t corner[3] = {t.a, t.b, t.c};
        for (std::size_t e = 0; e < 3; ++e) {
            const Vec3 &a = from.vertices[corner[e]], &b = from.vertices[corner[(e + 1) % 3]];
            for (int i = 0; i < kPieces; ++i)
                most = larger(most, depthOf(a + static_cast<float>(i) / kPieces * (b - a), in));
        }
    }
    return most;
}

}  // namespace

std::vector<double> overlapsOf(const Run& run, int first) {
    std::vector<std::vector<Solid>> bodies;
    for (std::size_t i = 0; i < run.scene().bodies.size(); ++i) {
        const Frame place = relative(Pose{}, run.motion(static_cast<int>(i)).pose);
        auto& solids = bodies.emplace_back();
        for (const ShapeDef& shape : run.scene().bodies[i].def.shapes)
            addSolids(shape.geometry, place * shape.frame, solids);
    }
    std::vector<double> depths;
    for (std::size_t i = static_cast<std::size_t>(first); i < bodies.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            double most = 0;
            for (const Solid& a : bodies[i])
                for (const Solid& b : bodies[j])
                    if (overlaps(a.bounds, b.bounds)) most = larger(most, larger(deepest(a, b), deepest(b, a)));
            if (most > 0) depths.push_back(most);
        }
    return depths;
}

}  // namespace ragtop::stability
