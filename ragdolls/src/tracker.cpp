#include "ragtop/tracker.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "ragtop/world.h"
#include "range_check.h"

namespace ragtop {
namespace {

constexpr float kStepShare = 0.3f;   ///< of a step, that the rate may be at most
constexpr float kBears = 4;          ///< stiffness of joints that bear all the weight, over that of a body that topples
constexpr float kKeys = 0.033f;      ///< s, over which accelerations are averaged: clips go straight from key to key
constexpr float kDamping = 0.5f;     ///< of joints that bear, over their stiffness by the rate of toppling
constexpr float kFelt = 0.05f;       ///< s, over which contacts are averaged
constexpr float kMostShare = 0.34f;  ///< of the last step's in that, at most
constexpr float kMore = 1.5f;        ///< of what the ground gave, that it is asked for at most

Vec3 bounded(const Vec3& v, float most) {
    const float size = length(v);
    return size > most ? (most / size) * v : v;
}

}  // namespace

std::string whyInvalid(const TrackerOptions& options) { return whyOutside(options); }

Tracker::Tracker(World& world, const Ragdoll& ragdoll, Muscles& muscles, const TrackerOptions& options)
    : world_(&world), ragdoll_(&ragdoll), muscles_(&muscles), options_(options), dynamics_(world, ragdoll) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("tracker: " + problem);
    const std::size_t parts = ragdoll.def().parts.size();
    goals_.resize(parts);
    accelerations_.resize(parts);
    outside_.resize(parts);
    felt_.resize(parts);
    smooth_.resize(parts);
    torques_.resize(ragdoll.def().joints.size());
    borne_.resize(torques_.size());
    for (const InverseDynamics::Part& part : dynamics_.parts())
        size_ = std::max(size_, length(relative(part.center, dynamics_.parts()[0].center)));
}

Tracker::~Tracker() {
    for (std::size_t i = 0; i < torques_.size(); ++i) muscles_->setGains(static_cast<int>(i), {});
}

/// Velocities are those since the last frame, accelerations those since the velocity before.
void Tracker::aim(std::span<const Pose> bones, float dt) {
    const RagdollDef& def = ragdoll_->def();
    const float share = std::min(dt / kKeys, 1.0f);
    now_ = goals_[0];
    for (std::size_t i = 0; i < goals_.size(); ++i) {
        Goal& goal = goals_[i];
        const Goal before = goal;
        const Pose& bone = bones[static_cast<std::size_t>(def.parts[i].bone)];
        goal.rotation = normalized(bone.rotation);
        goal.center = transformPoint(bone, world_->mass(ragdoll_->bodies()[i]).center);
        if (frames_ < 1) smooth_[i] = {};
        if (frames_ < 1) continue;
        goal.velocity = (1 / dt) * relative(goal.center, before.center);
        goal.spin = (1 / dt) * rotationVector(goal.rotation * conjugate(before.rotation));
        if (frames_ < 2) continue;
        smooth_[i].linear += share * ((1 / dt) * (goal.velocity - before.velocity) - smooth_[i].linear);
        smooth_[i].angular += share * ((1 / dt) * (goal.spin - before.spin) - smooth_[i].angular);
    }
    accelerations_ = smooth_;
    if (frames_ < 1) now_ = goals_[0];
    now_.velocity = goals_[0].velocity;
    now_.spin = goals_[0].spin;
    frames_ = std::min(frames_ + 1, 3);
}

/// What the ground gave of late, by its normal forces.
void Tracker::feel(float dt) {
    const float share = std::min(dt / kFelt, kMostShare);
    const std::span<const BodyId> own = ragdoll_->bodies();
    for (std::size_t i = 0; i < felt_.size(); ++i) {
        PartMotion felt;
        const BodyId body = own[i];
        if (!dynamics_.parts()[i].exists) continue;
        const DVec3 center = dynamics_.parts()[i].center;
        const auto touch = [&](const Contact& contact) {
            const BodyId other = contact.bodyA == body ? contact.bodyB : contact.bodyA;
            float impulses = 0;
            for (int k = 0; k < contact.pointCount; ++k) impulses += contact.points[k].impulse;
            if (!(impulses > 0) || std::find(own.begin(), own.end(), other) != own.end()) return;
            const Vec3 normal = contact.bodyA == body ? -contact.normal : contact.normal;
            for (int k = 0; k < contact.pointCount; ++k) {
                const Vec3 force = (contact.normalForce * contact.points[k].impulse / impulses) * normal;
                felt.linear += force;
                felt.angular += cross(relative(contact.points[k].point, center), force);
            }
        };
        world_->forEachContact(body, std::cref(touch));
        felt_[i].linear += share * (felt.linear - felt_[i].linear);
        felt_[i].angular += share * (felt.angular - felt_[i].angular);
    }
}

/// What touches the ground is to bear all that the motion takes along gravity: legs that push so much get it from
/// there, up to a multiple of what they got of late.
void Tracker::lean() {
    const Vec3 gravity = world_->settings().gravity;
    float needed = 0, given = 0;
    for (std::size_t i = 0; i < felt_.size(); ++i) {
        const InverseDynamics::Part& part = dynamics_.parts()[i];
        if (part.exists) needed += part.mass * dot(gravity - accelerations_[i].linear, gravity);
        given -= dot(felt_[i].linear, gravity);
    }
    const float factor = given > 0 ? std::clamp(needed / given, 0.0f, kMore) : 0;
    for (std::size_t i = 0; i < felt_.size(); ++i) outside_[i] = {factor * felt_[i].linear, factor * felt_[i].angular};
}

/// The body is to accelerate as the animation does and, as if it were rigid, back to where its root is to be.
void Tracker::help(float dt) {
    const InverseDynamics::Part& root = dynamics_.parts()[0];
    const float rate = std::min(options_.rate, kStepShare / dt), square = rate * rate;
    const Vec3 linear = square * relative(now_.center, root.center) + 2 * rate * (now_.velocity - root.velocity);
    const Vec3 angular = square * rotationVector(normalized(now_.rotation * conjugate(root.rotation))) +
                         2 * rate * (now_.spin - root.spin);
    for (std::size_t i = 0; i < accelerations_.size(); ++i) {
        const Vec3 arm = relative(dynamics_.parts()[i].center, root.center);
        accelerations_[i].linear += linear + cross(angular, arm);
        accelerations_[i].angular += angular;
    }
    lean();
    const PartMotion lacks = dynamics_.torques(accelerations_, outside_, torques_);
    const float weight = dynamics_.mass() * length(world_->settings().gravity);
    assistance_ = {bounded(lacks.linear, options_.force * weight),
                   bounded(lacks.angular, options_.torque * weight * size_)};
    world_->applyForce(ragdoll_->bodies()[0], assistance_.linear, root.center);
    world_->applyTorque(ragdoll_->bodies()[0], assistance_.angular);
    muscles_->expect(accelerations_, outside_);
}

/// What stands on a joint is not what hangs on it: by the share of the weight that the ground bears beyond it, a joint
/// has a multiple of the stiffness m g l of a body that topples, beside I ω² of what hangs there.
void Tracker::stiffen() {
    const RagdollDef& def = ragdoll_->def();
    const float gravity = length(world_->settings().gravity), weight = dynamics_.mass() * gravity;
    if (!(weight > 0)) return;
    std::fill(borne_.begin(), borne_.end(), 0.0f);
    for (std::size_t i = 0; i < felt_.size(); ++i) {
        const float share = length(felt_[i].linear) / weight;
        for (const InverseDynamics::Part* at = &dynamics_.parts()[i]; at->parent >= 0;
             at = &dynamics_.parts()[static_cast<std::size_t>(at->parent)])
            borne_[static_cast<std::size_t>(at->joint)] += share;
    }
    const MuscleProfile& profile = muscles_->profile();
    const float rate = 2 * kPi * profile.frequency, toppling = weight * size_;
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        const auto joint = static_cast<int>(i);
        const float inertia = dynamics_.inertiaBeyond(joint), stands = kBears * std::min(borne_[i], 1.0f) * toppling;
        muscles_->setGains(joint, MuscleGains{inertia * rate * rate + stands,
                                              2 * profile.dampingRatio * inertia * rate +
                                                  kDamping * stands * std::sqrt(size_ / std::max(gravity, 1e-6f))});
    }
}

void Tracker::follow(std::span<const Pose> bones, double dt) {
    const auto seconds = static_cast<float>(dt);
    muscles_->follow(bones, frames_ > 0 ? dt : 0);
    if (!(seconds > 0) || !std::isfinite(seconds)) return;
    dynamics_.look();
    aim(bones, seconds);
    assistance_ = {};
    if (frames_ < 3) return;
    feel(seconds);
    stiffen();
    help(seconds);
}

}  // namespace ragtop
