#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ragtop/math.h"

/// Limit analysis of rigid blocks: whether forces exist that keep all of them at rest and lie within Coulomb's cones,
/// by a linear program [Livesley, Limit analysis of structures formed from rigid blocks, 1978]. It knows nothing of how
/// any engine works.
namespace ragtop::stability {

/// A contact of two blocks at some points.
struct Joint {
    int a = 0, b = 0;           ///< blocks; kGround for what does not move
    std::vector<DVec3> points;  ///< m
    DVec3 normal;               ///< unit, from a to b
    DVec3 tangent;              ///< unit, a direction in which the sides of the cone are met exactly
    /// rad about the y axis: it is a copy of `a`, turned by so much, that touches b. Of a structure that repeats about
    /// the axis one copy of each block is enough, since the mean of all turned solutions is a solution.
    double turn = 0;
};

inline constexpr int kGround = -1;

class LimitAnalysis {
public:
    /// Friction cones are pyramids with so many edges inside the cone: exact along the tangents of the joints and their
    /// quarter turns, less by a factor of cos(π/edges) between edges.
    explicit LimitAnalysis(int edges = 8) : edges_(edges) {}

    /// A block with its weight (N, downwards) at its centre of mass; returns its number.
    int addBlock(double weight, const DVec3& center);
    /// Another force on a block.
    void addForce(int block, const DVec3& force, const DVec3& point);
    void addJoint(Joint joint);
    /// What holds a block against every motion but sliding along an axis, without friction.
    void addGuide(int block, const DVec3& axis);

    /// Whether such forces exist. Throws Unsupported when the program was built without GLPK.
    bool stands(double friction) const;

private:
    struct Block {
        DVec3 center, force, moment;
    };
    int edges_;
    std::vector<Block> blocks_;
    struct Guide {
        int block;
        DVec3 axis;
    };
    std::vector<Joint> joints_;
    std::vector<Guide> guides_;
};

/// The value between two where `holds` changes, to a share of `tolerance`; it must hold at `good` and not at `bad`.
/// NaN when either is not so.
double bisect(double good, double bad, double tolerance, const std::function<bool(double)>& holds);

}  // namespace ragtop::stability
