#include <algorithm>
#include <limits>
#include <tuple>

#include "solids/few_corners.h"
#include "solids/pieces.h"
#include "solids/run_tasks.h"

namespace ragtop {
namespace {

struct Pair {
    std::size_t a, b;
    double growth = 0;     ///< of the sum of volumes
    bool refused = false;  ///< exceeds the error
};

}  // namespace

bool areNear(const PointHull& a, const PointHull& b) {
    constexpr double kGap = 1e-4;
    const auto apart = [&](double DVec3::*axis) {
        const auto less = [&](const DVec3& p, const DVec3& q) { return p.*axis < q.*axis; };
        const auto [lowA, highA] = std::minmax_element(a.points.begin(), a.points.end(), less);
        const auto [lowB, highB] = std::minmax_element(b.points.begin(), b.points.end(), less);
        return (*lowA).*axis > (*highB).*axis + kGap || (*lowB).*axis > (*highA).*axis + kGap;
    };
    return !apart(&DVec3::x) && !apart(&DVec3::y) && !apart(&DVec3::z);
}

namespace {

std::vector<DVec3> pointsOfBoth(const PointHull& a, const PointHull& b) {
    std::vector<DVec3> points = a.points;
    points.insert(points.end(), b.points.begin(), b.points.end());
    return points;
}

class Joining {
public:
    Joining(std::vector<Piece> pieces, const PieceLimits& limits, const Air& air, const TaskRunner& tasks)
        : pieces_(std::move(pieces)), alive_(pieces_.size(), true), limits_(limits), air_(air), tasks_(tasks) {
        count_ = pieces_.size();
        for (const Piece& piece : pieces_) volume_ += piece.hull.volume;
        measure(pairsOfAll(), true);
    }

    std::vector<Piece> run(double solidVolume) {
        while (count_ > 1) {
            Pair* best = cheapest();
            if (!best && !many()) break;
            if (!best) {  // what is left lies apart
                measure(pairsOfAll(), false);
                best = cheapest();
                if (!best) break;
            }
            const bool spoils = volume_ + best->growth > solidVolume + limits_.air;
            if (!many() && !isEmpty(*best) && spoils) break;
            PointHull both = hullOf(pointsOfBoth(hull(best->a), hull(best->b)));
            // Fewer corners reach farther out, and take long to find.
            const auto isTooDeep = [&] { return air_.depthIn(both, limits_.error) > limits_.error; };
            const bool isTried = !best->refused && !isEmpty(*best);
            best->refused = best->refused || (isTried && isTooDeep());
            if (isTried && !best->refused && both.points.size() > limits_.corners) {
                both = withFewCorners(both, limits_.corners);
                best->refused = isTooDeep();
            }
            if (isTried && best->refused) continue;
            join(*best, withFewCorners(both, limits_.corners));
        }
        std::vector<Piece> rest;
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (alive_[i]) rest.push_back(std::move(pieces_[i]));
        return rest;
    }

private:
    const PointHull& hull(std::size_t i) const { return pieces_[i].hull; }
    bool many() const { return count_ > limits_.pieces; }
    /// Does one of the two have no volume, and so has to go with another?
    bool isEmpty(const Pair& pair) const { return !(hull(pair.a).volume > 0) || !(hull(pair.b).volume > 0); }

    Pair* cheapest() {
        Pair* best = nullptr;
        for (Pair& pair : pairs_) {
            if (pair.refused && !many()) continue;
            const auto key = [&](const Pair& p) { return std::tuple{!isEmpty(p), p.refused, p.growth, p.a, p.b}; };
            if (!best || key(pair) < key(*best)) best = &pair;
        }
        return best;
    }

    std::vector<Pair> pairsOfAll() const {
        std::vector<Pair> all;
        for (std::size_t b = 1; b < pieces_.size(); ++b)
            for (std::size_t a = 0; a < b; ++a)
                if (alive_[a] && alive_[b]) all.push_back({a, b});
        return all;
    }

    void measure(std::vector<Pair> fresh, bool nearOnly) {
        if (nearOnly) std::erase_if(fresh, [&](const Pair& pair) { return !areNear(hull(pair.a), hull(pair.b)); });
        runTasks(tasks_, fresh.size(), [&](std::size_t i) {
            Pair& pair = fresh[i];
            const double both = hullSize(pointsOfBoth(hull(pair.a), hull(pair.b))).volume;
            pair.growth = both - hull(pair.a).volume - hull(pair.b).volume;
        });
        for (Pair& pair : fresh) pairs_.push_back(std::move(pair));
    }

    void join(const Pair& pair, PointHull both) {
        const std::size_t a = pair.a, b = pair.b;
        volume_ += both.volume - hull(a).volume - hull(b).volume;
        pieces_[a].hull = std::move(both);
        for (CutSolid& solid : pieces_[b].solids) pieces_[a].solids.push_back(std::move(solid));
        alive_[b] = false;
        --count_;
        std::erase_if(pairs_, [&](const Pair& p) { return p.a == a || p.b == a || p.a == b || p.b == b; });
        std::vector<Pair> fresh;
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (alive_[i] && i != a) fresh.push_back({std::min(a, i), std::max(a, i)});
        measure(std::move(fresh), true);
    }

    std::vector<Piece> pieces_;
    std::vector<bool> alive_;
    std::vector<Pair> pairs_;
    const PieceLimits& limits_;
    const Air& air_;
    const TaskRunner& tasks_;
    std::size_t count_ = 0;
    double volume_ = 0;
};

}  // namespace

std::vector<Piece> joinPieces(std::vector<Piece> pieces, double solidVolume, const PieceLimits& limits, const Air& air,
                              const TaskRunner& tasks) {
    return Joining(std::move(pieces), limits, air, tasks).run(solidVolume);
}

}  // namespace ragtop
