#include "ragtop/world.h"

#include "../engine.h"

namespace ragtop::stability {
namespace {

WorldSettings settingsOf(const Scene& scene) {
    WorldSettings settings;
    settings.gravity = scene.settings.gravity;
    settings.sleeping = false;
    return settings;
}

class RagtopEngine : public Engine {
public:
    explicit RagtopEngine(const Scene& scene) : world_(settingsOf(scene)), instance_(scene, world_) {}

    void step(double dt) override { world_.step(dt); }
    BodyMotion motion(int body) const override {
        const BodyId id = idOf(body);
        return {world_.pose(id), world_.linearVelocity(id), world_.angularVelocity(id)};
    }
    void setVelocity(int body, const Vec3& linear, const Vec3& angular) override {
        world_.setVelocity(idOf(body), linear, angular);
    }
    void push(int body, const Vec3& force, const DVec3& point) override { world_.applyForce(idOf(body), force, point); }
    void remove(int body) override { world_.destroy(idOf(body)); }
    std::optional<double> normalForce(int a, int b) const override {
        double sum = 0;
        world_.forEachContact(idOf(a), [&](const Contact& contact) {
            if (contact.bodyA == idOf(b) || contact.bodyB == idOf(b)) sum += static_cast<double>(contact.normalForce);
        });
        return sum;
    }

private:
    BodyId idOf(int body) const { return instance_.bodies[static_cast<std::size_t>(body)]; }

    World world_;
    SceneInstance instance_;
};

}  // namespace

std::unique_ptr<Engine> makeRagtop(const Scene& scene) { return std::make_unique<RagtopEngine>(scene); }

}  // namespace ragtop::stability
