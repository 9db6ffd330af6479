#include "ragtop.h"

#include <algorithm>
#include <cmath>

namespace ragtop::stability {
namespace {

WorldSettings settingsOf(const Scene& scene, const RagtopOptions& options) {
    WorldSettings settings;
    settings.gravity = scene.settings.gravity;
    settings.sleeping = false;
    settings.solver = options.solver;
    if (options.substeps > 0) settings.substeps = options.substeps;
    return settings;
}

}  // namespace

RagtopEngine::RagtopEngine(const Scene& scene, const WorldSettings& settings, const WorldConfig& config)
    : world_(settings, config), instance_(scene, world_) {}

void RagtopEngine::step(double dt) {
    instance_.drive(time_);
    world_.step(dt);
    time_ += dt;
}

BodyMotion RagtopEngine::motion(int body) const { return motionOf(idOf(body)); }

BodyMotion RagtopEngine::motionOf(BodyId id) const {
    return {world_.pose(id), world_.linearVelocity(id), world_.angularVelocity(id)};
}

CarSums RagtopEngine::cars() const {
    CarSums sums;
    const DVec3 g{world_.settings().gravity};
    for (const BodyId body : world_.bodies()) {
        // A car's bodies are those that the scene does not have.
        if (world_.type(body) == BodyType::fixed || std::ranges::find(instance_.bodies, body) != instance_.bodies.end())
            continue;
        const BodyMotion m = motionOf(body);
        const DVec3 v{m.v};
        const double speed = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        if (!(speed <= sums.fastest)) sums.fastest = speed;
        if (world_.type(body) != BodyType::dynamic) continue;
        const MassProperties mass = world_.mass(body);
        const auto kg = static_cast<double>(mass.mass);
        const Vec3 w = inverseRotate(m.pose.rotation, m.w);
        const DVec3 x = world_.centerOfMass(body);
        sums.mass += kg;
        sums.momentum = sums.momentum + kg * v;
        sums.way += kg * speed;
        sums.kinetic += 0.5 * kg * speed * speed + 0.5 * static_cast<double>(dot(w, mass.inertia * w));
        sums.potential -= kg * (g.x * x.x + g.y * x.y + g.z * x.z);
    }
    for (const Vehicle& vehicle : instance_.vehicles) {
        const EnergyTelemetry& energy = vehicle.telemetry().energy;
        sums.held += energy.elastic + energy.rotating;
        sums.work += energy.engine;
    }
    return sums;
}

void RagtopEngine::layCar(int car, const BodyMotion& motion) {
    world_.setPose(chassis(car), motion.pose);
    instance_.vehicles[static_cast<std::size_t>(car)].setVelocity(motion.v, motion.w);
}

void RagtopEngine::setVelocity(int body, const Vec3& linear, const Vec3& angular) {
    world_.setVelocity(idOf(body), linear, angular);
}

void RagtopEngine::push(int body, const Vec3& force, const DVec3& point) {
    world_.applyForce(idOf(body), force, point);
}

int RagtopEngine::add(const BodyDef& def) {
    instance_.bodies.push_back(world_.create(def));
    return static_cast<int>(instance_.bodies.size()) - 1;
}

void RagtopEngine::remove(int body) { world_.destroy(idOf(body)); }

double RagtopEngine::normalForce(int a, int b) const {
    double sum = 0;
    world_.forEachContact(idOf(a), [&](const Contact& contact) {
        if (contact.bodyA == idOf(b) || contact.bodyB == idOf(b)) sum += static_cast<double>(contact.normalForce);
    });
    return sum;
}

Reaction RagtopEngine::reaction(int joint) const {
    const JointState state = world_.state(instance_.joints[static_cast<std::size_t>(joint)]);
    return {state.force, state.torque};
}

StepWork RagtopEngine::work() const {
    const StepStats stats = world_.stats();
    // A pass that solves and one that relaxes in each substep; islands solved directly have iterations of their own.
    int passes = 2 * world_.settings().substeps;
    for (const StepStats::Island& island : stats.islands) passes += island.iterations;
    return {stats.contacts, passes};
}

std::unique_ptr<Engine> makeRagtop(const Scene& scene, const RagtopOptions& options) {
    return std::make_unique<RagtopEngine>(scene, settingsOf(scene, options));
}

}  // namespace ragtop::stability
