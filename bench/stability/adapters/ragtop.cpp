#include "ragtop.h"

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

BodyMotion RagtopEngine::motion(int body) const {
    const BodyId id = idOf(body);
    return {world_.pose(id), world_.linearVelocity(id), world_.angularVelocity(id)};
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
