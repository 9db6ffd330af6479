#include <algorithm>
#include <limits>
#include <tuple>

#include "solids/pieces.h"

namespace ragtop {
namespace {

struct Pair {
    std::size_t a, b;
    PointHull hull;
    double growth = 0;     ///< of the sum of volumes
    bool refused = false;  ///< exceeds the error
};

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

class Joining {
public:
    Joining(std::vector<PointHull> hulls, const PieceLimits& limits, const Air& air, const TaskRunner& tasks)
        : hulls_(std::move(hulls)), alive_(hulls_.size(), true), limits_(limits), air_(air), tasks_(tasks) {
        count_ = hulls_.size();
        for (const PointHull& hull : hulls_) volume_ += hull.volume;
        std::vector<Pair> fresh;
        for (std::size_t b = 1; b < hulls_.size(); ++b)
            for (std::size_t a = 0; a < b; ++a) fresh.push_back({a, b, {}});
        measure(std::move(fresh), true);
    }

    std::vector<PointHull> run(double solidVolume) {
        while (count_ > 1) {
            Pair* best = cheapest();
            if (!best && !many()) break;
            if (!best) {  // what is left lies apart
                measureApart();
                best = cheapest();
                if (!best) break;
            }
            const bool spoils = volume_ + best->growth > solidVolume + limits_.air;
            if (!many() && !isEmpty(*best) && spoils) break;
            if (!best->refused && !isEmpty(*best) && air_.depthIn(best->hull, limits_.error) > limits_.error) {
                best->refused = true;
                continue;
            }
            join(*best);
        }
        std::vector<PointHull> rest;
        for (std::size_t i = 0; i < hulls_.size(); ++i)
            if (alive_[i]) rest.push_back(std::move(hulls_[i]));
        return rest;
    }

private:
    bool many() const { return count_ > limits_.pieces; }
    /// Does one of the two have no volume, and so has to go with another?
    bool isEmpty(const Pair& pair) const { return !(hulls_[pair.a].volume > 0) || !(hulls_[pair.b].volume > 0); }

    Pair* cheapest() {
        Pair* best = nullptr;
        for (Pair& pair : pairs_) {
            if (pair.refused && !many()) continue;
            const auto key = [&](const Pair& p) { return std::tuple{!isEmpty(p), p.refused, p.growth, p.a, p.b}; };
            if (!best || key(pair) < key(*best)) best = &pair;
        }
        return best;
    }

    void measure(std::vector<Pair> fresh, bool nearOnly) {
        if (nearOnly) std::erase_if(fresh, [&](const Pair& pair) { return !areNear(hulls_[pair.a], hulls_[pair.b]); });
        struct Context {
            const std::vector<PointHull>& hulls;
            std::vector<Pair>& pairs;
        } context{hulls_, fresh};
        const auto task = [](void* user, int index) {
            auto& [hulls, pairs] = *static_cast<Context*>(user);
            Pair& pair = pairs[static_cast<std::size_t>(index)];
            std::vector<DVec3> points = hulls[pair.a].points;
            points.insert(points.end(), hulls[pair.b].points.begin(), hulls[pair.b].points.end());
            pair.hull = hullOf(std::move(points));
            pair.growth = pair.hull.volume - hulls[pair.a].volume - hulls[pair.b].volume;
        };
        const int count = static_cast<int>(fresh.size());
        if (tasks_.run)
            tasks_.run(tasks_.user, count, task, &context);
        else
            for (int i = 0; i < count; ++i) task(&context, i);
        for (Pair& pair : fresh) pairs_.push_back(std::move(pair));
    }

    void measureApart() {
        std::vector<Pair> fresh;
        for (std::size_t b = 1; b < hulls_.size(); ++b)
            for (std::size_t a = 0; a < b; ++a)
                if (alive_[a] && alive_[b]) fresh.push_back({a, b, {}});
        measure(std::move(fresh), false);
    }

    void join(Pair& pair) {
        const std::size_t a = pair.a, b = pair.b;
        volume_ += pair.growth;
        hulls_[a] = std::move(pair.hull);
        alive_[b] = false;
        --count_;
        std::erase_if(pairs_, [&](const Pair& p) { return p.a == a || p.b == a || p.a == b || p.b == b; });
        std::vector<Pair> fresh;
        for (std::size_t i = 0; i < hulls_.size(); ++i)
            if (alive_[i] && i != a) fresh.push_back({std::min(a, i), std::max(a, i), {}});
        measure(std::move(fresh), true);
    }

    std::vector<PointHull> hulls_;
    std::vector<bool> alive_;
    std::vector<Pair> pairs_;
    const PieceLimits& limits_;
    const Air& air_;
    const TaskRunner& tasks_;
    std::size_t count_ = 0;
    double volume_ = 0;
};

}  // namespace

std::vector<PointHull> joinPieces(std::vector<PointHull> hulls, double solidVolume, const PieceLimits& limits,
                                  const Air& air, const TaskRunner& tasks) {
    return Joining(std::move(hulls), limits, air, tasks).run(solidVolume);
}

}  // namespace ragtop
