#include "ragtop/animated_body.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "base/check_tunables.h"
#include "base/hash.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Below this share of the way a body is blocked.
constexpr double kBlocked = 0.5;
/// Share of a step's way within which it is where it should be.
constexpr double kLate = 1e-3;
/// m, and rad times the size of a body, within which it is where it should be.
constexpr double kThere = 1e-5;

double ease(double t) { return t * t * (3 - 2 * t); }

Quat between(const Quat& a, const Quat& b, float share) {
    const Vec3 turn = rotationVector(b * conjugate(a));
    const float angle = length(turn);
    return angle > 0 ? normalized(rotationAbout((1 / angle) * turn, share * angle) * a) : a;
}

AxisDef driven(float speed, float maxForce) {
    AxisDef axis;
    axis.motor = Motor{speed, maxForce};
    return axis;
}

}  // namespace

std::string whyInvalid(const AnimatedBodyDef& def) {
    if (def.keys.size() < 2) return "keys: " + std::to_string(def.keys.size()) + " are given, must be at least 2";
    for (std::size_t i = 0; i < def.keys.size(); ++i) {
        const std::string name = "keys[" + std::to_string(i) + "].";
        const double time = def.keys[i].time;
        if (i == 0 && time != 0) return name + "time is " + numberText(time) + ", must be 0 s";
        if (!std::isfinite(time)) return name + "time is " + numberText(time) + ", must be finite";
        if (i > 0 && !(time > def.keys[i - 1].time))
            return name + "time is " + numberText(time) + ", must be after that of the key before, " +
                   numberText(def.keys[i - 1].time) + " s";
        if (std::string why = whyNotFinite(name + "pose.position", def.keys[i].pose.position); !why.empty()) return why;
        if (std::string why = whyNoRotation(name + "pose.rotation", def.keys[i].pose.rotation); !why.empty())
            return why;
    }
    for (const auto& [name, value] : {std::pair{"maxForce", def.maxForce}, std::pair{"maxTorque", def.maxTorque}})
        if (!std::isfinite(value) || !(value > 0))
            return std::string(name) + " is " + numberText(value) + ", must be finite and above 0";
    if (!std::isfinite(def.patience) || !(def.patience >= 0))
        return "patience is " + numberText(def.patience) + ", must be finite and at least 0 s";
    return {};
}

/// Six motors between the carrier and the body, with their frames at the target: they ask for the speed that leads
/// there within the step, and get it unless that takes more than the budget.
struct AnimatedBody::Player {
    World* world;
    AnimatedBodyDef def;
    StepModule module;
    float size = 1;          // m, what a radian counts for
    float gravityScale = 1;  // given back when the body is let go

    /// What a saved world keeps of this.
    struct Saved {
        double clock = 0, wanted = 0;
        double blockedFor = 0, rate = 0, share = 1;
        JointId joint{};
        BodyId broken{};
        std::int32_t direction = 1;
        std::uint32_t paused = 0, holding = 0, blocked = 0;
    } now;
    // Of the step that is under way.
    Pose target{};

    Player(World& inWorld, const AnimatedBodyDef& inDef) : world(&inWorld), def(inDef) {
        if (const std::string why = whyInvalid(def); !why.empty()) throw std::invalid_argument(why);
        if (!world->isValid(def.body) || world->type(def.body) != BodyType::dynamic)
            throw std::invalid_argument("body names no dynamic body of this world");
        const MassProperties mass = world->mass(def.body);
        const float inertia = std::max({mass.inertia.cx.x, mass.inertia.cy.y, mass.inertia.cz.z});
        size = std::sqrt(inertia / mass.mass);
        now.joint = world->create(JointDef(driveTo(def.keys[0].pose, {}, {}, {1, 0, 0}, 0)));
        gravityScale = world->gravityScale(def.body);
        world->setGravityScale(def.body, 0);
        registerModule();
    }
    ~Player() {
        world->remove(&module);
        letGo();
    }

    void registerModule() {
        module.user = this;
        module.name = "animated body";
        module.beforeStep = [](void* user, World&, double dt) { static_cast<Player*>(user)->beforeStep(dt); };
        module.afterStep = [](void* user, World&, double dt) { static_cast<Player*>(user)->afterStep(dt); };
        module.saveSize = [](const void*) { return sizeof(Saved); };
        module.save = [](const void* user, std::span<std::byte> into) {
            std::memcpy(into.data(), &static_cast<const Player*>(user)->now, sizeof(Saved));
        };
        module.restore = [](void* user, std::span<const std::byte> from) {
            std::memcpy(&static_cast<Player*>(user)->now, from.data(), sizeof(Saved));
        };
        module.hash = [](const void* user) {
            const Saved& state = static_cast<const Player*>(user)->now;
            StateHash digest;
            for (const double number : {state.clock, state.wanted, state.blockedFor, state.share}) digest.add(number);
            digest.add(state.direction);
            return digest.value();
        };
        world->add(&module);
    }

    double duration() const { return def.keys.back().time; }
    bool holds() const { return world->isValid(now.joint) && world->isValid(def.body); }
    /// Of the body, in its carrier.
    Pose place() const {
        const Pose pose = world->pose(def.body);
        if (def.carrier.isNull()) return pose;
        const Frame in = relative(world->pose(def.carrier), pose);
        return {DVec3(in.position), in.rotation};
    }

    Pose at(double clock) const {
        const double time = def.loops ? clock - duration() * std::floor(clock / duration()) : clock;
        std::size_t next = 1;
        while (next + 1 < def.keys.size() && def.keys[next].time < time) ++next;
        const AnimationKey &a = def.keys[next - 1], &b = def.keys[next];
        const double t = ease(std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0));
        return {a.pose.position + t * (b.pose.position - a.pose.position),
                between(a.pose.rotation, b.pose.rotation, static_cast<float>(t))};
    }

    /// Speeds in the world's axes of the carrier, and what its own motion takes beyond the budget.
    SixDofDef driveTo(const Pose& pose, const Vec3& speed, const Vec3& spin, const Vec3& way, float own) const {
        SixDofDef joint;
        joint.bodies.a = def.carrier;
        joint.bodies.b = def.body;
        joint.bodies.collide = true;
        const Quat along = rotationBetween({1, 0, 0}, way);
        joint.bodies.frameA = {toVec3(pose.position), along};
        joint.bodies.frameB = {{}, normalized(conjugate(pose.rotation) * along)};
        const Vec3 v = inverseRotate(along, speed), w = inverseRotate(along, spin);
        const float force = def.maxForce + own, torque = def.maxTorque + own * size;
        joint.x = driven(v.x, force), joint.y = driven(v.y, force), joint.z = driven(v.z, force);
        joint.twist = driven(w.x, torque), joint.swingY = driven(w.y, torque), joint.swingZ = driven(w.z, torque);
        return joint;
    }

    double wantedClock(double dt) const {
        if (now.paused) return now.clock;
        const double next = now.clock + now.direction * dt;
        return def.loops ? next : std::clamp(next, 0.0, duration());
    }

    /// N, that the animation itself accelerates the body with, as far as it goes on: within one substep of each step.
    float ownForce(double dt) const {
        const DVec3 bend = at(now.wanted + dt).position - 2.0 * at(now.wanted).position + at(now.wanted - dt).position;
        const double share = std::max(now.share, 0.0) * world->settings().substeps / (dt * dt);
        return static_cast<float>(share) * world->mass(def.body).mass * length(toVec3(bend));
    }

    void beforeStep(double dt) {
        now.broken = {};
        if (!holds()) return;
        now.wanted = wantedClock(dt);
        target = at(now.wanted);
        const Pose before = place();
        const Vec3 way = toVec3(target.position - before.position);
        const Vec3 turn = rotationVector(target.rotation * conjugate(before.rotation));
        const bool there = static_cast<double>(length(way) + size * length(turn)) < kThere;
        const bool stays = now.wanted == now.clock && there;
        if (stays && now.holding) return;  // so that it may sleep
        now.holding = stays;
        const auto rate = static_cast<float>(stays ? 0 : 1 / dt);
        world->setDef(now.joint,
                      JointDef(driveTo(target, rate * way, rate * turn, normalized(way, {1, 0, 0}), ownForce(dt))));
    }

    /// The time of the clock at which the animation is nearest to where the body is, on the line that it takes in this
    /// step; at most two steps off.
    double clockNow(double dt) const {
        const Pose pose = place(), from = at(now.clock);
        const auto rotated = [&](const Quat& to, const Quat& back) {
            return size * rotationVector(to * conjugate(back));
        };
        const Vec3 way = toVec3(target.position - from.position), turn = rotated(target.rotation, from.rotation);
        const double whole = static_cast<double>(lengthSquared(way) + lengthSquared(turn));
        if (!(whole > kThere * kThere)) return now.wanted;
        const Vec3 off = toVec3(pose.position - target.position), turned = rotated(pose.rotation, target.rotation);
        const double ahead = static_cast<double>(dot(way, off) + dot(turn, turned)) / whole;
        const double most = 2 * dt, lag = ahead * (now.wanted - now.clock);
        return now.wanted + (ahead > -kLate && ahead < kLate ? 0 : std::clamp(lag, -most, most));
    }

    void afterStep(double dt) {
        if (!holds()) return;
        const double before = now.clock, wanted = now.wanted - before;
        now.clock = clockNow(dt);
        if (!def.loops) now.clock = std::clamp(now.clock, 0.0, duration());
        now.rate = (now.clock - before) / dt;
        now.share = wanted != 0 ? (now.clock - before) / wanted : 1;
        now.blocked = now.share < kBlocked;
        now.blockedFor = now.blocked ? now.blockedFor + dt : 0;
        if (def.whenBlocked == WhenBlocked::yield) yieldOrReturn();
        if (def.whenBlocked == WhenBlocked::breakThrough && now.blockedFor > static_cast<double>(def.patience))
            breakWhatBlocks();
    }

    void yieldOrReturn() {
        if (now.blockedFor > static_cast<double>(def.patience)) {
            now.direction = -now.direction;
            now.blockedFor = 0;
        } else if (now.direction < 0 && now.clock <= 0) {
            now.direction = 1;
        }
    }

    /// The dynamic body that presses most against the way, where the whole budget is not enough.
    void breakWhatBlocks() {
        const Vec3 given = world->state(now.joint).force;
        if (length(given) < 0.98f * def.maxForce) return;
        BodyId most{};
        float largest = 0;
        world->forEachContact(def.body, [&](const Contact& contact) {
            const bool isA = contact.bodyA == def.body;
            const BodyId other = isA ? contact.bodyB : contact.bodyA;
            const float against = (isA ? 1.0f : -1.0f) * contact.normalForce * dot(contact.normal, given);
            if (world->type(other) != BodyType::dynamic || !(against > largest)) return;
            largest = against;
            most = other;
        });
        if (most.isNull()) return;
        world->destroy(most);
        now.broken = most;
    }

    void letGo() {
        if (!holds()) return;
        world->destroy(now.joint);
        world->setGravityScale(def.body, gravityScale);
    }
};

AnimatedBody::AnimatedBody(World& world, const AnimatedBodyDef& def) : player_(std::make_unique<Player>(world, def)) {}
AnimatedBody::~AnimatedBody() = default;
AnimatedBody::AnimatedBody(AnimatedBody&&) noexcept = default;
AnimatedBody& AnimatedBody::operator=(AnimatedBody&&) noexcept = default;

AnimationState AnimatedBody::state() const {
    const Player::Saved& now = player_->now;
    AnimationState state{now.clock, static_cast<float>(now.rate), now.blocked != 0, 0, now.broken};
    if (player_->holds()) state.force = length(player_->world->state(now.joint).force);
    return state;
}

Pose AnimatedBody::at(double clock) const { return player_->at(clock); }
void AnimatedBody::setPaused(bool paused) { player_->now.paused = paused ? 1 : 0; }
void AnimatedBody::letGo() { player_->letGo(); }

}  // namespace ragtop
