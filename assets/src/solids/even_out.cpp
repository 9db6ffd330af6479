#include <algorithm>
#include <array>
#include <limits>

#include "solids/pieces.h"
#include "solids/run_tasks.h"

namespace ragtop {
namespace {

constexpr double kBetter = 0.99;                 // a step has to take away more than a hundredth of the depth
constexpr std::array kShares{0.05, 0.15, 0.35};  // of a piece along the step's direction, that may go

/// What two pieces would be if the part of one beyond a plane went to the other.
struct Step {
    std::size_t from, to;
    DPlane plane;  ///< the part above it goes
    PointHull rest, grown;
    double volume = 0;  ///< of both hulls
    double depth = std::numeric_limits<double>::infinity();
};

DVec3 middleOf(const std::vector<DVec3>& points) {
    DVec3 sum;
    for (const DVec3& p : points) sum = sum + p;
    return (1.0 / static_cast<double>(points.size())) * sum;
}

/// From one piece into another: through the cuts that they share, and towards its middle.
std::vector<DVec3> directions(const Piece& from, const Piece& to) {
    constexpr double kFacing = -0.9995, kSame = 1e-5;
    std::vector<DVec3> found;
    for (const CutSolid& a : from.solids)
        for (const CutSolid& b : to.solids)
            for (const Cap& cap : a.caps) {
                const auto meets = [&](const Cap& other) {
                    return dot(cap.plane.normal, other.plane.normal) < kFacing &&
                           std::abs(cap.plane.offset + other.plane.offset) < kSame;
                };
                if (std::any_of(b.caps.begin(), b.caps.end(), meets)) found.push_back(cap.plane.normal);
            }
    const DVec3 towards = middleOf(to.hull.points) - middleOf(from.hull.points);
    if (const double far = length(towards); far > 0) found.push_back((1 / far) * towards);
    return found;
}

class Evening {
public:
    Evening(std::vector<Piece>& pieces, double mostVolume, double error, const Air& air, const TaskRunner& tasks)
        : pieces_(pieces), mostVolume_(mostVolume), error_(error), air_(air), tasks_(tasks), stuck_(pieces.size()) {
        for (const Piece& piece : pieces) {
            depth_.push_back(depthOf(piece.hull));
            volume_ += piece.hull.volume;
        }
    }

    void run() {
        const std::size_t most = 2 * pieces_.size();
        for (std::size_t count = 0; count < most; ++count) {
            const std::size_t at = deepest();
            if (at == pieces_.size()) return;
            if (const Step best = bestStep(at); best.depth < kBetter * depth_[at])
                take(best);
            else
                stuck_[at] = true;
        }
    }

private:
    double depthOf(const PointHull& hull) const { return air_.depthIn(hull, std::numeric_limits<double>::infinity()); }

    std::size_t deepest() const {
        std::size_t found = pieces_.size();
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (!stuck_[i] && depth_[i] > error_ && (found == pieces_.size() || depth_[i] > depth_[found])) found = i;
        return found;
    }

    Step bestStep(std::size_t at) {
        std::vector<Step> steps;
        for (std::size_t to = 0; to < pieces_.size(); ++to)
            if (to != at && areNear(pieces_[at].hull, pieces_[to].hull)) addSteps(steps, at, to);
        runTasks(tasks_, steps.size(), [&](std::size_t i) { measure(steps[i]); });
        const auto best = std::min_element(steps.begin(), steps.end(),
                                           [](const Step& a, const Step& b) { return a.depth < b.depth; });
        return best == steps.end() ? Step{} : std::move(*best);
    }

    void addSteps(std::vector<Step>& steps, std::size_t from, std::size_t to) const {
        for (const DVec3& way : directions(pieces_[from], pieces_[to])) {
            double low = std::numeric_limits<double>::infinity(), high = -low;
            for (const DVec3& p : pieces_[from].hull.points)
                low = std::min(low, dot(way, p)), high = std::max(high, dot(way, p));
            for (const double share : kShares)
                steps.push_back({from, to, {way, snapped(from, way, high - share * (high - low))}, {}, {}});
        }
    }

    /// To the nearest corner: of what is round the corners are as far as it reaches.
    double snapped(std::size_t from, const DVec3& way, double offset) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (const CutSolid& solid : pieces_[from].solids)
            for (const DVec3& p : solid.vertices)
                if (const double h = dot(way, p); std::abs(h - offset) < std::abs(nearest - offset)) nearest = h;
        return nearest;
    }

    void measure(Step& step) const {
        std::vector<DVec3> rest, grown = pieces_[step.to].hull.points;
        for (const CutSolid& solid : pieces_[step.from].solids) {
            for (const auto& part : remainderBelow(solid, step.plane).corners)
                rest.insert(rest.end(), part.begin(), part.end());
            for (const auto& part : remainderBelow(solid, flipped(step.plane)).corners)
                grown.insert(grown.end(), part.begin(), part.end());
        }
        step.rest = hullOf(std::move(rest)), step.grown = hullOf(std::move(grown));
        step.volume = step.rest.volume + step.grown.volume;
        const double growth = step.volume - pieces_[step.from].hull.volume - pieces_[step.to].hull.volume;
        if (!(step.rest.volume > 0) || (growth > 0 && volume_ + growth > mostVolume_)) return;
        step.depth = depthOf(step.rest);
        const double bound = kBetter * depth_[step.from];
        if (step.depth < bound) step.depth = std::max(step.depth, air_.depthIn(step.grown, bound));
    }

    void take(const Step& step) {
        Piece &from = pieces_[step.from], &to = pieces_[step.to];
        volume_ += step.volume - from.hull.volume - to.hull.volume;
        std::vector<CutSolid> rest;
        for (const CutSolid& solid : from.solids) {
            if (CutSolid part = partBelow(solid, flipped(step.plane)); !part.vertices.empty())
                to.solids.push_back(std::move(part));
            if (CutSolid part = partBelow(solid, step.plane); !part.vertices.empty()) rest.push_back(std::move(part));
        }
        from = {std::move(rest), step.rest};
        to.hull = step.grown;
        depth_[step.from] = depthOf(from.hull), depth_[step.to] = depthOf(to.hull);
        std::fill(stuck_.begin(), stuck_.end(), false);
    }

    std::vector<Piece>& pieces_;
    double mostVolume_, error_;
    const Air& air_;
    const TaskRunner& tasks_;
    std::vector<bool> stuck_;
    std::vector<double> depth_;
    double volume_ = 0;
};

}  // namespace

void evenOut(std::vector<Piece>& pieces, double solidVolume, const PieceLimits& limits, const Air& air,
             const TaskRunner& tasks) {
    Evening(pieces, solidVolume + limits.air, limits.error, air, tasks).run();
}

}  // namespace ragtop
