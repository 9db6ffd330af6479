#pragma once

#include <optional>

#include "ragdoll_trial.h"
#include "ragtop/balance.h"
#include "ragtop/brace.h"
#include "ragtop/muscles.h"

namespace ragtop::demos {

/// s, in which a human that is set upright comes to stand still.
inline constexpr double kSettled = 6;

/// A human that balances on a floor of its own.
class RagdollStander {
public:
    /// The floor is tilted by `slope`, rad, upwards to where `uphill` points.
    explicit RagdollStander(const RagdollDef& def, float slope = 0, const Vec3& uphill = {0, 0, 1});

    /// None where the subject is no human on two legs of three parts.
    static const RagdollDef* standerOf(const RagdollSubject& subject);

    void step(double dt) { step(dt, nullptr, true); }
    /// Bracing for a fall, or with neither that nor balance.
    void step(double dt, Brace* brace, bool balancing);
    /// The floor turns or moves to `target` in the next step.
    void moveFloor(const Pose& target, double dt);
    /// All parts get the velocity that an impulse of `size` N s along a level direction gives the whole.
    void push(const Vec3& direction, float size);
    /// A ball of so many kg in its left hand.
    void load(float mass);
    /// Of the impulse that a body without a step can take along a level direction, N s: m d √(g/z).
    float most(const Vec3& direction) const;
    bool stands() const;
    double height() const { return dynamics_.centerOfMass().y; }
    const InverseDynamics& dynamics() const { return dynamics_; }
    World& world() { return world_; }
    BodyId floor() const { return floor_; }
    Ragdoll& body() { return body_; }
    Muscles& muscles() { return muscles_; }
    Balance& balance() { return balance_; }

private:
    World world_;
    BodyAxes axes_;
    BodyId floor_;
    Ragdoll body_;
    Muscles muscles_;
    Balance balance_;
    InverseDynamics dynamics_;
    double upright_ = 0;  ///< m, of the centre of mass at first
};

std::vector<RagdollFigure> balance(const RagdollSubject& subject, const RagdollTrialOptions& options);
/// Pushed beyond that, 64 ways.
std::vector<RagdollFigure> brace(const RagdollSubject& subject, const RagdollTrialOptions& options);
/// Gets up from how it lies after a drop, as many as seeds.
std::vector<RagdollFigure> getUp(const RagdollSubject& subject, const RagdollTrialOptions& options);

/// Follows a clip of its own, with and without help.
std::vector<RagdollFigure> track(const RagdollSubject& subject, const RagdollTrialOptions& options);

}  // namespace ragtop::demos
