#include "ragtop/decomposition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "solids/air.h"
#include "solids/collapse.h"
#include "solids/few_corners.h"
#include "solids/pieces.h"

namespace ragtop {
namespace {

/// About the middle of its bounds, times the power of two that makes it about 1 large: pieces of scaled meshes are
/// scaled pieces.
struct Units {
    DVec3 middle;
    double scale = 1;

    explicit Units(std::span<const Vec3> vertices) {
        Vec3 lower = vertices[0], upper = vertices[0];
        for (const Vec3& p : vertices) lower = min(lower, p), upper = max(upper, p);
        middle = 0.5 * (DVec3(lower) + DVec3(upper));
        const DVec3 half = DVec3(upper) - middle;
        int exponent = 0;
        std::frexp(std::max({half.x, half.y, half.z}), &exponent);
        scale = std::ldexp(1.0, -exponent);
    }
    DVec3 in(const Vec3& p) const { return scale * (DVec3(p) - middle); }
    Vec3 out(const DVec3& p) const { return toVec3(middle + (1 / scale) * p); }
};

CutSolid solidOf(const WeldedSurface& surface, const Units& units) {
    CutSolid solid;
    for (const Vec3& p : surface.vertices) solid.vertices.push_back(units.in(p));
    solid.triangles = surface.triangles;
    return solid;
}

/// Keeps the first number out of its range.
struct RangeOf {
    std::string problem;

    void operator()(const Tunable& tunable, double value) {
        if (!problem.empty() || (value >= tunable.minimum && value <= tunable.maximum)) return;
        const std::string unit = tunable.unit.size() < 2 && tunable.unit != "m" ? "" : " " + std::string(tunable.unit);
        problem = fmt::format("{} is {:g}, must be in [{:g}, {:g}]{}", tunable.name, value, tunable.minimum,
                              tunable.maximum, unit);
    }
};

float volumeOf(const TriangleMesh& mesh) {
    try {
        return massOf(mesh, 1).mass;
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(std::string("decompose: ") + error.what());
    }
}

/// How far hulls are beyond the limits, 1 where they just keep to them.
double excess(const std::vector<Piece>& pieces, double volume, const PieceLimits& limits, const Air& air) {
    double sum = 0, deepest = 0;
    for (const Piece& piece : pieces) {
        sum += piece.hull.volume;
        deepest = std::max(deepest, air.depthIn(piece.hull, kUnbounded));
    }
    return std::max((sum - volume) / limits.air, deepest / limits.error);
}

/// The first that keep to the limits when they are joined, or else those that come closest.
std::vector<PointHull> bestPieces(const CutSolid& solid, double volume, const PieceLimits& limits, const Air& air,
                                  const TaskRunner& tasks) {
    std::vector<Piece> best;
    double least = kUnbounded;
    cutToPieces(solid, limits, air, tasks, [&](std::vector<Piece> stage) {
        std::vector<Piece> joined = joinPieces(std::move(stage), volume, limits, air, tasks);
        const double beyond = excess(joined, volume, limits, air);
        if (best.empty() || beyond < least) best = std::move(joined), least = beyond;
        return least <= 1;
    });
    if (least > 1) evenOut(best, volume, limits, air, tasks);
    std::vector<PointHull> hulls;
    for (Piece& piece : best) hulls.push_back(std::move(piece.hull));
    return hulls;
}

/// Adds each of the points that is in no hull to the nearest one.
void hold(std::vector<PointHull>& hulls, const std::vector<DVec3>& points) {
    std::vector<std::vector<DVec3>> lacking(hulls.size());
    for (const DVec3& p : points) {
        double least = kUnbounded;
        std::size_t nearest = 0;
        for (std::size_t i = 0; i < hulls.size() && least > 0; ++i)
            if (const double over = heightOver(hulls[i], p); over < least) least = over, nearest = i;
        if (least > 0) lacking[nearest].push_back(p);
    }
    for (std::size_t i = 0; i < hulls.size(); ++i)
        if (!lacking[i].empty()) hulls[i] = holding(std::move(hulls[i]), std::move(lacking[i]));
}

/// The same solid of few triangles, to a part of the error; itself where it has few, or nothing simpler is closed.
CutSolid simpler(const WeldedSurface& surface, const Units& units, float maxError) {
    constexpr std::size_t kFew = 600;
    constexpr float kShare = 0.25f;
    CutSolid solid = solidOf(surface, units);
    if (surface.triangles.size() <= kFew) return solid;
    CutSolid less = solidOf(collapsed(surface, kFew, kShare * maxError), units);
    const double volume = volumeOf(solid), kept = volumeOf(less);
    return kept > 0.5 * volume && kept < 1.5 * volume ? less : solid;
}

}  // namespace

Decomposition decompose(const TriangleMesh& mesh, const DecompositionOptions& options, const TaskRunner& tasks) {
    if (const std::string why = whyInvalid(options); !why.empty()) throw std::invalid_argument("decompose: " + why);
    Decomposition result;
    result.solidVolume = volumeOf(mesh);
    const Units units(mesh.vertices());
    const WeldedSurface surface = welded(mesh.vertices(), mesh.triangles());
    const CutSolid whole = solidOf(surface, units), solid = simpler(surface, units, options.maxError);
    const double volume = volumeOf(solid);
    const Air air(whole);
    const double wholeVolume = volumeOf(whole);
    constexpr double kShare = 0.9;  // of the air allowed: the rest is for leaving out corners
    const double allowed = kShare * (static_cast<double>(options.maxVolume) - 1) * wholeVolume;
    const PieceLimits limits{static_cast<std::size_t>(options.maxPieces),
                             units.scale * static_cast<double>(options.maxError), allowed + wholeVolume - volume,
                             static_cast<std::size_t>(options.maxVertices)};
    std::vector<PointHull> hulls = bestPieces(solid, volume, limits, air, tasks);
    hold(hulls, whole.vertices);
    double deepest = 0;
    for (const PointHull& hull : hulls) {
        const PointHull few = withFewCorners(hull, static_cast<std::size_t>(options.maxVertices));
        std::vector<Vec3> points;
        for (const DVec3& p : few.points) points.push_back(units.out(p));
        result.pieces.emplace_back(points);
        result.volume += massOf(result.pieces.back(), 1).mass;
        deepest = std::max(deepest, air.depthIn(few, kUnbounded));
    }
    result.error = static_cast<float>(deepest / units.scale);
    return result;
}

std::string whyInvalid(const DecompositionOptions& options) {
    RangeOf range;
    describe(range, options, &options);
    return range.problem;
}

Compound compoundOf(const Decomposition& decomposition) {
    Compound compound;
    for (const ConvexHull& piece : decomposition.pieces) compound.parts.push_back({piece});
    return compound;
}

}  // namespace ragtop
