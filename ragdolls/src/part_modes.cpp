#include "ragtop/part_modes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "point_joint.h"
#include "ragtop/world.h"
#include "range_check.h"

namespace ragtop {
namespace {

bool isPose(const Pose& pose) { return isFinite(pose.position) && isRotation(pose.rotation); }

Quat turned(const Vec3& turn, const Quat& rotation) { return normalized(rotationAbout(turn, length(turn)) * rotation); }

/// Rate of the rotation vector r of a rotation that turns at ω, in world axes [Bullo and Murray, 1995]:
///   ṙ = ω − ½ r × ω + (1 − ½ θ cot ½θ)/θ² r × (r × ω),  θ = |r|
Vec3 rateOf(const Quat& rotation, const Vec3& spin) {
    const Vec3 turn = rotationVector(rotation);
    const float square = lengthSquared(turn);
    const float sine = length(Vec3{rotation.x, rotation.y, rotation.z}), angle = std::sqrt(square);
    const float share = angle > 1e-2f ? (1 - 0.5f * angle * std::abs(rotation.w) / sine) / square : 1.0f / 12;
    return spin - 0.5f * cross(turn, spin) + share * cross(turn, cross(turn, spin));
}

}  // namespace

std::string_view nameOf(PartMode mode) {
    switch (mode) {
        case PartMode::kinematic:
            return "kinematic";
        case PartMode::powered:
            return "powered";
        case PartMode::limp:
            return "limp";
    }
    return "";
}

std::string whyInvalid(const PartState& state) {
    if (nameOf(state.mode).empty())
        return "mode is " + std::to_string(static_cast<int>(state.mode)) + ", must be kinematic, powered or limp";
    return whyOutside(state);
}

PartModes::PartModes(World& world, const Ragdoll& ragdoll, Muscles& muscles)
    : world_(&world), ragdoll_(&ragdoll), muscles_(&muscles) {
    const RagdollDef& def = ragdoll.def();
    parts_.resize(def.parts.size());
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        for (std::size_t j = 0; j < def.joints.size(); ++j)
            if (def.joints[j].child == static_cast<int>(i)) parts_[i].joint = static_cast<int>(j);
        if (const auto held = pointJointOf(def, static_cast<int>(i))) {
            parts_[i].parent = held->parent;
            parts_[i].inParent = held->inParent;
            parts_[i].inPart = held->inChild;
        }
    }
    before_.resize(parts_.size());
    now_.resize(parts_.size());
    goals_.resize(parts_.size());
    shares_.assign(def.bones.size(), 1.0f);
}

void PartModes::set(int index, const PartState& state, float seconds) {
    Part& part = parts_.at(static_cast<std::size_t>(index));
    if (const std::string problem = whyInvalid(state); !problem.empty())
        throw std::invalid_argument("part modes: " + problem);
    if (!(seconds >= 0) || !std::isfinite(seconds))
        throw std::invalid_argument("part modes: seconds is " + std::to_string(seconds) +
                                    ", must be at least 0 and finite");
    const bool leads = state.mode == PartMode::kinematic;
    const bool changes = leads != (part.state.mode == PartMode::kinematic);
    world_->setType(ragdoll_->bodies()[static_cast<std::size_t>(index)],
                    leads ? BodyType::kinematic : BodyType::dynamic);
    if (part.joint >= 0) muscles_->setStrength(part.joint, state.mode == PartMode::limp ? 0 : state.strength, seconds);
    part.rate = seconds > 0 ? std::abs(state.physics - part.share) / seconds : 0;
    if (!(seconds > 0)) part.share = state.physics;
    part.state = state;
    if (!changes) return;
    part.begins = leads;
    part.approach = {};
    part.approach.time = seconds;
    // What hung on a part that has left was where that had it.
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (parts_[i].parent != index || parts_[i].state.mode != PartMode::kinematic) continue;
        parts_[i].begins = true;
        parts_[i].approach = part.approach;
    }
}

void PartModes::setBranch(int part, const PartState& state, float seconds) {
    set(part, state, seconds);
    const std::vector<RagdollJoint>& joints = ragdoll_->def().joints;
    for (const RagdollJoint& joint : joints)
        if (joint.parent == part) setBranch(joint.child, state, seconds);
}

/// The difference to the goal and its rate, from which the approach begins.
void PartModes::begin(std::size_t index, const Pose& goal, const Vec3& velocity, const Vec3& spin) {
    const BodyId body = ragdoll_->bodies()[index];
    const Pose pose = world_->pose(body);
    Approach& approach = parts_[index].approach;
    approach.place = relative(pose.position, goal.position);
    const Quat beyond = pose.rotation * conjugate(goal.rotation);
    approach.turn = rotationVector(beyond);
    approach.placeRate = world_->velocityAt(body, pose.position) - velocity;
    approach.turnRate = rateOf(beyond, world_->angularVelocity(body) - rotate(beyond, spin));
    parts_[index].begins = false;
}

/// d(s) = (1 − 3 s² + 2 s³) d₀ + T (s − 2 s² + s³) ḋ₀ for s = t/T.
Pose PartModes::approached(std::size_t index, const Pose& goal) {
    const Approach& approach = parts_[index].approach;
    if (approach.age >= approach.time) return goal;
    const float s = approach.age / approach.time, rest = 1 - s;
    const float place = rest * rest * (1 + 2 * s), rate = approach.time * s * rest * rest;
    const Vec3 turn = place * approach.turn + rate * approach.turnRate;
    return {goal.position + DVec3{place * approach.place + rate * approach.placeRate}, turned(turn, goal.rotation)};
}

void PartModes::follow(std::span<const Pose> bones, double dt) {
    const RagdollDef& def = ragdoll_->def();
    if (!(dt > 0) || !std::isfinite(dt))
        throw std::invalid_argument("part modes: dt is " + std::to_string(dt) + " s, must be above zero and finite");
    for (std::size_t i = 0; i < bones.size() && i < def.bones.size(); ++i)
        if (!isPose(bones[i]))
            throw std::invalid_argument("part modes: the pose of bone " + std::to_string(i) + " (" + def.bones[i].name +
                                        ") is not finite or its rotation has not length 1");
    muscles_->follow(bones, told_ ? dt : 0);
    std::swap(before_, now_);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        now_[i] = bones[static_cast<std::size_t>(def.parts[i].bone)];
        if (parts_[i].parent >= 0)
            now_[i].position = transformPoint(now_[static_cast<std::size_t>(parts_[i].parent)], parts_[i].inParent) -
                               rotate(now_[i].rotation, parts_[i].inPart);
    }
    if (!told_) before_ = now_;
    told_ = true;
    move(dt);
    const auto seconds = static_cast<float>(dt);
    for (Part& part : parts_) {
        const float left = part.state.physics - part.share, way = part.rate * seconds;
        part.share =
            std::abs(left) <= way || part.rate == 0 ? part.state.physics : part.share + (left > 0 ? way : -way);
    }
    for (std::size_t i = 0; i < shares_.size(); ++i)
        shares_[i] = parts_[static_cast<std::size_t>(def.bones[i].part)].share;
}

/// Kinematic parts go where the animation has them, or nearer; those that hang on one stay joined to it.
void PartModes::move(double dt) {
    const auto rate = static_cast<float>(1 / dt);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        Part& part = parts_[i];
        if (part.state.mode != PartMode::kinematic) continue;
        if (part.begins)
            begin(i, before_[i], rate * relative(now_[i].position, before_[i].position),
                  rate * rotationVector(now_[i].rotation * conjugate(before_[i].rotation)));
        part.approach.age = std::min(part.approach.age + static_cast<float>(dt), part.approach.time);
        goals_[i] = approached(i, now_[i]);
        const auto parent = static_cast<std::size_t>(std::max(part.parent, 0));
        if (part.parent >= 0 && parts_[parent].state.mode == PartMode::kinematic)
            goals_[i].position =
                transformPoint(goals_[parent], part.inParent) - rotate(goals_[i].rotation, part.inPart);
        world_->moveTo(ragdoll_->bodies()[i], goals_[i], dt);
    }
}

}  // namespace ragtop
