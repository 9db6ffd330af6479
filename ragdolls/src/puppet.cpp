#include "ragtop/puppet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>

#include "ragtop/world.h"
#include "range_check.h"

namespace ragtop {
namespace {

constexpr float kMassOfHurt = 75;        ///< kg, of the human that `hurt` is for
constexpr float kLeastStrength = 0.05f;  ///< that a blow leaves
constexpr float kNextJoint = 0.5f;       ///< of the loss of a joint, that of the next one
constexpr float kFelt = 0.02f;           ///< loss that is too small to matter
constexpr double kFallen = 0.6;          ///< of the height of who stands, below which it has fallen
constexpr double kMostAir = 0.3;         ///< s, without a foot on the ground, of who does not fall yet
constexpr double kMostOff = 0.1;         ///< s, in which who has lost its balance begins a step or falls
constexpr double kLeastFall = 0.5;       ///< s, before who falls can lie
constexpr float kCrossfade = 0.15f;      ///< s
constexpr float kYield = 0.5f;           ///< s, in which who lies goes limp, and is tense again

}  // namespace

std::string whyInvalid(const PuppetOptions& options) { return whyOutside(options); }

std::string_view nameOf(PuppetState state) {
    constexpr std::array<std::string_view, 5> kNames{"stands", "staggers", "falls", "lies", "gets up"};
    return kNames[static_cast<std::size_t>(state)];
}

Puppet::Puppet(World& world, const Ragdoll& ragdoll, const PuppetOptions& options, const GetUpOptions& help)
    : world_(&world),
      ragdoll_(&ragdoll),
      options_(options),
      dynamics_(world, ragdoll),
      muscles_(world, ragdoll),
      balance_(world, ragdoll, muscles_),
      brace_(world, ragdoll, muscles_),
      getUp_(world, ragdoll, muscles_, balance_, help) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("puppet: " + problem);
    hurt_.resize(ragdoll.def().joints.size());
    loss_.resize(ragdoll.def().parts.size());
    balance_.look();
    height_ = dynamics_.centerOfMass().y - balance_.center().y;
    belong();
}

Puppet::~Puppet() { world_->remove(&module_); }

template <class Self, class Visit>
void Puppet::visitState(Self& self, Visit&& visit) {
    Muscles::visitState(self.muscles_, visit);
    Balance::visitState(self.balance_, visit);
    GetUp::visitState(self.getUp_, visit);
    visit(self.state_);
    visit(self.age_);
    visit(self.air_);
    visit(self.off_);
    for (auto& hurt : self.hurt_) visit(hurt);
    visit(self.assistance_.linear);
    visit(self.assistance_.angular);
}

void Puppet::belong() {
    module_.user = this;
    module_.name = "puppet";
    module_.saveSize = [](const void* user) {
        std::size_t size = 0;
        visitState(*static_cast<const Puppet*>(user), [&](const auto& value) { size += sizeof value; });
        return size;
    };
    module_.save = [](const void* user, std::span<std::byte> into) {
        std::byte* to = into.data();
        visitState(*static_cast<const Puppet*>(user), [&](const auto& value) {
            std::memcpy(to, &value, sizeof value);
            to += sizeof value;
        });
    };
    module_.restore = [](void* user, std::span<const std::byte> from) {
        const std::byte* at = from.data();
        visitState(*static_cast<Puppet*>(user), [&](auto& value) {
            std::memcpy(&value, at, sizeof value);
            at += sizeof value;
        });
    };
    module_.hash = [](const void* user) {
        std::uint64_t hash = 14695981039346656037u;  // [Fowler, Noll, Vo, FNV-1a]
        visitState(*static_cast<const Puppet*>(user), [&](const auto& value) {
            for (const std::byte byte : std::as_bytes(std::span(&value, 1)))
                hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211u;
        });
        return hash;
    };
    world_->add(&module_);
}

void Puppet::enter(PuppetState state) {
    if (state == state_) return;
    const bool upright = state == PuppetState::stands || state == PuppetState::staggers,
               wasUpright = state_ == PuppetState::stands || state_ == PuppetState::staggers;
    if (!(upright && wasUpright)) muscles_.crossfade(kCrossfade);
    if (wasUpright && !upright) balance_.release();
    if (state_ == PuppetState::falls) brace_.release();
    if (state == PuppetState::lies) muscles_.setProfile(muscleProfile("weak"), kYield);
    if (state_ == PuppetState::lies) muscles_.setProfile(muscleProfile("tense"), kYield);
    if (state == PuppetState::getsUp) getUp_.begin();
    state_ = state;
    age_ = off_ = 0;
}

void Puppet::decide() {
    const double height = dynamics_.centerOfMass().y - balance_.center().y;
    const bool low = height < kFallen * height_;
    switch (state_) {
        case PuppetState::stands:
        case PuppetState::staggers:
            if (low || air_ > kMostAir || off_ > kMostOff)
                enter(PuppetState::falls);
            else
                enter(balance_.steps() || (balance_.onFeet() && balance_.margin() < options_.stagger)
                          ? PuppetState::staggers
                          : PuppetState::stands);
            break;
        case PuppetState::falls:
            if (age_ > kLeastFall && length(dynamics_.velocity()) < options_.quiet) enter(PuppetState::lies);
            break;
        case PuppetState::lies:
            if (age_ > static_cast<double>(options_.rest)) enter(PuppetState::getsUp);
            break;
        case PuppetState::getsUp:
            if (getUp_.stands()) enter(low ? PuppetState::falls : PuppetState::stands);
            break;
    }
}

void Puppet::heal() {
    for (std::size_t joint = 0; joint < hurt_.size(); ++joint)
        if (hurt_[joint]) {
            muscles_.setStrength(static_cast<int>(joint), 1, options_.recovery);
            hurt_[joint] = 0;
        }
}

void Puppet::strike(int part, const Vec3& impulse, const DVec3& point) {
    if (!isFinite(impulse) || !isFinite(point))
        throw std::invalid_argument("puppet: a blow of it is not finite, must be finite");
    float& struck = loss_.at(static_cast<std::size_t>(part));
    world_->applyImpulse(ragdoll_->bodies()[static_cast<std::size_t>(part)], impulse, point);
    const RagdollDef& def = ragdoll_->def();
    std::fill(loss_.begin(), loss_.end(), 0.0f);
    struck = std::min(length(impulse) * kMassOfHurt / (options_.hurt * dynamics_.mass()), 1.0f);
    // From part to part, away from the blow and up to the trunk and down again.
    for (std::size_t round = 0; round < def.parts.size(); ++round)
        for (const RagdollJoint& joint : def.joints) {
            float &a = loss_[static_cast<std::size_t>(joint.parent)], &b = loss_[static_cast<std::size_t>(joint.child)];
            a = std::max(a, kNextJoint * b);
            b = std::max(b, kNextJoint * a);
        }
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        const float loss = std::max(loss_[static_cast<std::size_t>(def.joints[i].parent)],
                                    loss_[static_cast<std::size_t>(def.joints[i].child)]);
        if (loss < kFelt) continue;
        const auto index = static_cast<int>(i);
        muscles_.setStrength(index, std::min(muscles_.strength(index), std::max(1 - loss, kLeastStrength)), 0);
        hurt_[i] = 1;
    }
}

void Puppet::step(double dt) {
    if (!(dt > 0) || !std::isfinite(dt)) return;
    dynamics_.look();
    balance_.look(dynamics_);
    age_ += dt;
    air_ = balance_.onFeet() ? 0 : air_ + dt;
    off_ = balance_.onFeet() && balance_.margin() < -options_.lost ? off_ + dt : 0;
    decide();
    heal();
    assistance_ = {};
    switch (state_) {
        case PuppetState::stands:
        case PuppetState::staggers:
            balance_.step(dt, dynamics_);
            break;
        case PuppetState::falls:
            brace_.step();
            break;
        case PuppetState::lies:
            break;
        case PuppetState::getsUp:
            getUp_.step(dt);
            assistance_ = getUp_.assistance();
            break;
    }
    muscles_.step(dt, dynamics_);
}

}  // namespace ragtop
