#include "ragtop/simplification.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "solids/collapse.h"
#include "solids/surface_tree.h"

namespace ragtop {
namespace {

std::vector<DVec3> placesOf(const WeldedSurface& surface) {
    std::vector<DVec3> places;
    for (const Vec3& p : surface.vertices) places.emplace_back(p);
    return places;
}

/// Farthest that one surface is from another, where it is looked at; or anything above `limit`.
double farthest(const WeldedSurface& from, const SurfaceTree& to, double limit) {
    const std::vector<DVec3> places = placesOf(from);
    double most = 0;
    const auto look = [&](const DVec3& p) { most = most > limit ? most : std::max(most, to.distance(p)); };
    for (const Triangle& t : from.triangles) {
        const DVec3 a = places[t.a], b = places[t.b], c = places[t.c];
        look(a);
        look(0.5 * (a + b));
        look((1.0 / 3) * (a + b + c));
    }
    return most;
}

bool isSolid(const WeldedSurface& surface) {
    try {
        massOf(TriangleMesh(surface.vertices, surface.triangles), 1);
        return true;
    } catch (const std::invalid_argument&) {
        return false;
    }
}

}  // namespace

SimplerSurface simplify(std::span<const Vec3> vertices, std::span<const Triangle> triangles, float maxError) {
    if (!(maxError >= 0 && maxError <= 1e5f))
        throw std::invalid_argument(fmt::format("simplify: maxError is {:g}, must be in [0, 1e5] m", maxError));
    const TriangleMesh checked(vertices, triangles);
    const WeldedSurface given = welded(vertices, triangles);
    const bool solid = isSolid(given);
    const SurfaceTree tree(placesOf(given), given.triangles);
    float asked = maxError;
    constexpr int kTries = 8;  // each with half of the error: down to a hundredth of what was asked for
    for (int i = 0; i < kTries; ++i, asked *= 0.5f) {
        const WeldedSurface less = collapsed(given, 0, asked);
        if (less.triangles.empty() || (solid && !isSolid(less))) continue;
        const double limit = static_cast<double>(maxError);
        double error = farthest(less, tree, limit);
        if (error <= limit) error = std::max(error, farthest(given, {placesOf(less), less.triangles}, limit));
        if (error <= limit) return {less.vertices, less.triangles, static_cast<float>(error)};
    }
    return {given.vertices, given.triangles, 0};
}

}  // namespace ragtop
