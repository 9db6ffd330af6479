#include "ragtop/balance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "leg.h"
#include "ragtop/world.h"
#include "range_check.h"
#include "support.h"

namespace ragtop {
namespace {

constexpr Vec3 kUp{0, 1, 0};
constexpr float kPlanted = 0.02f;         ///< of the weight, that a foot bears at least which stands
constexpr float kUpright = 2;             ///< stiffness of knees and hips over that of ankles
constexpr float kUprightDamping = 0.33f;  ///< of knees and hips, over stiffness by the rate of toppling
constexpr float kMostLean = 0.16f;        ///< of the length of the legs
constexpr float kCalm = 0.01f;            ///< m, of what is left to fall, at which learning goes at half its rate
constexpr float kFollow = 0.5f;  ///< share of a step by which the normal of the ground follows that of contacts

/// How the arms of who balances are held: apart from the thighs, which they would rub on.
constexpr PartAngles kArms[] = {{BodyRole::upperArm, BodySide::left, 0.05f, 0.3f},
                                {BodyRole::upperArm, BodySide::right, 0.05f, 0.3f},
                                {BodyRole::forearm, BodySide::left, 0.25f},
                                {BodyRole::forearm, BodySide::right, 0.25f}};

Vec3 level(const Vec3& v) { return {v.x, 0, v.z}; }

}  // namespace

/// Where the body stands and how it moves, relative to the middle of its feet.
struct Balance::Stand {
    DVec3 center;       ///< m, of the feet
    Vec3 mass, speed;   ///< m and m/s, of the centre of mass
    Vec3 capture;       ///< m
    Vec3 pressure;      ///< m, of the weight
    float rate = 0;     ///< 1/s, √(g/z)
    float height = 0;   ///< m, z
    float gravity = 0;  ///< m/s²
    bool both = false;
};

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
        const std::size_t index = legs_.size();
        soles_[index] = soleOf(axes_, leg->foot);
        for (const Vec3& corner : soles_[index])
            middles_[index] += (1.0f / static_cast<float>(soles_[index].size())) * corner;
        legs_.push_back(*leg);
    }
    stance_.resize(ragdoll.def().joints.size());
    turnsOf(axes_, kArms, stance_);
}

Balance::~Balance() = default;

void Balance::release() {
    for (const Leg& leg : legs_)
        for (const int joint : {leg.hip, leg.knee, leg.ankle}) muscles_->setGains(joint, {});
}

/// What the ground does to a foot.
void Balance::feel(std::size_t side) {
    Foot& foot = feet_[side];
    const BodyId body = ragdoll_->bodies()[static_cast<std::size_t>(legs_[side].foot)];
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
    if (foot.planted) {
        foot.pressure = (1.0 / static_cast<double>(felt.load)) * felt.pressure;
        foot.ground = (1 / felt.load) * felt.ground;
        foot.normal = normalized(foot.normal + kFollow * normalized(felt.normal, kUp), kUp);
    }
    const Pose pose = world_->pose(body);
    foot.middle = transformPoint(pose, middles_[side]);
    const Vec3 up = rotate(axes_.axesOf(legs_[side].foot, pose.rotation), kUp);
    foot.flat = normalized(rotationBetween(up, foot.normal) * pose.rotation);
}

void Balance::feel() {
    dynamics_.look();
    for (std::size_t side = 0; side < 2; ++side) feel(side);
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
    stand.capture = level(stand.mass + (1 / stand.rate) * stand.speed);
    return stand;
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

/// Of a point relative to the middle of the feet.
float Balance::marginOf(const Vec3& point) const {
    std::array<Spot, 8> corners{};
    std::size_t count = 0;
    for (std::size_t side = 0; side < 2; ++side) {
        if (!feet_[side].planted) continue;
        for (const Vec3& corner : soles_[side]) {
            const Vec3 at = relative(feet_[side].middle, center_) + rotate(feet_[side].flat, corner - middles_[side]);
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
/// learnt. The capture point ξ = c + ċ/ω comes to rest where the centre of pressure is p = ξ + (κ − 1)(ξ − ξ₀), which
/// springs about the ankles give by k = κ m g z and d = k/ω.
void Balance::bend(const Stand& stand) {
    const RagdollDef& def = ragdoll_->def();
    Vec3 forward;
    for (std::size_t side = 0; side < 2; ++side)
        forward += level(rotate(axes_.axesOf(legs_[side].foot, feet_[side].flat), {0, 0, 1}));
    forward = normalized(forward, {0, 0, 1});
    const Quat turn = normalized(rotationFromAxes(cross(kUp, forward), kUp, forward) * axes_.zero(pelvis_));
    const Vec3 middle = 0.5f * (legs_[0].hipInPelvis + legs_[1].hipInPelvis);
    const Pose pelvis = world_->pose(ragdoll_->bodies()[static_cast<std::size_t>(pelvis_)]);
    Vec3 hips = lean_ + level(relative(transformPoint(pelvis, middle), dynamics_.centerOfMass()));
    std::array<Vec3, 2> ankles{}, offsets{};
    float height = 2 * legs_[0].length;
    for (std::size_t side = 0; side < 2; ++side) {
        const Leg& leg = legs_[side];
        ankles[side] =
            relative(feet_[side].middle, stand.center) + rotate(feet_[side].flat, leg.ankleInFoot - middles_[side]);
        offsets[side] = rotate(turn, leg.hipInPelvis - middle);
        const Vec3 to = ankles[side] - offsets[side] - hips;
        const float most = (1 - options_.crouch) * leg.length, across = lengthSquared(level(to));
        height = std::min(height, to.y + std::sqrt(std::max(most * most - across, 0.0f)));
    }
    hips.y = height;
    const float k = 0.5f * options_.stiffness * dynamics_.mass() * stand.gravity * stand.height;
    for (std::size_t joint = 0; joint < stance_.size(); ++joint)
        muscles_->setTarget(static_cast<int>(joint), stance_[joint]);
    for (std::size_t side = 0; side < 2; ++side) {
        const Leg& leg = legs_[side];
        const Leg::Bent bent = leg.reach(axes_, turn, hips + offsets[side], feet_[side].flat, ankles[side]);
        const auto set = [&](int joint, const Quat& parent, const Quat& child, const MuscleGains& gains) {
            muscles_->setTarget(joint, turnOf(def.joints[static_cast<std::size_t>(joint)], parent, child));
            muscles_->setGains(joint, gains);
        };
        const MuscleGains upright{kUpright * k, kUpright * kUprightDamping * k / stand.rate};
        set(leg.hip, turn, bent.thigh, upright);
        set(leg.knee, bent.thigh, bent.shank, upright);
        set(leg.ankle, bent.shank, bent.foot, {k, options_.damping * k / stand.rate});
    }
}

void Balance::step(double dt) {
    const auto seconds = static_cast<float>(dt);
    if (!(seconds > 0) || !std::isfinite(seconds)) return;
    feel();
    const Stand stand = survey();
    learn(stand, seconds);
    measure(stand);
    bend(stand);
}

}  // namespace ragtop
