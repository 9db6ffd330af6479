#pragma once

#include <string>
#include <vector>

#include "point.h"

/// What the points of a chart say when they are compared. Only points that were measured, on a processor of their own,
/// count; errors below the scene's floor are equal.
namespace ragtop::chart {

/// Of one engine in one scene, from the cheapest to the most accurate; no point is both slower and worse than another.
struct Front {
    std::string scene, engine;
    std::vector<const Point*> points;
};
/// For each scene each engine, with all its variants; "ragtop" is its default variant alone, as games run it.
std::vector<Front> frontsOf(const Points& points);

/// What an engine needs to err by no more than `error`; null where it never does.
struct Cheapest {
    std::string scene;
    double error = 0;
    std::vector<const Point*> perEngine;  ///< in the order of `engines`
};
struct CheapestTable {
    std::vector<std::string> engines;
    std::vector<Cheapest> rows;
};
/// At errors of 10 %, 1 %, 0.1 % and 0.01 % of what the scene's errors are shares of, where any engine gets there.
CheapestTable cheapestOf(const Points& points);

/// Answers that are a tenth off and more are none that engines are chosen for: fronts are compared below.
inline constexpr double kLargestError = 0.1;

/// Where Ragtop takes longer than another engine to err as little, or never errs as little.
struct Loss {
    std::string scene, engine;
    double error = 0;     ///< at which the ratio is largest
    double peerMs = 0;    ///< of the other engine, per simulated second
    double ragtopMs = 0;  ///< NaN: Ragtop does not get there
    double ratio = 0;     ///< infinite: the same
};
/// The worst first. The other engine's point is compared with the cheapest of Ragtop's that errs no more.
std::vector<Loss> lossesOf(const Points& points);

/// Share of the scenes that both took part in where Ragtop's front dominates the engine's: it has for each of its
/// points one that errs no more and costs no more. An engine that fails with every setting is dominated.
struct Dominance {
    std::string engine;
    int scenes = 0, dominated = 0;
    int nearly = 0;            ///< where Ragtop takes at most 1.5 times as long at the same error
    int dominatedOverall = 0;  ///< at errors beyond kLargestError too
};
std::vector<Dominance> dominancesOf(const Points& points);

/// Share of problems (a scene and an error) that an engine solves within `ratio` times what the fastest takes
/// [Dolan, Moré, Benchmarking Optimization Software with Performance Profiles, 2002].
struct Profile {
    std::string engine;
    struct Step {
        double ratio = 1, share = 0;
    };
    std::vector<Step> steps;
};
std::vector<Profile> profilesOf(const CheapestTable& table);

}  // namespace ragtop::chart
