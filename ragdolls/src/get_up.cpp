#include "ragtop/get_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "arm.h"
#include "inertia.h"
#include "leg.h"
#include "ragtop/world.h"
#include "range_check.h"

namespace ragtop {
namespace {

constexpr Vec3 kUp{0, 1, 0}, kForward{0, 0, 1};

/// Legs under a trunk that leans forwards, elbows nearly straight. Joints that do not go as far go as far as they do.
constexpr std::array<PartAngles, 10> kFolded{{{BodyRole::forearm, BodySide::left, 0.3f},
                                              {BodyRole::forearm, BodySide::right, 0.3f},
                                              {BodyRole::chest, BodySide::middle, 0.2f},
                                              {BodyRole::abdomen, BodySide::middle, 0.2f},
                                              {BodyRole::thigh, BodySide::left, 1.9f, 0.15f},
                                              {BodyRole::thigh, BodySide::right, 1.9f, 0.15f},
                                              {BodyRole::shank, BodySide::left, 2.2f},
                                              {BodyRole::shank, BodySide::right, 2.2f},
                                              {BodyRole::foot, BodySide::left, 0.3f},
                                              {BodyRole::foot, BodySide::right, 0.3f}}};
constexpr float kArmsApart = 0.3f, kArmsAhead = 0.2f;  ///< of the way that arms reach down
constexpr float kGiving = 0.5f;                        ///< rad, by which joints give way under all that they bear
constexpr float kGivingTime = 0.1f;                    ///< s, of damping over stiffness, at most
constexpr float kLean = 0.5f;                          ///< rad, of the trunk while legs are folded
constexpr float kSquat = 0.5f;                         ///< of the length of the legs, by which hips are lower
constexpr float kRate = 6;  ///< 1/s, at which assistance, critically damped, would bring the body where it is to be
constexpr float kStepShare = 0.3f;  ///< of a step, that this may be at most
constexpr float kLift = 0.3f;       ///< of the weight, of the assistance
constexpr float kTurned = 0.75f;    ///< cosine, of the pelvis, from which it squats
constexpr float kNear = 0.36f;      ///< of the length of the legs, from the centre of mass to over the feet
constexpr float kPull = 0.2f;       ///< sine of the pelvis' slope from which it is drawn to its feet
constexpr float kLeastFold = 0.5f, kLeastSquat = 0.2f, kMostSquat = 1.2f;  ///< s
constexpr float kSafe = 0.03f;       ///< m, of the capture point within the feet, from which it rises
constexpr float kBegin = 0.3f;       ///< s, in which assistance begins
constexpr float kEnd = 0.2f;         ///< of the time of rising, by which assistance outlasts it
constexpr float kCrossfade = 0.25f;  ///< s, between phases

Vec3 level(const Vec3& v) { return {v.x, 0, v.z}; }

}  // namespace

std::string whyInvalid(const GetUpOptions& options) { return whyOutside(options); }

GetUp::GetUp(World& world, const Ragdoll& ragdoll, Muscles& muscles, Balance& balance, const GetUpOptions& options)
    : world_(&world),
      ragdoll_(&ragdoll),
      muscles_(&muscles),
      balance_(&balance),
      options_(options),
      standing_(balance.options()),
      axes_(ragdoll.def()),
      dynamics_(world, ragdoll) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("get up: " + problem);
    pelvis_ = axes_.find(BodyRole::pelvis, BodySide::middle);
    chest_ = axes_.find(BodyRole::chest, BodySide::middle);
    const auto leg = legOf(axes_, BodySide::left);
    if (!leg || chest_ < 0) throw std::invalid_argument("get up: needs a chest and legs of three parts");
    legs_ = leg->length;
    turns_.resize(ragdoll.def().joints.size());
}

void GetUp::enter(GetUpPhase phase) {
    phase_ = phase;
    age_ = 0;
    muscles_->crossfade(kCrossfade);
}

void GetUp::begin() {
    balance_->release();
    enter(GetUpPhase::fold);
}

Vec3 GetUp::up() const {
    return rotate(axes_.axesOf(pelvis_, dynamics_.parts()[static_cast<std::size_t>(pelvis_)].rotation), kUp);
}

void GetUp::advance() {
    const float away = length(level(relative(balance_->center(), dynamics_.centerOfMass())));
    const bool over = up().y > kTurned && away < kNear * legs_;
    if (phase_ == GetUpPhase::fold && ((age_ > kLeastFold && over) || age_ > options_.turning)) {
        for (std::size_t joint = 0; joint < turns_.size(); ++joint) muscles_->setGains(static_cast<int>(joint), {});
        enter(GetUpPhase::squat);
    }
    if (phase_ == GetUpPhase::squat && ((age_ > kLeastSquat && balance_->margin() > kSafe) || age_ > kMostSquat))
        enter(GetUpPhase::rise);
    if (phase_ == GetUpPhase::rise && age_ > (1 + kEnd) * options_.rising) enter(GetUpPhase::stand);
}

/// Arms push where the ground is, whichever way the body lies.
void GetUp::fold() {
    const Quat axes = axes_.axesOf(chest_, dynamics_.parts()[static_cast<std::size_t>(chest_)].rotation);
    const Vec3 down = inverseRotate(axes, -kUp) + kArmsAhead * kForward;
    std::array<PartAngles, kFolded.size() + 2> pose{};
    std::copy(kFolded.begin(), kFolded.end(), pose.begin());
    pose[kFolded.size()] = pointing(BodySide::left, normalized(down + Vec3{kArmsApart, 0, 0}));
    pose[kFolded.size() + 1] = pointing(BodySide::right, normalized(down - Vec3{kArmsApart, 0, 0}));
    turnsOf(axes_, pose, turns_);
    for (std::size_t i = 0; i < turns_.size(); ++i) {
        const auto joint = static_cast<int>(i);
        const float stiffness = muscles_->bound(joint) / kGiving;
        const float critical = 2 * std::sqrt(stiffness * dynamics_.inertiaBeyond(joint));
        muscles_->setTarget(joint, turns_[i]);
        muscles_->setGains(joint, MuscleGains{stiffness, std::min(kGivingTime * stiffness, critical)});
    }
}

void GetUp::rise() {
    BalanceOptions options = standing_;
    if (phase_ != GetUpPhase::stand) {
        const float s = phase_ == GetUpPhase::rise ? std::min(age_ / options_.rising, 1.0f) : 0.0f;
        options.crouch = std::max(kSquat + s * s * (3 - 2 * s) * (standing_.crouch - kSquat), standing_.crouch);
        // What bears it beside the ground would teach it to lean wrongly, and feet are where it rises from.
        options.learning = 0;
        options.step = 0;
    }
    balance_->setOptions(options);
}

/// Of the bounds of the assistance.
float GetUp::share() const {
    if (phase_ == GetUpPhase::fold) return std::min(age_ / kBegin, 1.0f);
    if (phase_ == GetUpPhase::rise) return std::clamp(1 + kEnd - age_ / options_.rising, 0.0f, 1.0f);
    return phase_ == GetUpPhase::squat ? 1.0f : 0.0f;
}

/// The trunk upright by the shortest way, so that who lies on the back sits up and who lies on the belly kneels; the
/// centre of mass over the feet.
void GetUp::assist(float dt) {
    const InverseDynamics::Part& pelvis = dynamics_.parts()[static_cast<std::size_t>(pelvis_)];
    const Vec3 upwards = up();
    const Vec3 ahead = rotate(axes_.axesOf(pelvis_, pelvis.rotation), kForward);
    const Vec3 heading = normalized(level(rotate(rotationBetween(upwards, kUp), ahead)), kForward);
    const bool folds = phase_ == GetUpPhase::fold;
    const SinCos lean = sinCos(folds ? kLean : 0.0f);
    const Vec3 error = rotationVector(rotationBetween(upwards, lean.cos * kUp + lean.sin * heading));
    const float rate = std::min(kRate, kStepShare / dt), square = rate * rate;
    const float pull = folds ? std::clamp(upwards.y + kPull, 0.0f, 1.0f) : 1.0f;
    const float lift = folds || phase_ == GetUpPhase::squat ? kLift : share() * kLift;
    const Vec3 way = level(relative(balance_->center(), dynamics_.centerOfMass()));
    push(pull * square * way - 2 * rate * level(dynamics_.velocity()) - lift * world_->settings().gravity,
         square * error - 2 * rate * pelvis.spin);
}

/// As if the body were rigid.
void GetUp::push(Vec3 linear, Vec3 angular) {
    const DVec3 center = dynamics_.centerOfMass();
    Mat3 inertia{{}, {}, {}};
    for (const InverseDynamics::Part& part : dynamics_.parts())
        if (part.exists) inertia = inertia + part.inertia + steiner(part.mass, relative(part.center, center));
    const float weight = dynamics_.mass() * length(world_->settings().gravity);
    const auto bounded = [&](const Vec3& v, float size, float most) { return size > most ? (most / size) * v : v; };
    linear = bounded(linear, dynamics_.mass() * length(linear), share() * options_.force * weight);
    angular = bounded(angular, length(inertia * angular), share() * options_.torque * weight * legs_);
    assistance_ = {dynamics_.mass() * linear, inertia * angular};
    for (std::size_t i = 0; i < dynamics_.parts().size(); ++i) {
        const InverseDynamics::Part& part = dynamics_.parts()[i];
        if (!part.exists) continue;
        const Vec3 local = linear + cross(angular, relative(part.center, center));
        world_->applyForce(ragdoll_->bodies()[i], part.mass * local, part.center);
        world_->applyTorque(ragdoll_->bodies()[i], part.inertia * angular);
    }
}

void GetUp::step(double dt) {
    const auto seconds = static_cast<float>(dt);
    if (!(seconds > 0) || !std::isfinite(seconds)) return;
    dynamics_.look();
    age_ += seconds;
    advance();
    if (phase_ == GetUpPhase::fold) {
        balance_->look();
        fold();
    } else {
        rise();
        balance_->step(dt);
    }
    assistance_ = {};
    if (!stands()) assist(seconds);
}

}  // namespace ragtop
