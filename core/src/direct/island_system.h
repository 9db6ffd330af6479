#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>

#include "base/aligned_array.h"
#include "constraints/joint_sim.h"
#include "direct/closing_point.h"
#include "direct/contact_cone.h"
#include "direct/factor.h"
#include "direct/joint_tuning.h"
#include "direct/linear.h"
#include "solve/kernel_table.h"

/// The equations of one island and substep, and where their parts are stored. Unknown are the velocities v of its
/// bodies [Castro et al., 2022]:
///   minimise  ½ |v − v_free|²_M + Σ φ(J v),
///   λ = −∂φ/∂u = P_K(λ̂ − (u − û)/R),              u = J v: speeds of contact points and joint rows
///   H = M + Jᵀ W J + h γ Σ λ K_g,                  the matrix of Newton's method, W = ∂λ/∂u
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
inline constexpr double kContactGap = 1e-4;         ///< gap up to which points count as touching, in sizes
inline constexpr double kResidual = 1e-8;           ///< of a solved system, in units of its impulses
inline constexpr double kRoundedGap = 1e-5;         ///< gap or overlap that is rounding, in sizes
inline constexpr double kRoundedArm = 1e-6;         ///< the same in arms: a few units in the last place of a float
inline constexpr double kSkip = 1e-6;               ///< speed of a joint's row that is left alone, in g h
inline constexpr double kAtRest = 2e-5;             ///< the same of a contact point, and of a body at rest
inline constexpr double kNothing = 1e-12;       ///< speed of a body that is none, in g h; floats have no room for it
inline constexpr double kLoadRounding = 5e-7;   ///< of loads between steps, in units of the load
inline constexpr double kSideRounding = 1e-12;  ///< of the terms that the load of a row sums up
}  // namespace tuning

/// A body of the island. Locked movements have mass 1 and no Jacobian.
struct SystemBody {
    std::uint32_t state = 0;
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
    double friction = 0, restitution = 0, size = 0, roundA = 0, roundB = 0;
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
    closingPoint = 255,  ///< of no joint
};

/// What a row asks for in the pass after positions have moved.
struct RestingAim {
    double target = 0, resistance = 0, lower = 0, upper = 0;
};

/// What rows of joints ask for.
enum class RowAims : std::uint8_t {
    substep,  ///< velocities that bring errors of places back too
    closing,  ///< places alone: the way, in units of the substep, that closes the errors there are
    resting,  ///< that rigid rows do not open any more
};

/// Where the load of a row is between its bounds.
enum class Side : std::uint8_t { within, lower, upper };

/// Which rows change to the side that was asked of them.
enum class SideChange : std::uint8_t {
    leap,      ///< all
    step,      ///< all; those at a bound come within first: friction that is to turn round may find that it sticks
    farthest,  ///< of these the one that is wrong by most
    last,      ///< of these the last
};

/// A scalar row with bounds: a joint's.
struct SystemRow {
    RowKind kind = RowKind::first;
    bool compliant = false;   ///< its load is what it pushes with at no speed
    std::uint32_t joint = 0;  ///< in the island
    std::int32_t a = kFixed, b = kFixed;
    std::uint32_t block = 0;
    double ja[6], jb[6];
    double load = 0, impulse = 0, resistance = 0;
    double target = 0;  ///< û
    double lower = 0, upper = 0;
    RestingAim resting;
    double speed = 0, change = 0;
    Side side = Side::within, asked = Side::within;  ///< it has, and its speed asks for
    double wrong = 0;                                ///< J, by which these differ
    bool factored = true;                            ///< was within its bounds in the factor
};

/// |M (v − v_free) − Jᵀ λ| and |Jᵀ λ|, in the norm of M⁻¹.
struct Residual {
    double norm = 0, scale = 0;
};

/// What a system is made from: indices of states, lanes, joints.
struct IslandParts {
    const std::uint32_t* bodies = nullptr;
    std::size_t bodyCount = 0;
    float* const* lanes = nullptr;  ///< one per manifold
    std::size_t contactCount = 0;
    JointSim* const* joints = nullptr;
    std::size_t jointCount = 0;
    const ClosingPoint* points = nullptr;  ///< beside which joints are closed; their bodies alone count
    std::size_t pointCount = 0, pointRoom = 0;  ///< and how many there may be in steps to come
    int laneStride = 0;
    std::uint32_t* localOf = nullptr;  ///< scratch: index in the island of each state
};

class IslandSystem {
public:
    explicit IslandSystem(std::pmr::memory_resource* memory);

    /// Once per step: bodies, points and loads; rows of joints come with each substep.
    void begin(const IslandParts& parts, const BodyArrays& arrays, const SolverContext& context);
    /// True when nothing moved in the last step, from its first substep on. Where nothing has changed since, a step
    /// may begin with beginAgain: everything is as it was.
    bool restedThrough(int substeps) const { return stopped_ && restedSubsteps_ + 1 >= substeps; }
    void beginAgain() { restedSubsteps_ = 0; }
    /// Was it last begun for so many?
    bool isOf(std::size_t bodyCount, std::size_t contactCount, std::size_t jointCount) const {
        return bodyCount == bodies_.size() && contactCount == lanes_ && jointCount == joints_.size();
    }
    /// Was it begun again, and has nothing changed through that step either? Its lanes are then as they were, but for
    /// what so many substeps of it have borne.
    bool restsAgain(bool begunAgain) const { return begunAgain && rests_ && loadsKept_; }
    int restedSubsteps() const { return restedSubsteps_; }
    /// Else writes loads and impulses back to lanes and joints.
    void end();

    /// Once per substep: free velocities, Jacobians of joints, masses.
    void beginSubstep(const BodyArrays& arrays, const JointContext& joints);
    /// Asks for the ways that close the joints where they are now, on top of no motion, with weightOf(body) times its
    /// mass for each, on which contact points come no nearer than they have room for.
    template <class WeightOf>
    void aimAtClosing(const BodyArrays& arrays, const JointContext& joints, std::span<const ClosingPoint> points,
                      WeightOf&& weightOf) {
        refreshMasses(arrays);
        for (SystemBody& body : bodies_)
            if (const double weight = weightOf(body.state); weight != 1) makeHeavy(body, weight);
        buildRows(arrays, joints, false, RowAims::closing);
        addClosingPoints(points, RowAims::closing, joints.inverseH);
        for (std::size_t i = 0; i < unknowns(); ++i) free_[i] = velocity_[i] = 0;
    }
    /// Makes turns dearer than ways by a factor, and rows give way more by another: both shorten what leads too far.
    void dampClosing(double turns, double rows) {
        for (SystemBody& body : bodies_) {
            body.inertia = scaled(body.inertia, turns);
            body.inverseInertia = body.inverseTaut = scaled(body.inverseInertia, 1 / turns);
        }
        for (SystemRow& row : rows_) row.resistance *= rows;
        for (double& x : velocity_) x = 0;
    }
    /// What was found, as ways over h: the largest turn, rad, and that of each body.
    double largestTurn(double h) const;
    void visitWays(double h, auto&& visit) const {
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            visit(bodies_[i].state, h * load(velocity_.data() + 6 * i), h * load(velocity_.data() + 6 * i + 3));
    }
    /// Asks that rigid rows where they are now do not open, nor contact points without room come nearer, of the
    /// velocities that bodies have.
    void aimAtRest(const BodyArrays& arrays, const JointContext& joints, std::span<const ClosingPoint> points);
    /// Rows of taut joints anew, about the velocities that were found and written. False where that is not needed.
    bool aimAgain(const BodyArrays& arrays, const JointContext& joints);
    /// Targets of the pass that moves positions.
    void aimAtPositions(const BodyArrays& arrays, const SolverContext& context);
    /// Targets of the pass after it. False when they ask for nothing that the first has not given.
    bool aimAtVelocities(const BodyArrays& arrays, const SolverContext& context);
    /// Notes what was found as the loads that the next substep starts from. With a factor, loads of joints by which
    /// they pull against each other alone are left out.
    void updateLoads(bool factored);
    void writeVelocities(const BodyArrays& arrays);

    // For newton.cpp.
    std::size_t bodyCount() const { return bodies_.size(); }
    std::size_t unknowns() const { return 6 * bodies_.size(); }
    std::size_t rowCount() const { return rows_.size(); }
    std::size_t pointCount() const { return points_.size(); }
    double* velocity() { return velocity_.data(); }
    /// Speed that gravity gives per substep, m/s.
    double gravityStep() const { return gravityStep_; }
    /// v ← v_free + M⁻¹ Jᵀ λ̂
    void velocityOfLoads(double* v) const;
    /// u, λ and regions at v, and the gradient M (v − v_free) − Jᵀ λ.
    Residual evaluate(const double* v, double* gradient);
    /// Each point as it is where its load answers, sliding as fast as its slip.
    void askForLoads();
    /// The same if each point answered with the slope that it has, and each row with its side, which are those of its
    /// load after takeSidesOfLoads.
    Residual evaluateSides(const double* v, double* gradient);
    void takeSidesOfLoads();
    /// How many rows the last evaluation asks to change their sides.
    std::size_t wrongSides() const;
    void changeSides(SideChange change);
    /// True when the loads answer what was evaluated but for speeds that may be left alone, or a share of those;
    /// keepLoads takes them.
    bool loadsHold(double share = 1);
    void keepLoads();
    /// Stops bodies at speeds that rounding of loads explains. Loads that hold for years must not add it up.
    void stopRounding();
    /// True when all bodies stand still and this substep asks what the one before did: then so does its answer.
    bool rests() const { return rests_; }
    /// Makes the impulses of the last evaluation the loads: a step of the method of multipliers.
    void takeLoads();
    void scaleResistance(double factor);
    bool regionsChanged() const;
    /// Assembles and factorizes the Hessian at the last evaluation; false when it is not positive definite.
    bool factorize();
    /// Products of blocks that factorizing takes.
    std::size_t factorProducts() const { return factor_.products(); }
    void solve(double* x) { factor_.solve(x); }
    /// Prepares slopeAlong for a direction.
    void changeAlong(const double* direction);
    /// dℓ/dα at v + α d.
    double slopeAlong(const double* v, const double* direction, double alpha) const;
    /// The largest speed by which the slips of the last evaluation would change a row, m/s.
    double slipsChange();
    /// Moves the slips to those.
    void updateSlips();

    struct Scratch {
        AlignedArray<double> gradient, direction, trial;
    };
    Scratch& scratch() { return scratch_; }

private:
    /// For all that so many need, at once.
    void makeRoom(std::size_t bodyCount, std::size_t contactCount, std::size_t jointCount);
    void loadBodies(const IslandParts& parts, const BodyArrays& arrays);
    void loadContacts(const IslandParts& parts, const BodyArrays& arrays);
    void loadPattern();
    void buildRows(const BodyArrays& arrays, const JointContext& joints, bool begins, RowAims aims);
    /// Rows that push only, of bodies that begin knew.
    void addClosingPoints(std::span<const ClosingPoint> points, RowAims aims, double inverseH);
    void findBlock(SystemRow& row) const;
    /// Is the speed of a body, of turning at its radius of gyration too, not above the one given?
    bool isBelow(std::size_t body, double speed) const;
    /// Stops such a body.
    bool stopBelow(std::size_t body, double speed);
    void refreshMasses(const BodyArrays& arrays);
    static void makeHeavy(SystemBody& body, double factor);
    void updateGaps(const BodyArrays& arrays);
    void speedsAt(const double* v);
    Residual gradientAt(const double* v, double* gradient) const;
    /// Of each body, m/s, in the scratch: what may be left alone.
    const double* roundingSpeeds();
    void takePointLoads();
    void applyImpulses(double* momentum, bool loads) const;
    void dropSelfStress();
    void addMasses();
    void addContact(const SystemContact& contact);
    void addRow(SystemRow& row);
    float& field(const SystemContact& contact, int index) const {
        return contact.lane[static_cast<std::size_t>(index) * stride_];
    }
    float& pointField(const SystemContact& contact, std::uint32_t point, int index) const;

    std::size_t stride_ = 1;
    std::size_t lanes_ = 0;  ///< contacts that it was made from, those without points too
    double gravityStep_ = 0;
    bool stopped_ = false, rests_ = false;  ///< no body moves; and none will in this substep
    bool loadsKept_ = false;                ///< loads of contacts are those that the step began with
    bool loops_ = false;                    ///< joints may pull against each other
    int restedSubsteps_ = 0;                ///< of this step
    AlignedArray<SystemBody> bodies_;
    AlignedArray<std::uint32_t> states_;  ///< of the bodies
    AlignedArray<SystemContact> contacts_;
    AlignedArray<SystemPoint> points_;
    AlignedArray<SystemRow> rows_;
    AlignedArray<JointSim*> joints_;
    AlignedArray<BlockPair> pairs_;
    AlignedArray<std::int32_t> jointEnds_;  ///< two local bodies per joint
    AlignedArray<std::int32_t> pointEnds_;  ///< and per point beside which they are closed
    AlignedArray<double> velocity_, free_;
    // v and w of each body as its state has them. As floats: gcc 12 leaves out the rounding of double to float to
    // double where it vectorizes.
    AlignedArray<Vec3> written_;
    BlockFactor factor_;
    Scratch scratch_;
};

}  // namespace ragtop::direct
