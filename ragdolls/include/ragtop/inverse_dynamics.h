#pragma once

#include <span>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/ragdoll.h"

/// What joints have to give for a motion that is asked for.
namespace ragtop {

/// In world axes, at a centre of mass: m/s² and rad/s² of an acceleration, N and N m of a wrench.
struct PartMotion {
    Vec3 linear{}, angular{};
};

/// Recursive Newton-Euler on the tree of a ragdoll [Featherstone, Rigid Body Dynamics Algorithms, 2008, section 5.3],
/// in world axes. What other bodies hang on a part by joints, as a prop in a hand, counts as part of it. World and
/// ragdoll must outlive it and stay where they are. Nothing but the constructor allocates.
class InverseDynamics {
public:
    /// One part of the ragdoll with what it carries, as of the last look().
    struct Part {
        int parent = -1, joint = -1;  ///< part and joint that carry it, of the definition
        bool exists = true;
        float mass = 0;  ///< kg
        Mat3 inertia{};  ///< kg m², about the centre, world axes
        DVec3 center{};  ///< m, of mass
        DVec3 anchor{};  ///< m, of the joint that carries it
        Quat rotation{};
        Vec3 velocity{}, spin{};  ///< m/s of the centre, rad/s
    };

    InverseDynamics(const World& world, const Ragdoll& ragdoll);

    /// Takes up where all parts are, what they weigh and how they move.
    void look();
    /// The same from who has just looked at this ragdoll, while nothing of it has changed since.
    void look(const InverseDynamics& seen);
    std::span<const Part> parts() const { return parts_; }
    float mass() const { return mass_; }  ///< kg, of all together
    const DVec3& centerOfMass() const { return center_; }
    const Vec3& velocity() const { return velocity_; }  ///< m/s, of the centre of mass
    Vec3 angularMomentum() const;                       ///< kg m²/s, about it

    /// Accelerations of all parts, from that of the root and the angular acceleration of each joint (rad/s², world
    /// axes, of its child seen from its parent), for the velocities that they have.
    void accelerate(const PartMotion& root, std::span<const Vec3> joints, std::span<PartMotion> parts) const;
    /// The torque that each joint gives its child, N m in world axes, where parts accelerate so and outside wrenches
    /// act on them beside gravity; one entry per joint of the definition. Returns what the root lacks, which nothing
    /// but more from outside can give: at its centre of mass. Empty spans are zeros.
    PartMotion torques(std::span<const PartMotion> accelerations, std::span<const PartMotion> outside,
                       std::span<Vec3> torques) const;
    /// kg m², about the point of a joint, of all beyond it, and of the rest: about the axis that has most, at most.
    float inertiaBeyond(int joint) const { return beyond_[static_cast<std::size_t>(joint)]; }
    float inertiaOfRest(int joint) const;

private:
    void carry(std::size_t part);

    const World* world_;
    const Ragdoll* ragdoll_;
    std::vector<Part> parts_;
    std::vector<float> beyond_;             ///< per joint
    mutable std::vector<PartMotion> load_;  ///< per part
    float mass_ = 0;
    DVec3 center_{};
    Vec3 velocity_{};
};

}  // namespace ragtop
