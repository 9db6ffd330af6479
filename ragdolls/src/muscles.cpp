#include "ragtop/muscles.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "joint_bodies.h"
#include "ragtop/world.h"
#include "range_check.h"
#include "within_limits.h"

namespace ragtop {
namespace {

MuscleProfile between(const MuscleProfile& a, const MuscleProfile& b, float share) {
    const auto mixed = [&](float from, float to) { return share < 1 ? from + share * (to - from) : to; };
    return {mixed(a.frequency, b.frequency), mixed(a.dampingRatio, b.dampingRatio), mixed(a.strength, b.strength),
            mixed(a.friction, b.friction), mixed(a.weight, b.weight)};
}

void requireDuration(float seconds) {
    if (!(seconds >= 0) || !std::isfinite(seconds))
        throw std::invalid_argument("muscles: seconds is " + std::to_string(seconds) +
                                    ", must be at least 0 and finite");
}

void requireValid(const MuscleProfile& profile) {
    if (const std::string problem = whyInvalid(profile); !problem.empty())
        throw std::invalid_argument("muscles: " + problem);
}

/// kg m, mass of all beyond a joint times the way from there to its centre.
float momentBeyond(const InverseDynamics& dynamics, int joint) {
    const std::span<const InverseDynamics::Part> parts = dynamics.parts();
    Vec3 moment;
    for (const InverseDynamics::Part& part : parts) {
        const InverseDynamics::Part* at = &part;
        while (at->joint != joint && at->parent >= 0) at = &parts[static_cast<std::size_t>(at->parent)];
        if (at->joint == joint) moment += part.mass * relative(part.center, at->anchor);
    }
    return length(moment);
}

/// What joints take at most of anything (joint.h): a body of any size and clips of any speed are within.
float bounded(float value, float most) { return std::clamp(value, -most, most); }
Vec3 bounded(const Vec3& v, float most) { return {bounded(v.x, most), bounded(v.y, most), bounded(v.z, most)}; }
constexpr float kMargin = 0.02f;  ///< rad, that targets keep from limits
constexpr float kMostTorque = 1e12f, kMostGain = 1e12f, kMostSpeed = 1e5f, kMostFriction = 1e9f;

}  // namespace

Muscles::Muscles(World& world, const Ragdoll& ragdoll, const MuscleProfile& profile)
    : world_(&world), ragdoll_(&ragdoll), profile_(profile), from_(profile), to_(profile), dynamics_(world, ragdoll) {
    requireValid(profile);
    const RagdollDef& def = ragdoll.def();
    float mass = 0;
    for (const RagdollPart& part : def.parts) mass += part.mass;
    muscles_.resize(def.joints.size());
    torque_.resize(def.joints.size());
    accelerations_.reserve(def.parts.size());
    outside_.reserve(def.parts.size());
    drives_.reserve(def.joints.size());
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        muscles_[i].most = strengthOf(def.parts[static_cast<std::size_t>(def.joints[i].child)].role, mass);
        // Of what is no human nothing is known: three times what holds it out straight, by its own size.
        if (!(muscles_[i].most > 0))
            muscles_[i].most = 3 * 9.81f * std::sqrt(dynamics_.inertiaBeyond(static_cast<int>(i)) * mass);
        // People's trunks have half as much again as holds them out straight, all else has more.
        muscles_[i].most = std::max(muscles_[i].most, 1.5f * 9.81f * momentBeyond(dynamics_, static_cast<int>(i)));
        muscles_[i].target = muscles_[i].aim = turnNow(static_cast<int>(i));
    }
}

Muscles::~Muscles() {
    for (std::size_t i = 0; i < muscles_.size(); ++i)
        if (world_->isValid(ragdoll_->joints()[i]) && powers(static_cast<int>(i))) rub(static_cast<int>(i), 1);
}

bool Muscles::powers(int joint) const {
    const JointDef& def = ragdoll_->def().joints[static_cast<std::size_t>(joint)].joint;
    return std::holds_alternative<BallDef>(def) || std::holds_alternative<HingeDef>(def);
}

void Muscles::setProfile(const MuscleProfile& profile, float seconds) {
    requireValid(profile);
    requireDuration(seconds);
    from_ = profile_;
    to_ = profile;
    easing_ = seconds > 0 ? 0.0f : 1.0f;
    easingRate_ = seconds > 0 ? 1 / seconds : 0;
    if (!(seconds > 0)) profile_ = profile;
}

void Muscles::setStrength(int joint, float share, float seconds) {
    Muscle& muscle = muscles_.at(static_cast<std::size_t>(joint));
    if (!(share >= 0 && share <= 1))
        throw std::invalid_argument("muscles: strength is " + std::to_string(share) + ", must be in [0, 1]");
    requireDuration(seconds);
    if (!(muscle.share > 0) && share > 0) fade(muscle, seconds);
    muscle.wanted = share;
    muscle.rate = seconds > 0 ? std::abs(share - muscle.share) / seconds : 0;
    if (!(seconds > 0)) muscle.share = share;
}

float Muscles::bound(int joint) const {
    const Muscle& muscle = muscles_.at(static_cast<std::size_t>(joint));
    return profile_.strength * muscle.share * muscle.most;
}

/// Of the child's joint frame in the parent's.
Quat Muscles::turnNow(int joint) const {
    const RagdollJoint& def = ragdoll_->def().joints[static_cast<std::size_t>(joint)];
    const JointBodies& joined = bodiesOf(def.joint);
    const Pose a = world_->pose(ragdoll_->bodies()[static_cast<std::size_t>(def.parent)]);
    const Pose b = world_->pose(ragdoll_->bodies()[static_cast<std::size_t>(def.child)]);
    return normalized(conjugate(a.rotation * joined.frameA.rotation) * (b.rotation * joined.frameB.rotation));
}

void Muscles::follow(std::span<const Pose> bones, double dt) {
    const RagdollDef& def = ragdoll_->def();
    if (bones.size() != def.bones.size())
        throw std::invalid_argument("muscles: got " + std::to_string(bones.size()) + " poses of bones, must be " +
                                    std::to_string(def.bones.size()));
    for (std::size_t i = 0; i < bones.size(); ++i)
        if (!isRotation(bones[i].rotation))
            throw std::invalid_argument("muscles: the rotation of bone " + std::to_string(i) + " (" +
                                        def.bones[i].name + ") is not finite or has not length 1");
    const auto rate = static_cast<float>(1 / std::max(dt, 1e-9));
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        const RagdollJoint& joint = def.joints[i];
        const JointBodies& joined = bodiesOf(joint.joint);
        const auto bone = [&](int part) {
            return static_cast<std::size_t>(def.parts[static_cast<std::size_t>(part)].bone);
        };
        const Quat a = bones[bone(joint.parent)].rotation * joined.frameA.rotation;
        const Quat turn = normalized(conjugate(a) * (bones[bone(joint.child)].rotation * joined.frameB.rotation));
        const Quat target = withinLimits(joint.joint, turn, kMargin);
        muscles_[i].speed = {};
        if (told_ && dt > 0)
            muscles_[i].speed = bounded(rate * rotationVector(target * conjugate(muscles_[i].target)), kMostSpeed);
        muscles_[i].target = target;
    }
    told_ = true;
}

void Muscles::setTarget(int joint, const Quat& turn, const Vec3& speed) {
    Muscle& muscle = muscles_.at(static_cast<std::size_t>(joint));
    if (!isRotation(turn) || !isFinite(speed))
        throw std::invalid_argument("muscles: the target of joint " + std::to_string(joint) +
                                    " or its speed is not finite or has not length 1");
    muscle.target =
        withinLimits(ragdoll_->def().joints[static_cast<std::size_t>(joint)].joint, normalized(turn), kMargin);
    muscle.speed = bounded(speed, kMostSpeed);
}

void Muscles::setGains(int joint, std::optional<MuscleGains> gains) {
    Muscle& muscle = muscles_.at(static_cast<std::size_t>(joint));
    const auto allowed = [](float gain) { return gain >= 0 && gain <= kMostGain; };
    if (gains && !(allowed(gains->stiffness) && allowed(gains->damping)))
        throw std::invalid_argument("muscles: stiffness and damping are " + std::to_string(gains->stiffness) + " and " +
                                    std::to_string(gains->damping) + ", must be in [0, 1e12]");
    muscle.given = gains.has_value();
    muscle.gains = gains.value_or(MuscleGains{});
}

void Muscles::crossfade(float seconds) {
    requireDuration(seconds);
    for (Muscle& muscle : muscles_) fade(muscle, seconds);
}

void Muscles::fade(Muscle& muscle, float seconds) {
    muscle.fading = seconds > 0 ? 0.0f : 1.0f;
    muscle.fadingRate = seconds > 0 ? 1 / seconds : 0;
    muscle.before = muscle.aim;
    muscle.had = muscle.has;
    muscle.gave = muscle.gives;
    muscle.went = muscle.goes;
}

void Muscles::expect(std::span<const PartMotion> accelerations, std::span<const PartMotion> outside) {
    const std::size_t parts = ragdoll_->def().parts.size();
    for (const std::size_t size : {accelerations.size(), outside.size()})
        if (size != parts)
            throw std::invalid_argument("muscles: got " + std::to_string(size) + " motions or wrenches, must be " +
                                        std::to_string(parts));
    accelerations_.assign(accelerations.begin(), accelerations.end());
    outside_.assign(outside.begin(), outside.end());
}

float Muscles::error(int joint) const {
    return length(rotationVector(conjugate(turnNow(joint)) * muscles_.at(static_cast<std::size_t>(joint)).target));
}

float Muscles::error() const {
    float sum = 0, count = 0;
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        if (!powers(static_cast<int>(i)) || !world_->isValid(ragdoll_->joints()[i])) continue;
        const float off = error(static_cast<int>(i));
        sum += off * off;
        ++count;
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

void Muscles::ease(float dt) {
    if (easing_ < 1) {
        easing_ = std::min(easing_ + easingRate_ * dt, 1.0f);
        profile_ = between(from_, to_, easing_);
    }
    for (Muscle& muscle : muscles_) {
        muscle.fading = std::min(muscle.fading + muscle.fadingRate * dt, 1.0f);
        const float left = muscle.wanted - muscle.share, way = muscle.rate * dt;
        muscle.share = std::abs(left) <= way ? muscle.wanted : muscle.share + (left > 0 ? way : -way);
    }
}

/// The joint as defined, with a share of its friction and no spring.
void Muscles::rub(int joint, float friction) {
    const auto at = static_cast<std::size_t>(joint);
    JointDef def = ragdoll_->def().joints[at].joint;
    if (auto* ball = std::get_if<BallDef>(&def)) ball->friction = bounded(ball->friction * friction, kMostFriction);
    if (auto* hinge = std::get_if<HingeDef>(&def)) hinge->friction = bounded(hinge->friction * friction, kMostFriction);
    std::visit([&](auto& each) { each.bodies = bodiesOf(world_->def(ragdoll_->joints()[at])); }, def);
    world_->setDef(ragdoll_->joints()[at], def);
}

/// τ = τ₀ − k e − c (ω − ω_t) with k = I ω², c = 2 ζ I ω of the inertia I of all beyond the joint. What is more than
/// the muscle has scales all of it down, now or as the error will be when the step ends: the solver then has no bound
/// to find, which would cost it a direct solve (docs/adr/0080).
void Muscles::drive(int joint, float dt) {
    const auto at = static_cast<std::size_t>(joint);
    const RagdollJoint& def = ragdoll_->def().joints[at];
    Muscle& muscle = muscles_[at];
    const float most = bound(joint), rate = 2 * kPi * profile_.frequency, inertia = dynamics_.inertiaBeyond(joint);
    MuscleGains gains{bounded(inertia * rate * rate, kMostGain),
                      bounded(2 * profile_.dampingRatio * inertia * rate, kMostGain)};
    if (muscle.given) gains = muscle.gains;
    muscle.aim = muscle.target;
    muscle.goes = muscle.speed;
    float s = 1;
    if (muscle.fading < 1) {
        s = muscle.fading * muscle.fading * (3 - 2 * muscle.fading);
        muscle.goes = muscle.went + s * (muscle.speed - muscle.went);
        const Vec3 way = rotationVector(muscle.target * conjugate(muscle.before));
        muscle.aim = normalized(rotationAbout(way, s * length(way)) * muscle.before);
        gains = {muscle.had.stiffness + s * (gains.stiffness - muscle.had.stiffness),
                 muscle.had.damping + s * (gains.damping - muscle.had.damping)};
    }
    muscle.has = gains;
    const InverseDynamics::Part& a = dynamics_.parts()[static_cast<std::size_t>(def.parent)];
    const InverseDynamics::Part& b = dynamics_.parts()[static_cast<std::size_t>(def.child)];
    const JointBodies& joined = bodiesOf(def.joint);
    const Quat axes = a.rotation * joined.frameA.rotation;
    const Quat turn = normalized(conjugate(axes) * (b.rotation * joined.frameB.rotation));
    Vec3 error = rotationVector(turn * conjugate(muscle.aim));
    Vec3 lag = inverseRotate(axes, b.spin - a.spin) - muscle.goes;
    Vec3 given = bounded(profile_.weight * inverseRotate(axes, torque_[at]), kMostTorque);
    const auto* hinge = std::get_if<HingeDef>(&def.joint);
    float angle = 0;
    if (hinge) {
        // The turn of the target about the axis, on the lap that the hinge is on.
        const float now = world_->state(ragdoll_->joints()[at]).coordinate;
        const float wanted = 2 * arcTan2(muscle.aim.x, muscle.aim.w);
        angle = wanted + 2 * kPi * std::floor((now - wanted) / (2 * kPi) + 0.5f);
        error = {now - angle, 0, 0};
        lag = {lag.x, 0, 0};
        given = {given.x, 0, 0};
    }
    given = muscle.gives = muscle.gave + s * (given - muscle.gave);
    const Vec3 torque = given - gains.stiffness * error - gains.damping * lag;
    const float needed = std::max(length(torque), length(torque - (gains.stiffness * dt) * lag));
    const float share = needed > most ? most / needed : 1.0f;
    muscle.torque = rotate(axes, share * torque);
    drives_.push_back({.joint = ragdoll_->joints()[at],
                       .target = muscle.aim,
                       .angle = angle,
                       .speed = muscle.goes,
                       .feedForward = share * given,
                       .stiffness = share * gains.stiffness,
                       .damping = share * gains.damping});
}

void Muscles::step(double dt) {
    dynamics_.look();
    step(dt, dynamics_);
}

void Muscles::step(double dt, const InverseDynamics& seen) {
    const auto seconds = static_cast<float>(dt);
    if (!(seconds > 0) || !std::isfinite(seconds)) return;
    ease(seconds);
    if (&seen != &dynamics_) dynamics_.look(seen);
    dynamics_.torques(accelerations_, outside_, torque_);
    drives_.clear();
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        const auto joint = static_cast<int>(i);
        Muscle& muscle = muscles_[i];
        muscle.torque = {};
        if (!world_->isValid(ragdoll_->joints()[i]) || !powers(joint)) continue;
        const bool limp = !(bound(joint) > 0);
        const float rubbing = muscle.share > 0 ? profile_.friction : std::max(profile_.friction, 1.0f);
        const float friction = limp ? -1.0f - rubbing : rubbing;
        if (muscle.friction != friction) {
            rub(joint, rubbing);
            muscle.friction = friction;
        }
        if (limp) {
            muscle.aim = turnNow(joint);
            muscle.has = {};
            muscle.gives = muscle.goes = {};
        } else {
            drive(joint, seconds);
        }
    }
    world_->setDrives(drives_);
    accelerations_.clear();
    outside_.clear();
}

}  // namespace ragtop
