#include "hand.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "ragtop/world.h"

namespace ragtop::live {
namespace {

constexpr float kFrequency = 2 * kPi * 2.5f;  ///< rad/s, of the spring with the mass it holds; critically damped
constexpr float kStrength = 100;              ///< m/s², largest force over that mass: ten times its weight
constexpr float kBallDensity = 2000;          ///< kg/m³, of stone

/// x of M x = b, by Cramer's rule.
Vec3 solve(const Mat3& m, const Vec3& b) {
    const Vec3 yz = cross(m.cy, m.cz);
    const float inverse = 1 / dot(m.cx, yz);
    return inverse * Vec3{dot(b, yz), dot(m.cx, cross(b, m.cz)), dot(m.cx, cross(m.cy, b))};
}

/// The mass of a body and of all that joints connect with it.
float hangingMass(const World& world, BodyId first) {
    std::vector<BodyId> found{first};
    float mass = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        mass += world.mass(found[i]).mass;
        for (const JointId joint : world.jointsOf(found[i])) {
            const JointBodies& ends =
                std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, world.def(joint));
            for (const BodyId end : {ends.a, ends.b}) {
                if (end.isNull() || world.type(end) != BodyType::dynamic) continue;
                if (std::find(found.begin(), found.end(), end) == found.end()) found.push_back(end);
            }
        }
    }
    return mass;
}

}  // namespace

Hand::Hand(World& world) : world_(world) {
    static_assert(std::is_trivially_copyable_v<State>);
    module_.user = this;
    module_.name = "hand";
    module_.beforeStep = [](void* user, World&, double) { static_cast<Hand*>(user)->beforeStep(); };
    module_.look = [](void* user, const World&, double) { return static_cast<Hand*>(user)->look(); };
    module_.beforeSubstep = [](void* user, World&, double h) { static_cast<Hand*>(user)->pull(static_cast<float>(h)); };
    module_.saveSize = [](const void*) { return sizeof(State); };
    module_.save = [](const void* user, std::span<std::byte> into) {
        std::memcpy(into.data(), &static_cast<const Hand*>(user)->state_, sizeof(State));
    };
    module_.restore = [](void* user, std::span<const std::byte> from) {
        std::memcpy(&static_cast<Hand*>(user)->state_, from.data(), sizeof(State));
    };
    world_.add(&module_);
}

Hand::~Hand() { world_.remove(&module_); }

void Hand::grab(BodyId body, const Vec3& point, const DVec3& target) {
    if (world_.type(body) != BodyType::dynamic)
        throw std::invalid_argument("the body does not move, must be a dynamic one");
    state_.body = body;
    state_.point = point;
    state_.mass = hangingMass(world_, body);
    state_.target = target;
}

void Hand::drag(const DVec3& target) {
    if (state_.body.isNull()) throw std::invalid_argument("nothing is grabbed");
    state_.target = target;
}

void Hand::release() { state_.body = {}; }

BodyId Hand::shoot(const DVec3& origin, const Vec3& direction, float speed, float radius) {
    if (!(length(direction) > 0)) throw std::invalid_argument("direction is [0, 0, 0], must have a direction");
    BodyDef ball;
    ball.shapes.push_back({.geometry = Sphere{radius}, .density = kBallDensity});
    ball.pose.position = origin;
    ball.linearVelocity = speed * normalized(direction);
    ball.bullet = true;
    const BodyId id = world_.create(ball);
    BodyId& place = state_.balls[state_.nextBall];
    if (world_.isValid(place)) world_.destroy(place);
    place = id;
    state_.nextBall = (state_.nextBall + 1) % static_cast<std::uint32_t>(kMostBalls);
    return id;
}

bool Hand::isBall(BodyId body) const {
    return std::find(state_.balls.begin(), state_.balls.end(), body) != state_.balls.end();
}

void Hand::beforeStep() {
    if (state_.body.isNull()) return;
    if (world_.isValid(state_.body))
        world_.wake(state_.body);
    else
        release();
}

std::span<const BodyId> Hand::look() const {
    return {&state_.body, state_.body.isNull() ? std::size_t{0} : std::size_t{1}};
}

void Hand::pull(float h) {
    const Pose pose = world_.pose(state_.body);
    const DVec3 point = transformPoint(pose, state_.point);
    const Vec3 arm = relative(point, world_.centerOfMass(state_.body));
    const MassProperties mass = world_.mass(state_.body);

    const float stiffness = state_.mass * kFrequency * kFrequency, damping = 2 * state_.mass * kFrequency;
    const float soft = h * (h * stiffness + damping);
    const auto column = [&](const Vec3& axis) {
        const Vec3 turn = solve(mass.inertia, inverseRotate(pose.rotation, cross(arm, axis)));
        return axis + soft * ((1 / mass.mass) * axis + cross(rotate(pose.rotation, turn), arm));
    };
    const Vec3 stretch = relative(point, state_.target), velocity = world_.velocityAt(state_.body, point);
    Vec3 impulse = solve({column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1})},
                         -h * (stiffness * stretch + (h * stiffness + damping) * velocity));
    const float most = h * kStrength * state_.mass, size = length(impulse);
    if (!std::isfinite(size)) return;
    if (size > most) impulse = (most / size) * impulse;
    world_.applyImpulse(state_.body, impulse, point);
}

}  // namespace ragtop::live
