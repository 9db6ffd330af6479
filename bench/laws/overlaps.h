#pragma once

#include <set>
#include <utility>
#include <vector>

#include "../stability/engine.h"
#include "convex_depth.h"

namespace ragtop::laws {

/// How deep bodies of a scene are in each other that were apart when it began. Pairs that do not collide, by their
/// joint, filter or types, do not count, nor do surfaces. Double precision, by other means than the simulation's own.
class Overlaps {
public:
    Overlaps(const Scene& scene, const stability::Engine& engine);
    /// m, of the deepest pair now.
    double deepest(const stability::Engine& engine);
    /// J, that overlaps give as they push bodies apart by what these press them with now.
    double held(const stability::Engine& engine);

private:
    struct Part {
        std::size_t body = 0, shape = 0;
        demos::ConvexSolid solid;
        demos::Box3 bounds;
    };
    void place(const stability::Engine& engine);
    bool mayMeet(const Part& a, const Part& b) const;
    /// Calls visit(a, b, depth) for the pairs of parts that overlap.
    template <class Visit>
    void forEachOverlap(Visit&& visit) const;

    const Scene& scene_;
    std::vector<Part> parts_;                                ///< by the lower x of their bounds
    std::set<std::pair<std::size_t, std::size_t>> ignored_;  ///< bodies, the smaller index first
};

}  // namespace ragtop::laws
