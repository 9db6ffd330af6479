#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/anatomy.h"
#include "ragtop/inverse_dynamics.h"
#include "ragtop/math.h"
#include "ragtop/ragdoll.h"
#include "ragtop/tunables.h"

/// Powered ragdolls: muscles that hold or follow a pose, as strong as a human's.
namespace ragtop {

/// How tense a body is.
struct MuscleProfile {
    float frequency = 4.0f;  ///< Hz, at which a part with all that hangs on it would swing about its target
    float dampingRatio = 1.0f;
    float strength = 1.0f;  ///< of the greatest torques of strengthOf
    float friction = 0.0f;  ///< of the joints' dry friction in the definition, which stands for tissue that is limp
    float weight = 1.0f;    ///< share of the weight beyond a joint that its muscles bear without being bent
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const MuscleProfile*) {
    visit(Tunable{"frequency", "Hz", 0.1, 20, "of a part with all that hangs on it about its target"}, self.frequency);
    visit(Tunable{"dampingRatio", "1", 0, 10, "damping over that without overshoot"}, self.dampingRatio);
    visit(Tunable{"strength", "1", 0, 100, "of the greatest torques of a human of that mass"}, self.strength);
    visit(Tunable{"friction", "1", 0, 100, "of the dry friction of the joints"}, self.friction);
    visit(Tunable{"weight", "1", 0, 1, "share of the weight that is borne without being bent"}, self.weight);
}

/// "limp", "weak", "relaxed", "tense" or "rigid". Throws std::invalid_argument that names them all.
MuscleProfile muscleProfile(std::string_view name);
/// Names of all of them, from limp to rigid.
std::span<const std::string_view> muscleProfileNames();
/// Empty when the profile is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const MuscleProfile& profile);

/// Greatest torque, N m, of the muscles that move a part against what carries it, in a human of `bodyMass` kg: of the
/// stronger direction, of the median man; 0 for `other`.
float strengthOf(BodyRole role, float bodyMass);

/// Stiffness, N m/rad, and damping, N m s/rad, of one joint.
struct MuscleGains {
    float stiffness = 0, damping = 0;
};

/// Visits the values of `from` one by one, as those that are saved (Muscles::visitState).
template <class Gains, class Visit>
void visitGains(Gains& from, Visit&& visit) {
    visit(from.stiffness);
    visit(from.damping);
}

/// The muscles of one ragdoll: a damped spring on each ball and hinge, to whose torque that is added which inverse
/// dynamics ask for (inverse_dynamics.h), and all of it bounded by what the muscle can give where each step begins. At
/// first they hold the pose that the ragdoll is in. They act between parts only, so that nothing holds the body up but
/// what it touches. World and ragdoll must outlive them and stay where they are; the joints are as defined again once
/// they are gone. Strengths and targets are not part of a world's saved state; who saves them goes by visitState().
/// Steps do not allocate but where the friction of a profile changes or a joint becomes limp.
///
///     muscles.follow(clip.pose(t), dt);  muscles.step(dt);  world.step(dt);
///
/// A bone is limp at strength 0, with the dry friction of its tissue. How much of a bone is drawn from physics is
/// `blend` with a share for each bone (pose.h).
class Muscles {
public:
    /// Throws std::invalid_argument on a bad profile.
    Muscles(World& world, const Ragdoll& ragdoll, const MuscleProfile& profile = {});
    ~Muscles();
    Muscles(const Muscles&) = delete;
    Muscles& operator=(const Muscles&) = delete;

    const MuscleProfile& profile() const { return profile_; }
    /// From the next step on; gains and torques get there within `seconds`, so that nothing jumps. Throws
    /// std::invalid_argument on a bad profile or duration.
    void setProfile(const MuscleProfile& profile, float seconds = 0.2f);
    /// Strength of one joint of the definition beside the profile's, 0 (limp) to 1, as an injury leaves it; gets there
    /// within `seconds`, one that was limp by a crossfade. Throws std::out_of_range, and std::invalid_argument on a
    /// number that is none of these.
    void setStrength(int joint, float share, float seconds = 0.2f);
    /// What setStrength has reached by now.
    float strength(int joint) const { return muscles_.at(static_cast<std::size_t>(joint)).share; }
    /// Greatest torque of a joint by profile, role and strength now, N m.
    float bound(int joint) const;

    /// The pose to take: world poses of the bones, of which turns to each other count, as far as joints go. With the
    /// seconds since the pose before, muscles know how fast it moves; 0: it stands. Throws std::invalid_argument on
    /// another number of bones or a rotation that is none.
    void follow(std::span<const Pose> bones, double dt = 0);
    /// Root mean square over the muscles of the angle to their targets, rad; and of one joint.
    float error() const;
    float error(int joint) const;

    /// The same for one joint: the turn of the child's joint frame in the parent's, and how fast that turns, rad/s, in
    /// the parent's joint frame. Throws as follow() does, and std::out_of_range.
    void setTarget(int joint, const Quat& turn, const Vec3& speed = {});
    /// Of one joint in the stead of what the profile makes of the inertia beyond it; nothing: the profile's again.
    /// Throws std::out_of_range, and std::invalid_argument on what is below zero or not finite.
    void setGains(int joint, std::optional<MuscleGains> gains);
    /// Targets, their speeds, gains and what is fed forward that are set from now on are reached from those of now
    /// within `seconds`, so that who else moves the body takes over without a jump. Throws std::invalid_argument on a
    /// duration that is none.
    void crossfade(float seconds);
    /// What inverse dynamics count in the next step: how parts are to accelerate, and what pushes them from outside
    /// beside gravity, one entry per part. Throws std::invalid_argument on another number of entries.
    void expect(std::span<const PartMotion> accelerations, std::span<const PartMotion> outside);

    /// Sets the joints for the next step of the world, of dt seconds; does not throw.
    void step(double dt);
    /// The same with what was just seen of this ragdoll.
    void step(double dt, const InverseDynamics& seen);
    /// Torque that a joint was given where the last step began, N m, world axes, on the child.
    const Vec3& torque(int joint) const { return muscles_.at(static_cast<std::size_t>(joint)).torque; }
    const InverseDynamics& dynamics() const { return dynamics_; }

    /// Calls visit(value) for all that later steps depend on, between steps: numbers, flags and rotations one by one.
    template <class Self, class Visit>
    static void visitState(Self& self, Visit&& visit);

private:
    struct Muscle {
        float most = 0;                    ///< N m, of a healthy human
        float share = 1, wanted = 1;       ///< of the strength; and where it is going
        float rate = 0;                    ///< 1/s
        float fading = 1, fadingRate = 0;  ///< of the crossfade
        float friction = -3e38f;           ///< share that the joint has now; −1 minus it without a spring
        Quat target{};                     ///< of the child's joint frame in the parent's
        Vec3 speed{};                      ///< rad/s, of the target, in the parent's joint frame
        bool given = false;        ///< has gains of its own?
        MuscleGains gains{};
        Quat aim{}, before{};      ///< target of the last step, and of where the crossfade began
        MuscleGains had{}, has{};  ///< gains there, and of the last step
        Vec3 gave{}, gives{};      ///< N m that are fed forward, in the parent's joint frame, likewise
        Vec3 went{}, goes{};       ///< rad/s, of the target, likewise
        Vec3 torque{};             ///< N m, world axes
    };

    static void fade(Muscle& muscle, float seconds);
    bool powers(int joint) const;
    Quat turnNow(int joint) const;
    void ease(float dt);
    void rub(int joint, float friction);
    void drive(int joint, float dt);

    World* world_;
    const Ragdoll* ragdoll_;
    MuscleProfile profile_, from_, to_;
    float easing_ = 1, easingRate_ = 0;
    InverseDynamics dynamics_;
    std::vector<Muscle> muscles_;                      ///< one per joint
    std::vector<Vec3> torque_;                         ///< N m, world axes, that inverse dynamics ask for
    std::vector<PartMotion> accelerations_, outside_;  ///< expected of the next step; empty: none
    std::vector<JointDrive> drives_;
    bool told_ = false;  ///< was there a target before?
};

template <class Self, class Visit>
void Muscles::visitState(Self& self, Visit&& visit) {
    for (auto* profile : {&self.profile_, &self.from_, &self.to_}) {
        visit(profile->frequency);
        visit(profile->dampingRatio);
        visit(profile->strength);
        visit(profile->friction);
        visit(profile->weight);
    }
    visit(self.easing_);
    visit(self.easingRate_);
    visit(self.told_);
    for (auto& muscle : self.muscles_) {
        for (auto* number : {&muscle.share, &muscle.wanted, &muscle.rate, &muscle.fading, &muscle.fadingRate,
                             &muscle.friction})
            visit(*number);
        visit(muscle.given);
        for (auto* gains : {&muscle.gains, &muscle.had, &muscle.has}) visitGains(*gains, visit);
        for (auto* turn : {&muscle.target, &muscle.aim, &muscle.before}) visit(*turn);
        for (auto* vector : {&muscle.speed, &muscle.gave, &muscle.gives, &muscle.went, &muscle.goes, &muscle.torque})
            visit(*vector);
    }
}

}  // namespace ragtop
