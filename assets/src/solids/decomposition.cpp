#include "ragtop/decomposition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "solids/air.h"
#include "solids/collapse.h"
#include "solids/few_corners.h"
#include "solids/pieces.h"

namespace ragtop {
namespace {

constexpr double kSimplerError = 0.25;  // of the error allowed, by which the solid of the search is off
constexpr double kAim = 0.9;            // of the error allowed, of a simpler solid: the rest is for what it lacks

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
    constexpr float kLeast = 1e-30f, kMost = 1e30f;  // so that neither it nor what is made of it leaves its type
    float volume = 0;
    try {
        volume = massOf(mesh, 1).mass;
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(std::string("decompose: ") + error.what());
    }
    if (!(volume >= kLeast && volume <= kMost))
        throw std::invalid_argument(
            fmt::format("decompose: shape has a volume of {:g} m³, must be in [{:g}, {:g}] m³", volume, kLeast, kMost));
    return volume;
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

struct Found {
    std::vector<Piece> pieces;
    double excess = kUnbounded;
};

/// The first that keep to the limits when they are joined, or else those that come closest.
Found searchIn(CutOrder order, const CutSolid& solid, double volume, const PieceLimits& limits, const Air& air,
               const TaskRunner& tasks) {
    Found best;
    cutToPieces(solid, order, limits, air, tasks, [&](std::vector<Piece> stage) {
        std::vector<Piece> joined = joinPieces(std::move(stage), volume, limits, air, tasks);
        for (Piece& piece : joined) piece.hull = withFewCorners(piece.hull, limits.corners);
        const double beyond = excess(joined, volume, limits, air);
        const bool isBetter = best.pieces.empty() || beyond < best.excess;
        if (isBetter) best = {std::move(joined), beyond};
        return best.excess <= 1 || !isBetter;
    });
    if (best.excess <= 1) return best;
    evenOut(best.pieces, volume, limits, air, tasks);
    best.excess = excess(best.pieces, volume, limits, air);
    return best;
}

std::vector<PointHull> bestPieces(const CutSolid& solid, double volume, const PieceLimits& limits, const Air& air,
                                  const TaskRunner& tasks) {
    Found best = searchIn(CutOrder::leastAir, solid, volume, limits, air, tasks);
    if (best.excess > 1 && !pairPlanes(solid, concaveEdges(solid)).empty()) {
        Found other = searchIn(CutOrder::whatStandsOut, solid, volume, limits, air, tasks);
        if (other.excess < best.excess) best = std::move(other);
    }
    std::vector<PointHull> hulls;
    for (Piece& piece : best.pieces) hulls.push_back(std::move(piece.hull));
    return hulls;
}

/// Adds each of the points that is in no hull to the nearest one. Where one point is, the next is as a rule.
void hold(std::vector<PointHull>& hulls, const std::vector<DVec3>& points) {
    std::vector<std::vector<DVec3>> lacking(hulls.size());
    std::size_t nearest = 0;
    for (const DVec3& p : points) {
        double least = hulls.empty() ? kUnbounded : heightOver(hulls[nearest], p);
        for (std::size_t i = 0; i < hulls.size() && least > 0; ++i)
            if (const double over = heightOver(hulls[i], p, least); over < least) least = over, nearest = i;
        if (least > 0) lacking[nearest].push_back(p);
    }
    for (std::size_t i = 0; i < hulls.size(); ++i)
        if (!lacking[i].empty()) hulls[i] = holding(std::move(hulls[i]), std::move(lacking[i]));
}

/// Leaves out corners, down to half as many as allowed, where error and volume permit it: for what collides they cost
/// time.
void lighten(std::vector<PointHull>& hulls, double mostVolume, const PieceLimits& limits, const Air& air) {
    double volume = 0;
    for (PointHull& hull : hulls) {
        hull = withFewCorners(hull, limits.corners);
        volume += hull.volume;
    }
    for (PointHull& hull : hulls) {
        if (air.depthIn(hull, limits.error) > limits.error) continue;  // fewer corners reach farther out
        PointHull light = withFewCorners(hull, limits.corners / 2);
        const double after = volume + light.volume - hull.volume;
        if (!(light.volume > 0) || after > mostVolume || air.depthIn(light, limits.error) > limits.error) continue;
        volume = after, hull = std::move(light);
    }
}

/// The same solid of few triangles, to a part of the error; itself where it has few, or nothing much simpler is
/// closed.
CutSolid simpler(const WeldedSurface& surface, const Units& units, float maxError) {
    constexpr std::size_t kFew = 600;
    constexpr double kMuch = 0.8;  // what has little less is not worth its error
    CutSolid solid = solidOf(surface, units);
    if (surface.triangles.size() <= kFew) return solid;
    const WeldedSurface few = collapsed(surface, kFew, static_cast<float>(kSimplerError) * maxError);
    CutSolid less = solidOf(few, units);
    if (static_cast<double>(few.triangles.size()) > kMuch * static_cast<double>(surface.triangles.size())) return solid;
    const double volume = volumeOf(solid), kept = volumeOf(less);
    return kept > 0.5 * volume && kept < 1.5 * volume ? less : solid;
}

/// The error that so many pieces may do with, where they cannot keep to a smaller one.
double reachableError(const Air& air, double error, std::size_t pieces) {
    constexpr double kFactor = 1.25;
    while (error < 1 && air.fewestPieces(error, pieces) > pieces) error *= kFactor;
    return error;
}

}  // namespace

Decomposition decompose(const TriangleMesh& mesh, const DecompositionOptions& options, const TaskRunner& tasks) {
    if (const std::string why = whyInvalid(options); !why.empty()) throw std::invalid_argument("decompose: " + why);
    Decomposition result;
    result.solidVolume = volumeOf(mesh);
    const Units units(mesh.vertices());
    const WeldedSurface surface = welded(mesh.vertices(), mesh.triangles());
    const CutSolid whole = solidOf(surface, units), solid = simpler(surface, units, options.maxError);
    const double volume = volumeOf(solid), wholeVolume = volumeOf(whole);
    const bool isSimpler = solid.triangles.size() < whole.triangles.size();
    constexpr double kShare = 0.9;  // of the air allowed: the rest is for leaving out corners
    const double allowed = kShare * (static_cast<double>(options.maxVolume) - 1) * wholeVolume;
    PieceLimits limits{static_cast<std::size_t>(options.maxPieces), units.scale * static_cast<double>(options.maxError),
                       allowed + wholeVolume - volume, static_cast<std::size_t>(options.maxVertices)};
    std::vector<PointHull> hulls;
    const Air airOfWhole(whole);
    {
        PieceLimits aim = limits;
        const std::optional<Air> airOfSimpler = isSimpler ? std::optional<Air>(solid) : std::nullopt;
        const Air& air = isSimpler ? *airOfSimpler : airOfWhole;
        // Both ends of a segment, and what is around it, are a part of the error elsewhere than on the simpler solid.
        const double error = (isSimpler ? 1 + 2 * kSimplerError : 1) * limits.error;
        const std::size_t fewest = air.fewestPieces(error, limits.pieces);
        result.fewestPieces = static_cast<int>(fewest);
        if (fewest > limits.pieces) aim.error = reachableError(air, error, limits.pieces);
        if (isSimpler) aim.error *= kAim;
        hulls = bestPieces(solid, volume, aim, air, tasks);
    }
    hold(hulls, whole.vertices);
    limits.air = allowed;
    lighten(hulls, wholeVolume + allowed, limits, airOfWhole);
    double deepest = 0;
    for (const PointHull& hull : hulls) {
        std::vector<Vec3> points;
        for (const DVec3& p : hull.points) points.push_back(units.out(p));
        result.pieces.emplace_back(points);
        result.volume += massOf(result.pieces.back(), 1).mass;
        deepest = std::max(deepest, airOfWhole.depthIn(hull, kUnbounded));
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
