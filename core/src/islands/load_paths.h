#pragma once

#include <cstddef>
#include <cstdint>

#include "base/stage_memory.h"
#include "contacts/tables.h"

namespace ragtop {

/// Cosine of the steepest contact whose load is a weight, 20°: friction bears sin² 20° = 0.12 of one that lies on it, the
/// normal row the rest.
inline constexpr float kLevel = 0.94f;

/// A contact or joint through which bodies may bear on each other.
struct SupportEdge {
    std::uint32_t a, b;        ///< bodies
    std::uint32_t constraint;  ///< manifold or joint
    bool joint;
    bool movesA, movesB;  ///< do they move?
};

/// Which way weights go down to what does not move, and how much comes together: an estimate, for which each body hands
/// its weight, and what it bears, in equal shares to its neighbours that are nearer to what does not move. All of it
/// lies in memory of its stage and holds until another stage takes some.
class LoadPaths {
public:
    /// Takes memory, and so many bytes more.
    void begin(const ConstTables& tables, StageMemory& memory, std::size_t more);
    /// Everything in the graph that bears or holds: contacts within reach, and joints.
    void collect(const ConstTables& tables);
    /// After `collect`; kNone of bodies from which nothing leads to what does not move.
    void findDepths(const Bodies& bodies);
    /// After `findDepths`. Gravity in m/s²; `pushes`: forces count as weights.
    void estimate(const Bodies& bodies, float gravity, bool pushes);

    bool aBears(const SupportEdge& e) const { return e.movesB && (!e.movesA || depth[e.a] < depth[e.b]); }
    bool bBears(const SupportEdge& e) const { return e.movesA && (!e.movesB || depth[e.b] < depth[e.a]); }
    /// kg, that a body hands to each of those that bear it.
    float shareOf(const Bodies& bodies, std::uint32_t body) const {
        return (load[body] + bodies[body].mass) / static_cast<float>(supports[body]);
    }

    StageArray<SupportEdge> edges;
    StageArray<std::uint32_t> depth;     ///< per body: edges to what does not move
    StageArray<std::uint32_t> supports;  ///< per body: how many bear it
    StageArray<float> load;              ///< kg, per body: what it bears
    StageArray<std::uint8_t> heldLevel;  ///< per body: something level is below it

private:
    StageArray<std::uint32_t> neighbourBegin_, neighbours_;  ///< per body that moves: those it shares an edge with
    StageArray<std::uint32_t> visited_;                      ///< bodies in the order of their depth
};

}  // namespace ragtop
