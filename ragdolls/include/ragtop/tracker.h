#pragma once

#include <span>
#include <string>
#include <vector>

#include "ragtop/inverse_dynamics.h"
#include "ragtop/muscles.h"
#include "ragtop/tunables.h"

/// A powered ragdoll that follows an animation through the world.
namespace ragtop {

/// What a body that follows an animation may be helped with.
struct TrackerOptions {
    float force = 1.0f;   ///< most assistance, over the weight
    float torque = 1.0f;  ///< most assistance, over weight times height of the root over the ground at first
    float rate = 12;      ///< 1/s, at which assistance, critically damped, brings the root where it is to be
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TrackerOptions*) {
    visit(Tunable{"force", "1", 0, 10, "most assistance, over the weight"}, self.force);
    visit(Tunable{"torque", "1", 0, 10, "most assistance, over weight times size of the body"}, self.torque);
    visit(Tunable{"rate", "1/s", 0.1, 60, "at which assistance brings the root where it is to be"}, self.rate);
}

/// Empty when the options are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const TrackerOptions& options);

/// Follows an animation in the world: joints by muscles with the torques of inverse dynamics for the accelerations of
/// the animation and what the ground gave of late; the root by what these leave over, the wrench that no joint can
/// give, bounded and told. Gains of all joints are the tracker's as long as it lives. With bounds of zero nothing acts
/// on the body but gravity and contacts. World, ragdoll and muscles must outlive it and stay where they are. Steps do
/// not allocate.
///
///     tracker.follow(clip.pose(t + dt), dt);  muscles.step(dt);  world.step(dt);
class Tracker {
public:
    /// Throws std::invalid_argument on bad options.
    Tracker(World& world, const Ragdoll& ragdoll, Muscles& muscles, const TrackerOptions& options = {});

    ~Tracker();
    Tracker(const Tracker&) = delete;
    Tracker& operator=(const Tracker&) = delete;

    /// World poses of the bones at the end of the next step of the world, of dt seconds; once a step. The first two
    /// tell how the animation moves, and may come before any step. Sets targets of the muscles, what they expect, and
    /// the assistance. Throws std::invalid_argument as Muscles::follow does.
    void follow(std::span<const Pose> bones, double dt);
    /// The animation begins anew, somewhere else.
    void reset() { frames_ = 0; }
    /// N, and N m about the root's centre of mass, world axes, in the next step of the world.
    const PartMotion& assistance() const { return assistance_; }

private:
    struct Goal {
        DVec3 center{};  ///< m, of mass
        Quat rotation{};
        Vec3 velocity{}, spin{};  ///< m/s and rad/s, since the frame before
    };

    void aim(std::span<const Pose> bones, float dt);
    void feel(float dt);
    void stiffen();
    void lean();
    void help(float dt);

    World* world_;
    const Ragdoll* ragdoll_;
    Muscles* muscles_;
    TrackerOptions options_;
    InverseDynamics dynamics_;
    std::vector<Goal> goals_;                          ///< per part, at the end of the next step
    std::vector<PartMotion> accelerations_, outside_;  ///< per part
    std::vector<PartMotion> smooth_;                   ///< likewise, of the animation
    std::vector<PartMotion> felt_;                     ///< likewise, of contacts
    std::vector<Vec3> torques_;                        ///< per joint
    std::vector<float> borne_;                         ///< share of the weight, per joint, by what is beyond it
    Goal now_{};                                       ///< of the root, where the step begins
    float size_ = 1;                                   ///< m
    int frames_ = 0;                                   ///< of the animation, up to three
    PartMotion assistance_;
};

}  // namespace ragtop
