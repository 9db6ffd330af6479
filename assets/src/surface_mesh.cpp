#include "ragtop/surface_mesh.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace ragtop {
namespace {

constexpr int kAround = 16;    ///< points of a circle
constexpr int kHalfRings = 4;  ///< rings from the equator to a pole

SurfaceMesh unitBox() {
    SurfaceMesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    }
    mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    return mesh;
}

/// Two half spheres pulled apart along y; a ball where halfHeight is zero.
SurfaceMesh capsule(float radius, float halfHeight) {
    SurfaceMesh mesh;
    for (int half = 0; half < 2; ++half) {
        for (int ring = 0; ring <= kHalfRings; ++ring) {
            const double up = std::numbers::pi / 2 * (half == 0 ? ring - kHalfRings : ring) / kHalfRings;
            for (int i = 0; i < kAround; ++i) {
                const double around = 2 * std::numbers::pi * i / kAround;
                const Vec3 normal =
                    toVec3({std::cos(up) * std::cos(around), std::sin(up), std::cos(up) * std::sin(around)});
                mesh.normals.push_back(normal);
                mesh.vertices.push_back(radius * normal + Vec3{0, half == 0 ? -halfHeight : halfHeight, 0});
            }
        }
    }
    for (std::uint32_t ring = 0; ring + 1 < 2 * (kHalfRings + 1); ++ring) {
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const std::uint32_t a = ring * kAround + i, b = ring * kAround + (i + 1) % kAround;
            for (const std::uint32_t v : {a, a + kAround, b, b, a + kAround, b + kAround}) mesh.indices.push_back(v);
        }
    }
    return mesh;
}

SurfaceMesh heightField(const HeightField& field) {
    SurfaceMesh mesh;
    const int columns = field.columns(), rows = field.rows();
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const float height = field.heights()[static_cast<std::size_t>(j * columns + i)];
            mesh.vertices.push_back({static_cast<float>(i) * field.spacing(), std::isfinite(height) ? height : 0,
                                     static_cast<float>(j) * field.spacing()});
        }
    }
    const auto isHole = [&](int vertex) { return !std::isfinite(field.heights()[static_cast<std::size_t>(vertex)]); };
    for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i + 1 < columns; ++i) {
            const int a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
            for (const auto& t : {std::array{a, c, d}, std::array{a, d, b}}) {
                if (isHole(t[0]) || isHole(t[1]) || isHole(t[2])) continue;
                for (const int v : t) mesh.indices.push_back(static_cast<std::uint32_t>(v));
            }
        }
    }
    return mesh;
}

/// The hull grows point by point: faces that see the point go, its edges to their horizon come.
class HullBuilder {
public:
    explicit HullBuilder(std::span<const Vec3> points) : points_(points) {}

    std::vector<std::uint32_t> triangles() {
        if (!start()) return {};
        for (std::uint32_t i = 0; i < points_.size(); ++i) add(i);
        std::vector<std::uint32_t> indices;
        for (const Face& face : faces_) indices.insert(indices.end(), face.begin(), face.end());
        return indices;
    }

private:
    using Face = std::array<std::uint32_t, 3>;

    DVec3 point(std::uint32_t i) const { return DVec3(points_[i]); }
    static DVec3 cross(const DVec3& a, const DVec3& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    static double dot(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    static double size(const DVec3& a) { return std::sqrt(dot(a, a)); }

    double height(const Face& f, std::uint32_t i) const {
        const DVec3 n = cross(point(f[1]) - point(f[0]), point(f[2]) - point(f[0]));
        const double l = size(n);
        return l > 0 ? dot(n, point(i) - point(f[0])) / l : 0;
    }

    template <class Measure>
    std::uint32_t farthest(Measure measure) const {
        std::uint32_t best = 0;
        for (std::uint32_t i = 1; i < points_.size(); ++i) {
            if (measure(i) > measure(best)) best = i;
        }
        return best;
    }

    bool start() {
        if (points_.size() < 4) return false;
        const std::uint32_t a = 0;
        const std::uint32_t b = farthest([&](std::uint32_t i) { return size(point(i) - point(a)); });
        const std::uint32_t c =
            farthest([&](std::uint32_t i) { return size(cross(point(b) - point(a), point(i) - point(a))); });
        const std::uint32_t d = farthest([&](std::uint32_t i) { return std::abs(height({a, b, c}, i)); });
        tolerance_ = 1e-6 * size(point(b) - point(a));
        if (std::abs(height({a, b, c}, d)) <= tolerance_) return false;
        const bool below = height({a, b, c}, d) < 0;
        const Face base = below ? Face{a, b, c} : Face{a, c, b};
        faces_ = {base, {base[1], base[0], d}, {base[2], base[1], d}, {base[0], base[2], d}};
        return true;
    }

    void add(std::uint32_t i) {
        std::vector<Face> kept;
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (const Face& f : faces_) {
            if (height(f, i) <= tolerance_) {
                kept.push_back(f);
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
        }
        for (const auto& [edge, count] : edges) {
            if (!edges.contains({edge.second, edge.first})) kept.push_back({edge.first, edge.second, i});
        }
        faces_ = std::move(kept);
    }

    std::span<const Vec3> points_;
    std::vector<Face> faces_;
    double tolerance_ = 0;
};

struct SurfaceOf {
    SurfaceMesh operator()(const Sphere&) const { return capsule(1, 0); }
    SurfaceMesh operator()(const Capsule& s) const { return capsule(s.radius, s.halfHeight); }
    SurfaceMesh operator()(const Box&) const { return unitBox(); }
    SurfaceMesh operator()(const ConvexHull& s) const {
        return {{s.vertices().begin(), s.vertices().end()}, {}, hullTriangles(s.vertices())};
    }
    SurfaceMesh operator()(const TriangleMesh& s) const {
        SurfaceMesh mesh{{s.vertices().begin(), s.vertices().end()}, {}, {}};
        for (const Triangle& t : s.triangles()) mesh.indices.insert(mesh.indices.end(), {t.a, t.b, t.c});
        return mesh;
    }
    SurfaceMesh operator()(const HeightField& s) const { return heightField(s); }
    SurfaceMesh operator()(const Compound&) const { return {}; }
};

}  // namespace

SurfaceMesh surfaceOf(const Shape& shape) { return std::visit(SurfaceOf{}, shape); }

Vec3 surfaceScale(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) return box->halfExtents;
    if (const auto* ball = std::get_if<Sphere>(&shape)) return {ball->radius, ball->radius, ball->radius};
    return {1, 1, 1};
}

std::vector<std::uint32_t> hullTriangles(std::span<const Vec3> points) { return HullBuilder(points).triangles(); }

}  // namespace ragtop
