#include "ragtop/balance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "arm.h"
#include "balance_stand.h"
#include "leg.h"
#include "ragtop/world.h"
#include "range_check.h"
#include "support.h"

namespace ragtop {
namespace {

constexpr Vec3 kUp{0, 1, 0};
constexpr float kPlanted = 0.02f;         ///< of the weight, that a foot bears at least which stands
constexpr float kUpright = 0.56f;         ///< stiffness of knees and hips over weight times height
constexpr float kUprightDamping = 0.28f;  ///< of knees and hips, over that by the rate of toppling
constexpr float kRising = 1;              ///< 1/s, of the length of the legs, at which hips rise at most
constexpr float kSinking = 0.3f;          ///< 1/s, of the length of the legs, at which hips sink also then
constexpr float kGently = 0.4f;           ///< of gravity, by which that speed changes at most
constexpr float kCalmSpeed = 0.05f;  ///< of the length of the legs times √(g/z), at which they rise at half of that
constexpr float kShift = 0.04f;      ///< of the length of the legs, that hips are aimed at most beside where they are
constexpr float kLifted = 0.04f;     ///< of the length of legs, up to which a foot counts as if it stood
constexpr float kAnkle = 0.42f, kAnkleDamping = 0.14f;
constexpr float kMostLean = 0.16f;  ///< of the length of the legs
constexpr float kCalm = 0.01f;      ///< m, of what is left to fall, at which learning goes at half its rate
constexpr float kThighMoves = 0.3f, kShankMoves = 0.75f;  ///< of what a foot that steps moves by
constexpr float kNoticed = 0.1f;                          ///< s, within which it is noticed that the ground gains speed
constexpr float kFollow = 0.5f;  ///< share of a step by which the normal of the ground follows that of contacts

/// How the arms of who balances are held: apart from thighs and trunk, which they would rub on; farther where those are
/// wide.
constexpr std::array<PartAngles, 4> kArms{{{BodyRole::upperArm, BodySide::left, 0.05f},
                                           {BodyRole::upperArm, BodySide::right, 0.05f},
                                           {BodyRole::forearm, BodySide::left, 0.25f},
                                           {BodyRole::forearm, BodySide::right, 0.25f}}};
constexpr float kArmsApart = 0.3f;  ///< rad, at least
constexpr float kArmsGap = 0.01f;   ///< of the length of the legs, between arms and what they would rub on

}  // namespace

std::string whyInvalid(const BalanceOptions& options) { return whyOutside(options); }

Balance::Balance(World& world, const Ragdoll& ragdoll, Muscles& muscles, const BalanceOptions& options)
    : world_(&world),
      ragdoll_(&ragdoll),
      muscles_(&muscles),
      options_(options),
      axes_(ragdoll.def()),
      dynamics_(world, ragdoll) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("balance: " + problem);
    pelvis_ = axes_.find(BodyRole::pelvis, BodySide::middle);
    for (const BodySide side : {BodySide::left, BodySide::right}) {
        const auto leg = legOf(axes_, side);
        if (!leg)
            throw std::invalid_argument("balance: the " + std::string(nameOf(side)) +
                                        " leg is not a thigh on the pelvis, a shank on a hinge and a foot");
        soles_.push_back(soleOf(axes_, leg->foot));
        legs_.push_back(*leg);
    }
    stance_.resize(ragdoll.def().joints.size());
    accelerations_.resize(ragdoll.def().parts.size());
    outside_.resize(ragdoll.def().parts.size());
    std::array<PartAngles, kArms.size()> arms = kArms;
    const float apart = armsApart(axes_, arms, kArmsApart, kArmsGap * legs_[0].length);
    for (PartAngles& each : arms)
        if (each.role == BodyRole::upperArm) each.abduction = apart;
    turnsOf(axes_, arms, stance_);
}

Balance::~Balance() = default;

void Balance::release() {
    for (const Leg& leg : legs_)
        for (const int joint : {leg.hip, leg.knee, leg.ankle}) muscles_->setGains(joint, {});
    lean_ = quickening_ = {};
    height_ = rise_ = 0;
    swing_ = {};
}

void Balance::setOptions(const BalanceOptions& options) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("balance: " + problem);
    options_ = options;
}

/// What the ground does to a foot.
void Balance::feel(std::size_t side) {
    Foot& foot = feet_[side];
    const BodyId body = ragdoll_->bodies()[static_cast<std::size_t>(legs_[side].foot)];
    const bool stood = foot.planted;
    foot.load = 0;
    struct Felt {
        Vec3 normal, ground;
        DVec3 pressure;
        float load = 0;
    } felt;
    const auto touch = [&](const Contact& contact) {
        const BodyId other = contact.bodyA == body ? contact.bodyB : contact.bodyA;
        const std::span<const BodyId> own = ragdoll_->bodies();
        float impulses = 0;
        for (int i = 0; i < contact.pointCount; ++i) impulses += contact.points[i].impulse;
        if (!(contact.normalForce > 0 && impulses > 0) || std::find(own.begin(), own.end(), other) != own.end()) return;
        for (int i = 0; i < contact.pointCount; ++i) {
            const float force = contact.normalForce * contact.points[i].impulse / impulses;
            felt.pressure = felt.pressure + static_cast<double>(force) * contact.points[i].point;
            felt.ground += force * world_->velocityAt(other, contact.points[i].point);
        }
        felt.normal += contact.normalForce * (contact.bodyA == body ? -contact.normal : contact.normal);
        felt.load += contact.normalForce;
    };
    world_->forEachContact(body, std::cref(touch));
    foot.load = felt.load;
    foot.planted = felt.load > kPlanted * dynamics_.mass() * length(world_->settings().gravity);
    foot.gained = {};
    if (foot.planted) {
        foot.pressure = (1.0 / static_cast<double>(felt.load)) * felt.pressure;
        const Vec3 ground = (1 / felt.load) * felt.ground;
        if (stood) foot.gained = ground - foot.ground;
        foot.ground = ground;
        foot.normal = normalized(foot.normal + kFollow * normalized(felt.normal, kUp), kUp);
    }
    const Pose pose = world_->pose(body);
    foot.middle = transformPoint(pose, soles_[side].middle);
    const Vec3 up = rotate(pose.rotation, soles_[side].up);
    foot.flat = normalized(rotationBetween(up, foot.normal) * pose.rotation);
}

void Balance::feel() {
    for (std::size_t side = 0; side < 2; ++side) feel(side);
    for (std::size_t side = 0; side < 2; ++side) {
        Foot &foot = feet_[side], &other = feet_[1 - side];
        foot.height = 0;
        if (foot.planted || !other.planted) continue;
        foot.height = dot(relative(foot.middle, other.middle), other.normal);
        foot.normal = other.normal;
        foot.ground = other.ground;
    }
}

Balance::Stand Balance::survey() const {
    Stand stand;
    const float load = feet_[0].load + feet_[1].load;
    const float share = load > 0 ? feet_[0].load / load : 0.5f;
    const auto mean = [&](const Vec3& a, const Vec3& b) { return share * a + (1 - share) * b; };
    stand.center = feet_[0].middle + 0.5f * relative(feet_[1].middle, feet_[0].middle);
    stand.mass = relative(dynamics_.centerOfMass(), stand.center);
    stand.speed = dynamics_.velocity() - mean(feet_[0].ground, feet_[1].ground);
    stand.both = feet_[0].planted && feet_[1].planted;
    if (onFeet())
        stand.pressure =
            level(mean(relative(feet_[0].pressure, stand.center), relative(feet_[1].pressure, stand.center)));
    stand.gravity = length(world_->settings().gravity);
    stand.height = std::max(stand.mass.y, 0.1f * legs_[0].length);
    stand.rate = std::sqrt(stand.gravity / stand.height);
    stand.ahead = (1 / (stand.rate * stand.rate)) * quickening_;
    const float most = kMostLean * legs_[0].length, ahead = length(stand.ahead);
    if (ahead > most) stand.ahead = (most / ahead) * stand.ahead;
    stand.capture = level(stand.mass + (1 / stand.rate) * stand.speed) - stand.ahead;
    return stand;
}

/// How what the feet stand on gains speed, which weighs like a slope: c̈ = ω² (c − p) − a of who is carried along.
void Balance::quicken(float dt) {
    Vec3 gained;
    float load = 0;
    for (const Foot& foot : feet_) {
        gained += foot.load * foot.gained;
        load += foot.load;
    }
    if (!(load > 0)) return;
    quickening_ += std::min(dt / kNoticed, 1.0f) * ((1 / (dt * load)) * level(gained) - quickening_);
}

/// The centre of pressure of who is at rest is under the middle of the feet, whatever it takes to have it there. What
/// moves tells little of that.
void Balance::learn(const Stand& stand, float dt) {
    if (!stand.both) return;
    const float unrest = length(level(stand.speed)) / (kCalm * stand.rate);
    lean_ -= (options_.learning * dt / (1 + unrest * unrest)) * stand.pressure;
    const float most = kMostLean * legs_[0].length, size = length(lean_);
    if (size > most) lean_ = (most / size) * lean_;
}

void Balance::measure(const Stand& stand) {
    center_ = stand.center;
    capture_ = stand.center + stand.capture;
    margin_ = marginOf(stand.capture);
}

/// A foot that hardly left the ground counts, as it is on its way down.
bool Balance::isNear(std::size_t side) const {
    if (feet_[side].planted) return true;
    if (swings(side)) return false;
    return feet_[1 - side].planted && std::abs(feet_[side].height) < kLifted * legs_[0].length;
}

/// Of a point relative to the middle of the feet.
float Balance::marginOf(const Vec3& point) const {
    std::array<Spot, 8> corners{};
    std::size_t count = 0;
    for (std::size_t side = 0; side < 2; ++side) {
        if (!isNear(side) && !swings(side)) continue;
        const DVec3& middle = swings(side) ? swing_.to : feet_[side].middle;
        for (const Vec3& corner : soles_[side].corners) {
            const Vec3 at = relative(middle, center_) + rotate(feet_[side].flat, corner - soles_[side].middle);
            corners[count++] = {at.x, at.z};
        }
    }
    return marginWithin({corners.data(), count}, {point.x, point.z});
}

float Balance::reach(const Vec3& direction) const {
    constexpr int kHalvings = 20;
    const Vec3 along = normalized(level(direction), {0, 0, 1}),
               from = level(relative(dynamics_.centerOfMass(), center_));
    float inside = 0, outside = 2 * legs_[0].length;
    for (int i = 0; i < kHalvings; ++i) {
        const float middle = 0.5f * (inside + outside);
        (marginOf(from + middle * along) > 0 ? inside : outside) = middle;
    }
    return inside;
}

/// Hips are level, headed as the feet are on average, and where they carry the centre of mass over the point that was
/// learnt. Springs only hold legs in shape: what bears is fed forward, as no spring of a foot of a kilogram can be as
/// stiff as a body is heavy.
void Balance::bend(const Stand& stand, float dt) {
    const RagdollDef& def = ragdoll_->def();
    Vec3 forward;
    for (std::size_t side = 0; side < 2; ++side)
        forward += level(rotate(axes_.axesOf(legs_[side].foot, feet_[side].flat), {0, 0, 1}));
    forward = normalized(forward, {0, 0, 1});
    const Quat turn = normalized(rotationFromAxes(cross(kUp, forward), kUp, forward) * axes_.zero(pelvis_));
    const Vec3 middle = 0.5f * (legs_[0].hipInPelvis + legs_[1].hipInPelvis);
    const Pose pelvis = world_->pose(ragdoll_->bodies()[static_cast<std::size_t>(pelvis_)]);
    // Who steps leaves the hips where they are carried, and puts the foot where it is to be in the world.
    Vec3 hips = level(relative(transformPoint(pelvis, middle), stand.center));
    if (!steps()) {
        const Vec3 way = lean_ + stand.ahead - level(stand.mass);
        const float far = length(way), shift = (options_.step > 0 ? kShift : 1) * legs_[0].length;
        hips += (far > shift ? shift / far : 1.0f) * way;
    }
    std::array<Vec3, 2> ankles{}, offsets{};
    float height = 2 * legs_[0].length;
    for (std::size_t side = 0; side < 2; ++side) {
        const Leg& leg = legs_[side];
        ankles[side] = relative(swings(side) ? swing_.to : feet_[side].middle, stand.center) +
                       rotate(feet_[side].flat, leg.ankleInFoot - soles_[side].middle);
        offsets[side] = rotate(turn, leg.hipInPelvis - middle);
        if (!swings(side)) ankles[side] -= feet_[side].height * feet_[side].normal;
        const Vec3 to = ankles[side] - offsets[side] - hips;
        const float most = (1 - options_.crouch) * leg.length, across = lengthSquared(level(to));
        height = std::min(height, to.y + std::sqrt(std::max(most * most - across, 0.0f)));
    }
    // Knees bend and stretch no faster than those of who gets up, and their targets move as fast as that.
    const float before = height_ > 0 ? height_ : relative(transformPoint(pelvis, middle), stand.center).y;
    // Who moves over the ground would leave it.
    const float hurry =
        (options_.step > 0 ? 1.0f : 0.0f) * length(level(stand.speed)) / (kCalmSpeed * legs_[0].length * stand.rate);
    const float most = kRising * legs_[0].length / (1 + hurry * hurry);
    const float least = std::max(most, kSinking * legs_[0].length);
    // They begin and end that as gently as feet stay on the ground.
    const float gently = kGently * stand.gravity, left = height - before;
    const float wanted = std::copysign(std::min(std::sqrt(2 * gently * std::abs(left)), std::abs(left) / dt), left);
    rise_ += std::clamp(std::clamp(wanted, -least, most) - rise_, -gently * dt, gently * dt);
    const Vec3 rising{0, rise_ * dt, 0};
    height_ = before + rising.y;
    hips.y = height_;
    const float toppling = dynamics_.mass() * stand.gravity * stand.height;
    const MuscleGains upright{kUpright * toppling, kUprightDamping * toppling / stand.rate},
        ankle{kAnkle * toppling, kAnkleDamping * toppling / stand.rate};
    for (std::size_t joint = 0; joint < stance_.size(); ++joint)
        muscles_->setTarget(static_cast<int>(joint), stance_[joint]);
    for (std::size_t side = 0; side < 2; ++side) {
        const Leg& leg = legs_[side];
        Vec3 hip = hips + offsets[side], from = hip - rising, was = ankles[side];
        Quat carrier = turn;
        if (swings(side)) {
            hip = from = relative(transformPoint(pelvis, leg.hipInPelvis), stand.center);
            carrier = pelvis.rotation;
            const Vec3 inFoot = ankles[side] - relative(swing_.to, stand.center);
            was = swungTo(stand, swing_.age - dt) + inFoot;
            ankles[side] = swungTo(stand, swing_.age) + inFoot;
        }
        const Leg::Bent bent = leg.reach(axes_, carrier, hip, feet_[side].flat, ankles[side]),
                        below = leg.reach(axes_, carrier, from, feet_[side].flat, was);
        const auto set = [&](int joint, const Quat& parent, const Quat& child, const Quat& last,
                             const MuscleGains& gains) {
            const Quat target = turnOf(def.joints[static_cast<std::size_t>(joint)], parent, child);
            muscles_->setTarget(joint, target, (1 / dt) * rotationVector(target * conjugate(last)));
            // What swings is light, and gives way where it lands.
            muscles_->setGains(joint, swings(side) ? std::nullopt : std::optional(gains));
        };
        const auto last = [&](int joint, const Quat& parent, const Quat& child) {
            return turnOf(def.joints[static_cast<std::size_t>(joint)], parent, child);
        };
        set(leg.hip, carrier, bent.thigh, last(leg.hip, carrier, below.thigh), upright);
        set(leg.knee, bent.thigh, bent.shank, last(leg.knee, below.thigh, below.shank), upright);
        set(leg.ankle, bent.shank, bent.foot, last(leg.ankle, below.shank, below.foot), ankle);
    }
}

/// Bears the weight so that the centre of pressure is where it brings the capture point ξ = c + ċ/ω to rest, at
/// p = ξ + (κ − 1)(ξ − ξ₀): by the share of each foot first, then within the soles. The body moves as a whole, by
/// c̈ = ω² (c − p).
void Balance::bear(const Stand& stand, float dt) {
    if (!onFeet()) return;
    const Vec3 wanted = stand.capture + (steps() ? 0 : options_.gain - 1) * (stand.capture - level(lean_));
    const Vec3 left = level(relative(feet_[0].middle, stand.center)),
               right = level(relative(feet_[1].middle, stand.center)), apart = left - right;
    float share = steps() ? (swings(0) ? 0.0f : 1.0f) : (feet_[0].planted ? 1.0f : 0.0f);
    if (!steps() && isNear(0) && isNear(1))
        share = std::clamp(dot(wanted - right, apart) / std::max(lengthSquared(apart), 1e-6f), 0.0f, 1.0f);
    const Vec3 offset = wanted - (share * left + (1 - share) * right);
    Vec3 pressure;
    std::array<Vec3, 2> at{};
    for (std::size_t side = 0; side < 2; ++side) {
        const Quat& flat = feet_[side].flat;
        at[side] = relative(feet_[side].middle, stand.center) +
                   rotate(flat, soles_[side].within(inverseRotate(flat, offset), kSoleShare));
        pressure += (side == 0 ? share : 1 - share) * at[side];
    }
    const float mass = dynamics_.mass();
    const Vec3 acceleration = (stand.rate * stand.rate) * level(stand.mass - pressure);
    const Vec3 force = mass * (acceleration - world_->settings().gravity);
    std::fill(accelerations_.begin(), accelerations_.end(), PartMotion{acceleration, {}});
    std::fill(outside_.begin(), outside_.end(), PartMotion{});
    if (steps()) {
        const Leg& leg = legs_[static_cast<std::size_t>(swing_.side)];
        const Vec3 swung = swungBy(swing_.age, dt);
        for (const auto& [part, moves] :
             {std::pair{leg.thigh, kThighMoves}, {leg.shank, kShankMoves}, {leg.foot, 1.0f}})
            accelerations_[static_cast<std::size_t>(part)].linear += moves * (swung - acceleration);
    }
    for (std::size_t side = 0; side < 2; ++side) {
        const auto part = static_cast<std::size_t>(legs_[side].foot);
        const Vec3 f = (side == 0 ? share : 1 - share) * force;
        const Vec3 arm = at[side] - relative(dynamics_.parts()[part].center, stand.center);
        outside_[part] = {f, cross(arm, f)};
    }
    muscles_->expect(accelerations_, outside_);
}

void Balance::look() {
    dynamics_.look();
    feel();
    measure(survey());
}

void Balance::look(const InverseDynamics& seen) {
    dynamics_.look(seen);
    feel();
    measure(survey());
}

void Balance::step(double dt) {
    dynamics_.look();
    step(dt, dynamics_);
}

void Balance::step(double dt, const InverseDynamics& seen) {
    const auto seconds = static_cast<float>(dt);
    if (!(seconds > 0) || !std::isfinite(seconds)) return;
    if (&seen != &dynamics_) dynamics_.look(seen);
    feel();
    quicken(seconds);
    carrySwing(seconds);
    const Stand stand = survey();
    learn(stand, seconds);
    measure(stand);
    if (options_.step > 0) swing(stand, seconds);
    bend(stand, seconds);
    bear(stand, seconds);
}

}  // namespace ragtop
