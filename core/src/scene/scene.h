#pragma once

#include <cstdint>

#include "activity/activity.h"
#include "constraints/initial_violation.h"
#include "contacts/shape_bounds.h"

/// What there is: bodies, shapes, joints and couplings that are made, changed and destroyed between steps.
namespace ragtop {

/// Counts of changes, for those who keep what they derive from the scene.
struct Versions {
    std::uint64_t structure = 0;  ///< something was made or destroyed
    std::uint64_t fixed = 0;      ///< what does not move came, went or was moved
};

/// Moves a body, which keeps its speed as seen from itself, and so its energy.
void shiftBody(Bodies& bodies, std::uint32_t body, const Shift& shift);

/// Makes, changes and destroys. Definitions are checked here: std::invalid_argument names the field, its value and what
/// is allowed, and nothing has changed then.
struct Scene {
    Bodies& bodies;
    Shapes& shapes;
    Contacts& contacts;
    Manifolds& manifolds;
    Joints& joints;
    Couplings& couplings;
    const Broadphase& broadphase;
    Islands& islands;
    Articulations& articulations;
    DirectSet& directSet;
    ContactFinds& contactFinds;
    EventLog& events;
    Versions& versions;
    Vec3 gravity;  ///< m/s²
    ShapeBounds bounds;
    Activity activity;

    // bodies.cpp
    std::uint32_t createBody(const BodyDef& def) const;
    void destroyBody(std::uint32_t body) const;
    void setPose(std::uint32_t body, const Pose& pose) const;
    /// The internal frame moves in the body; all that is kept in it moves the other way.
    void changeMass(std::uint32_t body, const MassProperties& mass) const;
    /// A shape in its body. What it goes there counts as travel of the body.
    void moveShape(std::uint32_t shape, const Frame& frame) const;
    /// Constraints of a body begin without a guess, or as if they had just been made.
    void forgetImpulses(std::uint32_t body, bool anew = true) const;

    // types.cpp
    void setType(std::uint32_t body, BodyType type) const;
    void setEnabled(std::uint32_t body, bool enabled) const;
    /// After something has changed by which a joint holds, where it held or not before.
    void settleJoint(std::uint32_t joint, bool held) const;

    // joints.cpp
    std::uint32_t createJoint(const JointDef& def) const;
    void destroyJoint(std::uint32_t joint) const;
    /// Of the same kind, between the same bodies, which wake.
    void redefineJoint(std::uint32_t joint, const JointDef& def) const;
    /// The solver's form of a joint, from its definition and the centres of its bodies.
    void compile(std::uint32_t joint) const;
    /// By how much the joint is open where its bodies are now, as a caller left it.
    void noteOpening(std::uint32_t joint) const;
    /// Those that bore too much in a step of dt seconds, in the order of their ids, so that events depend on the scene
    /// alone.
    void breakJoints(float dt) const;

    // new_joints.cpp
    /// Bodies that a joint was just made for lose at once what their velocities have that it does not allow, as in an
    /// impact. The soft rows would let some of it open the joint first, and closing it again gives energy to what the
    /// joint bears.
    void settleNewJoints() const;
    /// Joints that were made beyond their limits come back a little in each step. What their velocities no longer fit
    /// then they lose, as when the joint was made. Serial and in order of the list.
    void correctInitialViolations() const;

    // couplings.cpp
    std::uint32_t createCoupling(const CouplingDef& def) const;
    void destroyCoupling(std::uint32_t coupling) const;
    /// Throws where a definition is not valid, or names what these joints do not have.
    void checkCoupled(const CouplingDef& def) const;

private:
    void addShape(std::uint32_t body, const ShapeDef& def, const Frame& frame, const Shape& geometry,
                  const Frame& toInternal) const;
    void moveAnchors(std::uint32_t body, const Frame& move) const;
    /// What the solver streams through, from the record.
    void resetSolverState(std::uint32_t body) const;
    void refreshBounds(std::uint32_t body) const;
    /// What was put somewhere did not travel there.
    void forgetGaps(std::uint32_t body) const;
    void wakeOverlapped(std::uint32_t body) const;
    void becomeSolid(std::uint32_t body) const;
    void takePart(std::uint32_t body, BodyType type, bool enabled) const;
    void withdraw(std::uint32_t body) const;
    void settleRole(std::uint32_t body) const;
};

}  // namespace ragtop
