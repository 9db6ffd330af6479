#include "ragtop/brace.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "arm.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr float kSpread = 0.3f;       ///< of the way that the arms reach, to the sides
constexpr float kElbow = 0.35f;       ///< rad, so that arms give way
constexpr float kGiving = 0.6f;       ///< rad, by which arms that bear all that they can have given way
constexpr float kGivingTime = 0.08f;  ///< s, of damping over stiffness
constexpr float kChin = 0.7f, kKnees = 0.9f, kHips = 0.5f, kCurl = 0.25f;  ///< rad

}  // namespace

Brace::Brace(World& world, const Ragdoll& ragdoll, Muscles& muscles)
    : world_(&world), ragdoll_(&ragdoll), muscles_(&muscles), axes_(ragdoll.def()), dynamics_(world, ragdoll) {
    chest_ = axes_.find(BodyRole::chest, BodySide::middle);
    if (chest_ < 0 || axes_.find(BodyRole::upperArm, BodySide::left) < 0 ||
        axes_.find(BodyRole::upperArm, BodySide::right) < 0)
        throw std::invalid_argument("brace: needs a chest and an arm on either side");
    const RagdollDef& def = ragdoll.def();
    turns_.resize(def.joints.size());
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        const BodyRole role = def.parts[static_cast<std::size_t>(def.joints[i].child)].role;
        if (role == BodyRole::upperArm || role == BodyRole::forearm || role == BodyRole::hand)
            joints_.push_back(static_cast<int>(i));
    }
}

/// The ground comes from where the chest moves to and from below.
void Brace::step() {
    dynamics_.look();
    const InverseDynamics::Part& chest = dynamics_.parts()[static_cast<std::size_t>(chest_)];
    const Quat axes = axes_.axesOf(chest_, chest.rotation);
    const Vec3 level = normalized(Vec3{chest.velocity.x, 0, chest.velocity.z}, {0, 0, 0});
    const Vec3 way = normalized(inverseRotate(axes, level + Vec3{0, -1, 0}), {0, -1, 0});
    const float ahead = inverseRotate(axes, normalized(level + Vec3{0, -0.3f, 0}, {0, -1, 0})).z;
    const PartAngles pose[] = {
        pointing(BodySide::left, normalized(way + Vec3{kSpread, 0, 0})),
        pointing(BodySide::right, normalized(way - Vec3{kSpread, 0, 0})),
        {BodyRole::forearm, BodySide::left, kElbow},
        {BodyRole::forearm, BodySide::right, kElbow},
        {BodyRole::head, BodySide::middle, -kChin * ahead},
        {BodyRole::chest, BodySide::middle, -kCurl * ahead},
        {BodyRole::abdomen, BodySide::middle, -kCurl * ahead},
        {BodyRole::thigh, BodySide::left, kHips},
        {BodyRole::thigh, BodySide::right, kHips},
        {BodyRole::shank, BodySide::left, kKnees},
        {BodyRole::shank, BodySide::right, kKnees},
    };
    turnsOf(axes_, pose, turns_);
    for (std::size_t joint = 0; joint < turns_.size(); ++joint) {
        muscles_->setTarget(static_cast<int>(joint), turns_[joint]);
        muscles_->setGains(static_cast<int>(joint), {});
    }
    for (const int joint : joints_) {
        const float stiffness = muscles_->bound(joint) / kGiving;
        muscles_->setGains(joint, MuscleGains{stiffness, kGivingTime * stiffness});
    }
}

void Brace::release() {
    for (const int joint : joints_) muscles_->setGains(joint, {});
}

}  // namespace ragtop
