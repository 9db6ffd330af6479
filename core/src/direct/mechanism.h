#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "direct/factor.h"
#include "direct/rotation.h"

/// Bodies on joints with loops that depend on nobody else within a step: they have a time of their own. A substep is as
/// many RATTLE steps [Andersen 1983; Reich 1996] as their turning asks for,
///   kick ½h a,  impulses Gₙᵀλ such that C(qₙ₊₁) = 0,  free motion over h,  kick ½h a,  impulses Gₙ₊₁ᵀμ such that
///   Gₙ₊₁ v = 0,
/// which is of second order, reversible and symplectic, so that energy errs by a bounded amount (docs/adr/0021).
namespace ragtop::direct {

struct MechanismPose {
    DVec3 x;  ///< m, centre of mass, from any place nearby
    DQuat q;  ///< principal axes to world
};

/// What does not move goes on with v and w.
struct MechanismBody {
    double inverseMass = 0;               ///< 1/kg
    DVec3 moments, inverseMoments;        ///< kg m², 1/(kg m²)
    DVec3 acceleration, torque;           ///< m/s², N m
    double damping = 0, turnDamping = 0;  ///< 1/s
    DVec3 v, w;                           ///< m/s, rad/s
    DVec3 momentum;                       ///< about the centre of mass, world axes; w follows it
};

enum class MechanismJointKind : std::uint8_t { ball, hinge, fixed };

/// Frames are seen from the bodies' principal axes; x is the axis of a hinge.
struct MechanismJoint {
    MechanismJointKind kind = MechanismJointKind::ball;
    std::uint32_t a = 0, b = 0;
    DVec3 anchorA, anchorB;
    DQuat frameA, frameB;
    DVec3 force, torque;  ///< what B receives over a substep, N s and N m s
};

class Mechanism {
public:
    explicit Mechanism(std::pmr::memory_resource* memory);

    /// Room for bodies that move, and behind them those that do not; all is to be written then.
    void resize(std::size_t moving, std::size_t others, std::size_t joints);
    std::size_t movingCount() const { return moving_; }
    MechanismBody& body(std::size_t i) { return bodies_[i]; }
    MechanismPose& pose(std::size_t i) { return poses_[i]; }
    MechanismJoint& joint(std::size_t i) { return joints_[i]; }

    /// Once all is written: the pattern of the equations.
    void begin();
    /// A velocity from outside.
    void changeVelocity(std::size_t body, const DVec3& linear, const DVec3& angular);
    /// Moves all over a substep of h; errors of joints shrink by the share `closing` in each inner step. False, and the
    /// bodies are anywhere, when a step has no answer or a body turns too fast.
    bool advance(double h, double closing);
    /// Forces and torques of the joints in the last substep: the least that move the bodies so.
    void findLoads();

    /// Inner steps per substep: given before begin, more where that is needed. `need` is the most that any substep
    /// since has asked for.
    void setPace(int innerSteps) { effort_.pace = innerSteps; }
    int pace() const { return effort_.pace; }
    double largestNeed() const { return effort_.largestNeed; }
    int iterations() const { return effort_.iterations; }          ///< solves since begin
    int factorizations() const { return effort_.factorizations; }  ///< since begin

private:
    /// A scalar equation.
    struct Row {
        double ja[6], jb[6];
        double resistance;  ///< R
        double target;      ///< change of speed
        double unit;        ///< m that an error of 1 is: the longest arm where it is an angle
    };
    /// Where a joint is in the equations.
    struct Place {
        std::uint32_t firstRow = 0, rowCount = 0, block = 0;
        bool movesA = false, movesB = false;
    };
    /// Linear and angular impulse, or change of velocity, of one body.
    struct Twist {
        double at[6];
    };

    double need(double h) const;
    int mostInnerSteps() const;
    double energy() const;
    bool gains(double before, double h) const;
    bool advanceBy(double h, double closing);
    bool step(double h, double closing);
    void kick(double h);
    void give(const Twist* impulses);
    void updateLoads();
    bool closePositions(double h, double closing);
    void closeVelocities();
    void moveFreely(double h);
    double tryPositions(double h);
    void errorsAt(const MechanismPose* poses, double* errors) const;
    bool isNearlyAligned() const;
    bool refresh();
    void writeRows(std::size_t joint);
    void finishRow(std::size_t joint, Row& row) const;
    void addJoint(std::size_t joint);
    double speedOf(std::size_t joint, const Row& row, const Twist* velocities) const;
    void solveTargets();
    void addChange(Twist* impulses, double sign);
    void measureSwing(double h);
    double fastestTurn() const;

    std::size_t moving_ = 0;
    double reach_ = 0;         ///< m, of the longest arm
    double fastestSwing_ = 0;  ///< rad/s, of a link across its tension, when the step began
    struct Effort {
        int pace = 1, iterations = 0, factorizations = 0;
        double largestNeed = 0;
    };
    Effort effort_;
    bool ready_ = false;   ///< rows, factor and errors are those of the poses
    double lastStep_ = 0;  ///< s, that restImpulses_ belong to
    AlignedArray<MechanismBody> bodies_, startBodies_;
    AlignedArray<MechanismPose> poses_, next_, startPoses_;
    AlignedArray<MechanismJoint> joints_;
    AlignedArray<Place> places_;
    AlignedArray<Row> rows_;
    AlignedArray<double> errors_, aims_;               ///< per row: C, and what it is to be
    AlignedArray<DSym3> inertia_, inverseInertia_;     ///< in world axes, of the factor
    AlignedArray<Twist> moveImpulses_, restImpulses_;  ///< of the joints, in the two halves of the last step
    AlignedArray<Twist> change_, velocities_;
    AlignedArray<BlockPair> pairs_;
    BlockFactor factor_;
};

}  // namespace ragtop::direct
