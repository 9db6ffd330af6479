#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>

#include "base/aligned_array.h"
#include "constraints/joint_sim.h"
#include "direct/closing_point.h"
#include "direct/equations.h"
#include "direct/joint_tuning.h"
#include "solve/kernel_table.h"

namespace ragtop::direct {

/// What rows of joints ask for.
enum class RowAims : std::uint8_t {
    substep,  ///< velocities that bring errors of places back too
    closing,  ///< places alone: the way, in units of the substep, that closes the errors there are
    resting,  ///< that rigid rows do not open any more
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

/// Fills in the equations of one island from the world in each substep, and writes back what they gave.
class IslandSystem {
public:
    explicit IslandSystem(std::pmr::memory_resource* memory);

    /// Once per step: bodies, points and loads; rows of joints come with each substep.
    void begin(const IslandParts& parts, const BodyArrays& arrays, const SolverContext& context);
    /// True when nothing moved in the last step, from its first substep on. Where nothing has changed since, a step
    /// may begin with beginAgain: everything is as it was.
    bool restedThrough(int substeps) const { return equations_.stopped && restedSubsteps_ + 1 >= substeps; }
    void beginAgain() { restedSubsteps_ = 0; }
    /// Was it last begun for so many?
    bool isOf(std::size_t bodyCount, std::size_t contactCount, std::size_t jointCount) const {
        return bodyCount == equations_.bodies.size() && contactCount == lanes_ && jointCount == joints_.size();
    }
    /// Was it begun again, and has nothing changed through that step either? Its lanes are then as they were, but for
    /// what so many substeps of it have borne.
    bool restsAgain(bool begunAgain) const { return begunAgain && rests_ && equations_.loadsKept; }
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
        for (SystemBody& body : equations_.bodies)
            if (const double weight = weightOf(body.state); weight != 1) makeHeavy(body, weight);
        buildRows(arrays, joints, false, RowAims::closing);
        addClosingPoints(points, RowAims::closing, joints.inverseH);
        equations_.takeSidesOfTargets();
        for (std::size_t i = 0; i < equations_.unknowns(); ++i) equations_.free[i] = equations_.velocity[i] = 0;
    }
    /// Makes turns dearer than ways by a factor, and rows give way more by another: both shorten what leads too far.
    void dampClosing(double turns, double rows) {
        for (SystemBody& body : equations_.bodies) {
            body.inertia = scaled(body.inertia, turns);
            body.inverseInertia = body.inverseTaut = scaled(body.inverseInertia, 1 / turns);
        }
        for (SystemRow& row : equations_.rows) row.resistance *= rows;
        for (double& x : equations_.velocity) x = 0;
    }
    /// What was found, as ways over h: the largest turn, rad, and that of each body.
    double largestTurn(double h) const;
    void visitWays(double h, auto&& visit) const {
        for (std::size_t i = 0; i < equations_.bodies.size(); ++i)
            visit(equations_.bodies[i].state, h * load(equations_.velocity.data() + 6 * i),
                  h * load(equations_.velocity.data() + 6 * i + 3));
    }
    /// Asks that rigid rows where they are now do not open, nor contact points without room come nearer, of the
    /// velocities that bodies have.
    void aimAtRest(const BodyArrays& arrays, const JointContext& joints, std::span<const ClosingPoint> points);
    /// Rows of taut joints anew, about the velocities that were found and written. False where that is not needed.
    bool aimAgain(const BodyArrays& arrays, const JointContext& joints);
    /// Targets of the pass that moves positions.
    void aimAtPositions(const BodyArrays& arrays, const SolverContext& context);
    /// Targets of the pass after it. False when they ask for nothing that the first has not given.
    bool aimAtVelocities(const BodyArrays& arrays, const SolverContext& context, const JointContext& joints);
    /// Notes what was found as the loads that the next substep starts from. With a factor, loads of joints by which
    /// they pull against each other alone are left out.
    void updateLoads(bool factored);
    void writeVelocities(const BodyArrays& arrays);

    /// What newton.h solves.
    Equations& equations() { return equations_; }
    /// True when all bodies stand still and this substep asks what the one before did: then so does its answer.
    bool rests() const { return rests_; }

private:
    /// For all that so many need, at once.
    void makeRoom(std::size_t bodyCount, std::size_t contactCount, std::size_t jointCount);
    void loadBodies(const IslandParts& parts, const BodyArrays& arrays);
    void loadContacts(const IslandParts& parts, const BodyArrays& arrays);
    /// The points of a contact go on with its bodies.
    void moveArms(SystemContact& contact, const BodyArrays& arrays);
    /// What surfaces, turning, and bodies that no impulse moves do to the points of a contact; true if anything.
    bool setDrifts(const SystemContact& contact, const BodyArrays& arrays);
    void loadPattern();
    void buildRows(const BodyArrays& arrays, const JointContext& joints, bool begins, RowAims aims);
    /// Rows that push only, of bodies that begin knew.
    void addClosingPoints(std::span<const ClosingPoint> points, RowAims aims, double inverseH);
    /// Rigid rows where the bodies have moved to: what springs then change acts there, so that it has no moment about
    /// the point where it should, and what rigid rows give to it is along what the next substep starts from.
    void moveRows(const BodyArrays& arrays, const JointContext& joints);
    void findBlock(SystemPair& pair) const;
    void refreshMasses(const BodyArrays& arrays);
    static void makeHeavy(SystemBody& body, double factor);
    void updateGaps(const BodyArrays& arrays);
    float& field(const SystemContact& contact, int index) const {
        return contact.lane[static_cast<std::size_t>(index) * stride_];
    }
    float& pointField(const SystemContact& contact, std::uint32_t point, int index) const;

    std::size_t stride_ = 1;
    std::size_t lanes_ = 0;     ///< contacts that it was made from, those without points too
    double h_ = 0;              ///< s, substep
    bool onKinematic_ = false;  ///< some contact is
    bool rests_ = false;        ///< nor will any body move in this substep
    bool loops_ = false;        ///< joints may pull against each other
    int restedSubsteps_ = 0;    ///< of this step
    Equations equations_;
    AlignedArray<std::uint32_t> states_;  ///< of the bodies
    AlignedArray<JointSim*> joints_;
    AlignedArray<SystemRow> moved_;  ///< scratch of moveRows
    AlignedArray<SystemPair> movedPairs_;
    AlignedArray<BlockPair> pairs_;
    AlignedArray<std::int32_t> jointEnds_;  ///< two local bodies per joint
    AlignedArray<std::int32_t> pointEnds_;  ///< and per point beside which they are closed
    // v and w of each body as its state has them. As floats: gcc 12 leaves out the rounding of double to float to
    // double where it vectorizes.
    AlignedArray<Vec3> written_;
};

}  // namespace ragtop::direct
