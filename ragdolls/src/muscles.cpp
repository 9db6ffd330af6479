#include "ragtop/muscles.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ragtop/world.h"
#include "range_check.h"

namespace ragtop {
namespace {

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& each) -> const JointBodies& { return each.bodies; }, def);
}

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

/// What joints take at most of anything (joint.h): a body of any size and clips of any speed are within.
float bounded(float value, float most) { return std::clamp(value, -most, most); }
Vec3 bounded(const Vec3& v, float most) { return {bounded(v.x, most), bounded(v.y, most), bounded(v.z, most)}; }
constexpr float kMostTorque = 1e12f, kMostGain = 1e12f, kMostSpeed = 1e5f, kMostFriction = 1e9f;

/// Largest of the angular inertia of a body about a point, at most: that of its centre about the axis that has most.
float inertiaAbout(const MassProperties& mass, const Vec3& arm) {
    const Mat3& i = mass.inertia;
    return std::max({i.cx.x, i.cy.y, i.cz.z}) + mass.mass * lengthSquared(arm);
}

}  // namespace

Muscles::Muscles(World& world, const Ragdoll& ragdoll, const MuscleProfile& profile)
    : world_(&world), ragdoll_(&ragdoll), profile_(profile), from_(profile), to_(profile) {
    requireValid(profile);
    const RagdollDef& def = ragdoll.def();
    float mass = 0;
    for (const RagdollPart& part : def.parts) mass += part.mass;
    muscles_.resize(def.joints.size());
    torque_.resize(def.joints.size());
    inertia_.resize(def.joints.size());
    parentJoint_.assign(def.parts.size(), -1);
    for (std::size_t i = 0; i < def.joints.size(); ++i)
        parentJoint_[static_cast<std::size_t>(def.joints[i].child)] = static_cast<int>(i);
    weigh();
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        muscles_[i].most = strengthOf(def.parts[static_cast<std::size_t>(def.joints[i].child)].role, mass);
        // Of what is no human nothing is known: three times what holds it out straight, by its own size.
        if (!(muscles_[i].most > 0)) muscles_[i].most = 3 * 9.81f * std::sqrt(inertia_[i] * mass);
        muscles_[i].target = turnNow(static_cast<int>(i));
    }
}

Muscles::~Muscles() {
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        const JointId joint = ragdoll_->joints()[i];
        if (!world_->isValid(joint) || !powers(static_cast<int>(i))) continue;
        JointDef limp = ragdoll_->def().joints[i].joint;
        std::visit([&](auto& each) { each.bodies = bodiesOf(world_->def(joint)); }, limp);
        world_->setDef(joint, limp);
    }
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
        const Quat target = normalized(conjugate(a) * (bones[bone(joint.child)].rotation * joined.frameB.rotation));
        muscles_[i].speed = {};
        if (told_ && dt > 0)
            muscles_[i].speed = bounded(rate * rotationVector(target * conjugate(muscles_[i].target)), kMostSpeed);
        muscles_[i].target = target;
    }
    told_ = true;
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
        const float left = muscle.wanted - muscle.share, way = muscle.rate * dt;
        muscle.share = std::abs(left) <= way ? muscle.wanted : muscle.share + (left > 0 ? way : -way);
    }
}

/// Against gravity a joint bears −Σ (cₖ − p) × mₖ g of all parts k beyond it, at p.
void Muscles::weigh() {
    const RagdollDef& def = ragdoll_->def();
    const Vec3 gravity = world_->settings().gravity;
    std::fill(torque_.begin(), torque_.end(), Vec3{});
    std::fill(inertia_.begin(), inertia_.end(), 0.0f);
    for (std::size_t part = 0; part < def.parts.size(); ++part) {
        const BodyId body = ragdoll_->bodies()[part];
        if (!world_->isValid(body)) continue;
        const MassProperties mass = world_->mass(body);
        const DVec3 center = world_->centerOfMass(body);
        const Vec3 weight = world_->gravityScale(body) * mass.mass * gravity;
        for (int joint = parentJoint_[part]; joint >= 0;) {
            const RagdollJoint& at = def.joints[static_cast<std::size_t>(joint)];
            const BodyId carrier = ragdoll_->bodies()[static_cast<std::size_t>(at.parent)];
            if (!world_->isValid(carrier)) break;
            const DVec3 point = transformPoint(world_->pose(carrier), bodiesOf(at.joint).frameA.position);
            const Vec3 arm = relative(center, point);
            torque_[static_cast<std::size_t>(joint)] -= cross(arm, weight);
            inertia_[static_cast<std::size_t>(joint)] += inertiaAbout(mass, arm);
            joint = parentJoint_[static_cast<std::size_t>(at.parent)];
        }
    }
}

/// k = I ω², c = 2 ζ I ω of the inertia I of all beyond the joint.
JointDef Muscles::drive(int joint) const {
    const auto at = static_cast<std::size_t>(joint);
    const RagdollJoint& def = ragdoll_->def().joints[at];
    const Muscle& muscle = muscles_[at];
    const float most = bound(joint), rate = 2 * kPi * profile_.frequency;
    const Pose carrier = world_->pose(ragdoll_->bodies()[static_cast<std::size_t>(def.parent)]);
    const Quat axes = carrier.rotation * bodiesOf(def.joint).frameA.rotation;
    const Vec3 torque = bounded(profile_.weight * inverseRotate(axes, torque_[at]), kMostTorque);
    Spring spring{.stiffness = bounded(inertia_[at] * rate * rate, kMostGain),
                  .damping = bounded(2 * profile_.dampingRatio * inertia_[at] * rate, kMostGain)};
    spring.maxForce = most;
    JointDef result = def.joint;
    if (auto* ball = std::get_if<BallDef>(&result)) {
        ball->friction = bounded(ball->friction * profile_.friction, kMostFriction);
        if (most > 0) {
            ball->spring = spring;
            ball->target = muscle.target;
            ball->targetSpeed = muscle.speed;
            ball->feedForward = torque;
            ball->maxSpringTorque = most;
        }
    } else if (auto* hinge = std::get_if<HingeDef>(&result)) {
        hinge->friction = bounded(hinge->friction * profile_.friction, kMostFriction);
        if (most > 0) {
            spring.speed = muscle.speed.x;
            spring.feedForward = torque.x;
            hinge->spring = spring;
            // The turn of the target about the axis, on the lap that the hinge is on.
            const float now = world_->state(ragdoll_->joints()[at]).coordinate;
            const float angle = 2 * arcTan2(muscle.target.x, muscle.target.w);
            hinge->target = angle + 2 * kPi * std::floor((now - angle) / (2 * kPi) + 0.5f);
        }
    }
    std::visit([&](auto& each) { each.bodies = bodiesOf(world_->def(ragdoll_->joints()[at])); }, result);
    return result;
}

void Muscles::step(double dt) {
    const auto seconds = static_cast<float>(dt);
    if (!(seconds > 0) || !std::isfinite(seconds)) return;
    ease(seconds);
    weigh();
    for (std::size_t i = 0; i < muscles_.size(); ++i) {
        const JointId joint = ragdoll_->joints()[i];
        if (world_->isValid(joint) && powers(static_cast<int>(i))) world_->setDef(joint, drive(static_cast<int>(i)));
    }
}

}  // namespace ragtop
