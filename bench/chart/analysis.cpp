#include "analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scenes.h"

namespace ragtop::chart {
namespace {

constexpr std::array kErrors{1e-1, 1e-2, 1e-3, 1e-4};
const std::string kRagtop = "ragtop";

double floorOf(const std::string& scene) {
    const auto at = std::ranges::find(allScenes(), scene, &ChartScene::name);
    return at == allScenes().end() ? 0 : at->floor;
}

double errorOf(const Point& point) { return std::max(point.error, floorOf(point.scene)); }

/// Production is what Ragtop is by default; its other solvers are there to be looked at.
bool counts(const Point& point) {
    return point.outcome == Outcome::measured && point.alone && (point.engine != kRagtop || point.variant == kRagtop);
}

template <class Key>
std::vector<std::string> namesOf(const Points& points, Key key) {
    std::vector<std::string> names;
    for (const Point& point : points)
        if (point.outcome != Outcome::unsupported && std::ranges::find(names, point.*key) == names.end())
            names.push_back(point.*key);
    return names;
}

std::vector<const Point*> frontOf(const Points& points, const std::string& scene, const std::string& engine) {
    std::vector<const Point*> all, front;
    for (const Point& point : points)
        if (point.scene == scene && point.engine == engine && counts(point)) all.push_back(&point);
    std::ranges::sort(all, [](const Point* a, const Point* b) {
        return a->cpuMs != b->cpuMs ? a->cpuMs < b->cpuMs : errorOf(*a) < errorOf(*b);
    });
    for (const Point* point : all)
        if (front.empty() || errorOf(*point) < errorOf(*front.back())) front.push_back(point);
    return front;
}

/// Fronts get more accurate as they get slower.
const Point* cheapest(const std::vector<const Point*>& front, double error) {
    const auto at = std::ranges::find_if(front, [error](const Point* point) { return errorOf(*point) <= error; });
    return at == front.end() ? nullptr : *at;
}

Loss worstOf(const Front& own, const Front& peer, double largest) {
    Loss worst{peer.scene, peer.engine};
    for (const Point* point : peer.points) {
        if (errorOf(*point) > largest) continue;
        const Point* reached = cheapest(own.points, errorOf(*point));
        const double ratio = reached ? reached->cpuMs / point->cpuMs : std::numeric_limits<double>::infinity();
        if (ratio <= worst.ratio) continue;
        worst.ratio = ratio;
        worst.error = errorOf(*point);
        worst.peerMs = point->cpuMs;
        worst.ragtopMs = reached ? reached->cpuMs : kNone;
    }
    return worst;
}

/// Has the engine failed in all that it was asked of the scene? One that was never timed has not.
bool failsAlways(const Points& points, const std::string& scene, const std::string& engine) {
    bool took = false;
    for (const Point& point : points) {
        if (point.scene != scene || point.engine != engine || point.outcome == Outcome::unsupported) continue;
        if (point.outcome == Outcome::measured) return false;
        took = true;
    }
    return took;
}

/// Of each scene each other engine that has a front, or could have none.
std::vector<Loss> comparisons(const Points& points, double largest) {
    std::vector<Loss> result;
    const std::vector<Front> fronts = frontsOf(points);
    for (const Front& own : fronts) {
        if (own.engine != kRagtop || own.points.empty()) continue;
        for (const Front& peer : fronts)
            if (peer.scene == own.scene && peer.engine != kRagtop &&
                (!peer.points.empty() || failsAlways(points, peer.scene, peer.engine)))
                result.push_back(worstOf(own, peer, largest));
    }
    return result;
}

}  // namespace

std::vector<Front> frontsOf(const Points& points) {
    std::vector<Front> fronts;
    for (const std::string& scene : namesOf(points, &Point::scene))
        for (const std::string& engine : namesOf(points, &Point::engine))
            fronts.push_back({scene, engine, frontOf(points, scene, engine)});
    return fronts;
}

CheapestTable cheapestOf(const Points& points) {
    CheapestTable table;
    table.engines = namesOf(points, &Point::engine);
    for (const std::string& scene : namesOf(points, &Point::scene)) {
        std::vector<std::vector<const Point*>> fronts;
        for (const std::string& engine : table.engines) fronts.push_back(frontOf(points, scene, engine));
        for (const double error : kErrors) {
            Cheapest row{scene, error, {}};
            for (const auto& front : fronts) row.perEngine.push_back(cheapest(front, error));
            if (std::ranges::any_of(row.perEngine, [](const Point* point) { return point != nullptr; }))
                table.rows.push_back(std::move(row));
        }
    }
    return table;
}

std::vector<Loss> lossesOf(const Points& points) {
    std::vector<Loss> losses = comparisons(points, kLargestError);
    std::erase_if(losses, [](const Loss& loss) { return loss.ratio <= 1; });
    std::ranges::sort(losses, [](const Loss& a, const Loss& b) {
        if (a.ratio != b.ratio) return a.ratio > b.ratio;
        return a.scene != b.scene ? a.scene < b.scene : a.engine < b.engine;
    });
    return losses;
}

std::vector<Dominance> dominancesOf(const Points& points) {
    std::vector<Dominance> result;
    const std::vector<Loss> counted = comparisons(points, kLargestError);
    const std::vector<Loss> all = comparisons(points, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < counted.size(); ++i) {
        const Loss& each = counted[i];
        auto at = std::ranges::find(result, each.engine, &Dominance::engine);
        if (at == result.end()) at = result.insert(at, {each.engine});
        ++at->scenes;
        if (each.ratio <= 1) ++at->dominated;
        if (each.ratio <= 1.5) ++at->nearly;
        if (all[i].ratio <= 1) ++at->dominatedOverall;
    }
    return result;
}

std::vector<Profile> profilesOf(const CheapestTable& table) {
    std::vector<Profile> profiles;
    for (std::size_t e = 0; e < table.engines.size(); ++e) {
        std::vector<double> ratios;
        for (const Cheapest& row : table.rows) {
            double fastest = std::numeric_limits<double>::infinity();
            for (const Point* point : row.perEngine)
                if (point && point->cpuMs < fastest) fastest = point->cpuMs;
            if (row.perEngine[e]) ratios.push_back(row.perEngine[e]->cpuMs / fastest);
        }
        std::ranges::sort(ratios);
        Profile profile{table.engines[e], {}};
        for (std::size_t i = 0; i < ratios.size(); ++i)
            profile.steps.push_back({ratios[i], static_cast<double>(i + 1) / static_cast<double>(table.rows.size())});
        profiles.push_back(std::move(profile));
    }
    return profiles;
}

}  // namespace ragtop::chart
