#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "constraints/joint_sim.h"
#include "direct/contact_cone.h"
#include "direct/factor.h"
#include "direct/linear.h"

/// The equations of one island and substep, and where their parts are stored. Unknown are the velocities v of its
/// bodies [Castro et al., 2022]:
///   minimise  ½ |v − v_free|²_M + Σ φ(J v),
///   λ = −∂φ/∂u = P_K(λ̂ − (u − û)/R),              u = J v: speeds of contact points and joint rows
///   H = M + Jᵀ W J + h γ Σ λ K_g,                  the matrix of Newton's method, W = ∂λ/∂u
/// A row of a joint has u = l · (vB + ωB × rB − vA − ωA × rA) + t · (ωB − ωA).
///
///   M, v_free   masses; velocities that the bodies would have without constraints
///   û           speed that a row asks for: errors decay at the rate of the soft row, gaps may be used up
///   λ̂           load of the substep before
///   R           resistance, a small share of the row's inverse mass (tuning::kContactResistance, kRowResistance)
///   K           what λ may be: Coulomb's cone of a contact point (contact_cone.h), or the bounds of a row
///   P_K         projection onto K
///   K_g         stiffness of what is taut, against turns of its arms
///
/// This is the method of multipliers with one round per substep: a load that is right already is kept whatever R is,
/// so R need only be small enough for a quick answer to new loads. H has blocks of 6 × 6 and is factored sparsely
/// (factor.h).
namespace ragtop::direct {

inline constexpr std::int32_t kFixed = -1;  ///< a body that no impulse moves

/// Numbers of the method.
namespace tuning {
inline constexpr double kContactResistance = 1e-4;  ///< R of a contact point, over its inverse mass
/// The same where joints pull: loads change with every turn of a light link, and Newton's method follows them along
/// fewer kinks. Of 48 ropes over drums 20 hold with kContactResistance, 33 with 16 times, 37 with 64 times, 34 with
/// 256.
inline constexpr double kJointedResistance = 6.4e-3;
inline constexpr double kContactGap = 1e-4;     ///< gap up to which points count as touching, in sizes
inline constexpr double kResidual = 1e-8;       ///< of a solved system, in units of its impulses
inline constexpr double kRoundedGap = 1e-5;     ///< gap or overlap that is rounding, in sizes
inline constexpr double kRoundedArm = 1e-6;     ///< the same in arms: a few units in the last place of a float
inline constexpr double kSkip = 1e-6;           ///< speed of a joint's row that is left alone, in g h
inline constexpr double kAtRest = 2e-5;         ///< the same of a contact point, and of a body at rest
inline constexpr double kNothing = 1e-12;       ///< speed of a body that is none, in g h; floats have no room for it
inline constexpr double kLoadRounding = 5e-7;   ///< of loads between steps, in units of the load
inline constexpr double kSideRounding = 1e-12;  ///< of the terms that the load of a row sums up
}  // namespace tuning

/// A body of the island. Locked movements have mass 1 and no Jacobian.
struct SystemBody {
    std::uint32_t state = 0;
    std::uint32_t locks = 0;  ///< bits of movements that rows of joints do not know: along and about x, y, z
    double mass[3] = {1, 1, 1};
    double inverseMass[3] = {0, 0, 0};
    DSym3 inertia, inverseInertia;  ///< without what taut rows add
    DSym3 stiffness;                ///< h γ Σ λ K_g, kg m²
    DSym3 inverseTaut;              ///< of both together
};

/// A manifold: its points share a basis and two bodies.
struct SystemContact {
    std::int32_t a = kFixed, b = kFixed;
    std::uint32_t first = 0, count = 0, block = 0;
    float* lane = nullptr;
    DVec3 normal, tangent1, tangent2;
    DVec3 offset;  ///< m, centre of B from that of A at the beginning of the step
    DVec3 moved;   ///< m, its displacement from there that arms have followed
    double friction = 0, restitution = 0, size = 0, roundA = 0, roundB = 0;
    double follow = 0;   ///< as contact::kFollow
    double near = 0;     ///< gap up to which points count as touching, m
    double rounded = 0;  ///< gap or overlap that is rounding, m
    std::uint32_t stateA = 0, stateB = 0;
};

struct SystemPoint {
    DVec3 armA, armB;            ///< m, from the centres of mass
    double drift[3];             ///< m/s, by surfaces and by bodies that no impulse moves, in the basis
    double startGap = 0;         ///< m, when the step began
    double gap = 0;              ///< m
    double resistance = 0;       ///< m/s per N s
    double target = 0;           ///< û, m/s along the normal
    double slip = 0;             ///< |u_t| that lifts the normal row
    double load[3];              ///< λ̂, N s
    double impulse[3];           ///< λ
    double asked[3];             ///< y, of which λ is the projection
    double speed[3], change[3];  ///< u, and along the search direction
    ConeRegion region = ConeRegion::apart, factored = ConeRegion::apart;
};

/// y of a point at the speed u.
inline void unbounded(const SystemPoint& p, double friction, const double u[3], double y[3]) {
    y[0] = p.load[0] - (u[0] + friction * p.slip - p.target) / p.resistance;
    for (int k = 1; k < 3; ++k) y[k] = p.load[k] - u[k] / p.resistance;
}

/// Which impulse of its joint a row is; those of three rows have room for two more.
enum class RowKind : std::uint8_t {
    first = 0,
    second = 3,
    ballSpring = 6,
    ballViscous = 9,
    ballFriction = 12,
    axis = 15,  ///< in the order of AxisSlot
    swing = axis + kAxisSlots,
    twistLower = swing + SwingLimit::kSides,
    twistUpper,
    across,
    rigid,                                 ///< of an AxesBlock
    axes = rigid + AxesBlock::kMostRigid,  ///< its coordinates, each in the order of AxisSlot
    closingPoint = 255,                    ///< of no joint
};

/// What a row asks for in the pass after positions have moved.
struct RestingAim {
    double target = 0, resistance = 0, lower = 0, upper = 0;
    double follows = 0;      ///< of springs and dampers, as of SpringDrags
    double inverseMass = 0;  ///< of such a row
};

/// The drag of a row that is a force, with next to no say in the matrix, over its mass.
inline constexpr double kNoDrag = 1e-9;

/// Where the load of a row is between its bounds.
enum class Side : std::uint8_t { within, lower, upper };

/// Which rows change to the side that was asked of them.
enum class SideChange : std::uint8_t {
    leap,      ///< all
    step,      ///< all; those at a bound come within first: friction that is to turn round may find that it sticks
    farthest,  ///< of these the one that is wrong by most
    last,      ///< of these the last
};

/// What a row has of its directions: both, t alone, or l along an axis of the world alone.
enum class RowShape : std::uint8_t { whole, turning, alongX, alongY, alongZ };

/// Two bodies with rows between them: those of a joint, or of a contact point beside which joints are closed.
struct SystemPair {
    std::int32_t a = kFixed, b = kFixed;
    std::uint32_t block = 0;
    std::uint32_t first = 0, count = 0;  ///< rows
    DVec3 armA, armB;                    ///< m, from the centres of mass to where they push
};

/// A velocity, of a body or of B beside A, or an impulse: what is along l and about t.
struct Twist {
    DVec3 linear, turn;
};
/// Without the movements that locks take.
inline Twist unlocked(std::uint32_t locks, Twist of) {
    if (locks == 0) return of;
    if (locks & 1) of.linear.x = 0;
    if (locks & 2) of.linear.y = 0;
    if (locks & 4) of.linear.z = 0;
    if (locks & 8) of.turn.x = 0;
    if (locks & 16) of.turn.y = 0;
    if (locks & 32) of.turn.z = 0;
    return of;
}

/// A scalar row with bounds: a joint's.
struct SystemRow {
    RowKind kind = RowKind::first;
    bool compliant = false;   ///< its load is what it pushes with at no speed
    RowShape shape = RowShape::whole;
    std::uint32_t joint = 0;  ///< in the island
    DVec3 linear, turn;       ///< l and t
    double load = 0, impulse = 0, resistance = 0;
    double target = 0;  ///< û
    double lower = 0, upper = 0;
    RestingAim resting;
    double speed = 0, change = 0;
    Side side = Side::within, asked = Side::within;  ///< it has, and its speed asks for
    double wrong = 0;                                ///< J, by which these differ
    bool factored = true;                            ///< was within its bounds in the factor
};

/// J v of a row.
inline double alongRow(const SystemRow& row, const Twist& u) {
    switch (row.shape) {
        case RowShape::turning:
            return dot(row.turn, u.turn);
        case RowShape::alongX:
            return u.linear.x;
        case RowShape::alongY:
            return u.linear.y;
        case RowShape::alongZ:
            return u.linear.z;
        case RowShape::whole:
            break;
    }
    return dot(row.linear, u.linear) + dot(row.turn, u.turn);
}
/// sum ← sum + Jᵀ amount
inline void addAlong(const SystemRow& row, double amount, Twist& sum) {
    switch (row.shape) {
        case RowShape::turning:
            sum.turn = sum.turn + amount * row.turn;
            return;
        case RowShape::alongX:
            sum.linear.x += amount;
            return;
        case RowShape::alongY:
            sum.linear.y += amount;
            return;
        case RowShape::alongZ:
            sum.linear.z += amount;
            return;
        case RowShape::whole:
            break;
    }
    sum.linear = sum.linear + amount * row.linear;
    sum.turn = sum.turn + amount * row.turn;
}

/// |M (v − v_free) − Jᵀ λ| and |Jᵀ λ|, in the norm of M⁻¹.
struct Residual {
    double norm = 0, scale = 0;
};

/// What an island's system fills in and Newton's method solves: `solve` and `pivot` (newton.h) find the velocity.
class Equations {
public:
    explicit Equations(std::pmr::memory_resource* memory);

    std::size_t unknowns() const { return 6 * bodies.size(); }
    /// v ← v_free + M⁻¹ Jᵀ λ̂
    void velocityOfLoads(double* v) const;
    /// v_free ← v − M⁻¹ Jᵀ λ: from where impulses as they are lead to v.
    void freeBefore(const double* v);
    /// u, λ and regions at v, and the gradient M (v − v_free) − Jᵀ λ.
    Residual evaluate(const double* v, double* gradient);
    /// The same without the gradient.
    void loadsAt(const double* v);
    /// Each point as it is where its load answers, sliding as fast as its slip.
    void askForLoads();
    /// The same if each point answered with the slope that it has, and each row with its side, which are those of its
    /// load after takeSidesOfLoads.
    Residual evaluateSides(const double* v, double* gradient);
    /// The same where the speeds of the last evaluation are those at v.
    Residual evaluateSidesAgain(const double* v, double* gradient);
    void takeSidesOfLoads();
    /// Those of what rows ask of bodies that are at rest and bear no load.
    void takeSidesOfTargets();
    /// Finds which rows are to change their sides as v was evaluated, and returns how many.
    std::size_t askSides(const double* v);
    void changeSides(SideChange change);
    /// True when the loads answer what was evaluated but for speeds that may be left alone, or a share of those;
    /// keepLoads takes them.
    bool loadsHold(double share = 1);
    void keepLoads();
    void keepPointLoads();
    /// Stops bodies at speeds that rounding of loads explains. Loads that hold for years must not add it up.
    void stopRounding();
    /// Stops a body whose speed, and that of turning at its radius of gyration, is not above the one given.
    bool stopBelow(std::size_t body, double speed);
    /// Makes the impulses of the last evaluation the loads, a step of the method of multipliers; those of points alone.
    void takeLoads();
    void takePointLoads();
    /// Leaves out impulses of joints by which they pull against each other alone. Asks for a factor.
    void dropSelfStress();
    void scaleResistance(double scale);
    bool regionsChanged() const;
    /// Assembles and factorizes the Hessian at the last evaluation; false when it is not positive definite.
    bool factorize();
    /// Products of blocks that factorizing takes.
    std::size_t factorProducts() const { return hessian.products(); }
    void solve(double* x) { hessian.solve(x); }
    /// Prepares slopeAlong for a direction.
    void changeAlong(const double* direction);
    /// dℓ/dα at v + α d.
    double slopeAlong(const double* v, const double* direction, double alpha) const;
    /// The largest speed by which the slips of the last evaluation would change a row, m/s.
    double slipsChange();
    /// Moves the slips to those.
    void updateSlips();

    AlignedArray<SystemBody> bodies;
    AlignedArray<SystemContact> contacts;
    AlignedArray<SystemPoint> points;
    AlignedArray<SystemPair> pairs;
    AlignedArray<SystemRow> rows;         ///< pair after pair
    AlignedArray<double> velocity, free;  ///< v, v_free: six of each body
    double gravityStep = 0;               ///< speed that gravity gives per substep, m/s
    bool stopped = false;                 ///< no body moves
    bool loadsKept = false;               ///< loads of contacts are those that the step began with
    BlockFactor hessian;
    struct Scratch {
        AlignedArray<double> gradient, direction, trial;
    };
    Scratch scratch;

private:
    Twist motionOf(const SystemPair& pair, const double* v) const;
    /// Adds Jᵀ λ of a pair's rows.
    void push(const SystemPair& pair, const Twist& load, double* momentum) const;
    bool isBelow(std::size_t body, double speed) const;
    void speedsAt(const double* v);
    Residual gradientAt(const double* v, double* gradient) const;
    /// Of each body, m/s, in the scratch: what may be left alone.
    const double* roundingSpeeds();
    /// Shrinks loads of points that are far above all that they do to bodies: what is wedged between bodies that no
    /// impulse moves is pushed in vain, by more with every substep.
    void relieve();
    void applyImpulses(double* momentum, bool loads) const;
    void addMasses();
    void addContact(const SystemContact& contact);
    void addPair(const SystemPair& pair);
};

}  // namespace ragtop::direct
