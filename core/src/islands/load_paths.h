#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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

/// How the load of a body divides among the n near points of the contacts that bear it: as among springs that are alike
/// and do not pull. With x across gravity from the body's centre, x̄ the mean of the points, S = Σ (x − x̄)(x − x̄)ᵀ and
/// e where the line of its load goes, a point takes max(1/n + (x − x̄)ᵀ S⁺ (e − x̄), 0), and all together all.
struct LoadDivision {
    float each = 0, scale = 1;     ///< 1/n, 1 over the sum
    float meanX = 0, meanY = 0;    ///< m
    float slopeX = 0, slopeY = 0;  ///< 1/m
    float at(float x, float y) const {
        const float share = each + slopeX * (x - meanX) + slopeY * (y - meanY);
        return share > 0 ? scale * share : 0.0f;
    }
};

/// Which way weights go down to what does not move, and how much comes together: an estimate, for which each body hands
/// its weight, and what it bears, to its neighbours that are nearer to what does not move. Joints hand on moments as
/// well, so what has any divides its load evenly, and bears on the centres of others. All of it lies in memory of its
/// stage and holds until another stage takes some.
class LoadPaths {
public:
    /// Takes memory, and so many bytes more.
    void begin(const ConstTables& tables, StageMemory& memory, std::size_t more);
    /// Everything in the graph that bears or holds: contacts within reach, and joints; of
    /// some islands if there are lists of them, which then are all that is looked at.
    void collect(const ConstTables& tables, const IslandLists* some);
    /// After `collect`; kNone of bodies from which nothing leads to what does not move.
    void findDepths(const Bodies& bodies, std::span<const std::uint32_t> members);
    /// After `findDepths`, of the same bodies. Gravity in m/s²; `pushes`: forces count as weights.
    void estimate(const ConstTables& tables, const Vec3& gravity, bool pushes, std::span<const std::uint32_t> members);

    bool aBears(const SupportEdge& e) const { return e.movesB && (!e.movesA || depth[e.a] < depth[e.b]); }
    bool bBears(const SupportEdge& e) const { return e.movesA && (!e.movesB || depth[e.b] < depth[e.a]); }
    /// kg, that each point of a contact which bears takes, of the edge's share.
    std::array<float, kMaxManifoldPoints> sharesOfPoints(const ConstTables& tables, const SupportEdge& edge) const;

    StageArray<SupportEdge> edges;
    StageArray<float> share;             ///< kg, per edge that bears: what it hands down
    StageArray<std::uint32_t> depth;     ///< per body: edges to what does not move
    StageArray<std::uint8_t> heldLevel;  ///< per body: something level is below it

private:
    struct BodyAxes {
        Vec3 x, y;  ///< across gravity, of the body
    };

    bool isBorne(const SupportEdge& e, std::uint32_t body) const { return e.a == body ? bBears(e) : aBears(e); }
    std::span<const std::uint32_t> edgesOf(std::uint32_t body) const;
    BodyAxes axesOf(const Bodies& bodies, std::uint32_t body) const;
    void divide(const ConstTables& tables, std::uint32_t body, const BodyAxes& axes, float x, float y);
    void handDown(const ConstTables& tables, std::uint32_t body);

    StageArray<std::uint32_t> edgesEnd_, edgesOf_;  ///< per body that moves: its edges
    StageArray<std::uint32_t> visited_;             ///< bodies in the order of their depth
    StageArray<float> load_, momentX_, momentY_;    ///< kg, kg m, per body: what it bears, about its centre
    StageArray<LoadDivision> division_;             ///< per body: what it hands down
    Vec3 axisX_, axisY_;                            ///< across gravity, of the world
};

}  // namespace ragtop
