#include "solids/cut_search.h"

#include <algorithm>

#include "ragtop/tunables.h"
#include "solids/few_corners.h"
#include "solids/run_tasks.h"

namespace ragtop {
namespace {

constexpr double kNoVolume = 1e-9;

/// The hulls of the parts together, beyond their volume; infinite where there is none.
double airOf(const Remainder& part, std::size_t most) {
    double hulls = 0, more = 0;
    for (const std::vector<DVec3>& corners : part.corners) {
        const HullSize size = hullSize(corners);
        hulls += size.volume, more += airOfFewCorners(size.volume, size.corners, most);
    }
    return hulls < kNoVolume ? kUnbounded : std::max(0.0, hulls - part.volume) + more;
}

/// Air in the hulls of what a cut leaves, weighed: of cuts that remove as much of it, those go on better that are even,
/// end in many corners, or are small.
double cost(const CutSolid& solid, const std::vector<ConcaveEdge>& concave, const DPlane& plane, std::size_t most) {
    constexpr double kUneven = 0.3, kConcave = 0.6, kArea = 0.2;
    const Remainder below = remainderBelow(solid, plane), above = remainderBelow(solid, flipped(plane));
    const double parts = static_cast<double>(below.corners.size() + above.corners.size()) / 2;
    const double low = airOf(below, most), high = airOf(above, most), air = low + high;
    if (air == kUnbounded) return kUnbounded;
    double left = 0, all = 0;
    for (const ConcaveEdge& edge : concave) {
        all += edge.weight;
        const double a = plane.height(solid.vertices[edge.a]), b = plane.height(solid.vertices[edge.b]);
        if (std::abs(a) > kOnPlane || std::abs(b) > kOnPlane) left += edge.weight;
    }
    const double uneven = air > 0 ? std::max(low, high) / air : 0;
    const double area = std::max(0.0, below.cutArea), size = air + below.volume + above.volume;
    // Air of what is round falls with the square of the number of pieces: more of them have to remove more.
    return parts * parts * air *
           (1 + kUneven * uneven + kConcave * (all > 0 ? left / all : 1) + kArea * area * std::sqrt(area) / size);
}

struct Costs {
    const CutSolid& solid;
    std::vector<ConcaveEdge> concave;
    std::vector<DPlane> planes;
    std::vector<double> costs;

    Costs(const CutSolid& s, std::size_t most, const TaskRunner& tasks)
        : solid(s), concave(concaveEdges(s)), planes(planesToTry(s, concave)), costs(planes.size(), kUnbounded) {
        runTasks(tasks, planes.size(),
                 [this, most](std::size_t i) { costs[i] = cost(solid, concave, planes[i], most); });
    }
    std::size_t best() const {
        return static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    }
};

/// Through the first pair of concave edges of which a plane cuts off what has no air: with a tooth as a rule corners of
/// those beside it, which are joined to them again.
std::optional<DPlane> cutOfWhatStandsOut(const CutSolid& solid, std::size_t most) {
    constexpr double kClean = 1e-3;  // of its volume
    for (const DPlane& plane : pairPlanes(solid, concaveEdges(solid)))
        for (const DPlane& side : {plane, flipped(plane)}) {
            const Remainder part = remainderBelow(solid, side);
            if (part.volume > kNoVolume && airOf(part, most) <= kClean * part.volume) return plane;
        }
    return {};
}

}  // namespace

std::optional<DPlane> bestCut(const CutSolid& solid, CutOrder order, std::size_t corners, const TaskRunner& tasks) {
    if (solid.vertices.empty()) return {};
    if (order == CutOrder::whatStandsOut)
        if (const std::optional<DPlane> plane = cutOfWhatStandsOut(solid, corners)) return plane;
    const Costs first(solid, corners, tasks);
    const std::size_t best = first.best();
    if (first.costs[best] == kUnbounded) return {};
    return first.planes[best];
}

}  // namespace ragtop
