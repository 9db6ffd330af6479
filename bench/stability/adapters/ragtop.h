#pragma once

#include "../engine.h"
#include "ragtop/world.h"

namespace ragtop::stability {

class RagtopEngine : public Engine {
public:
    RagtopEngine(const Scene& scene, const WorldSettings& settings, const WorldConfig& config = {});

    void step(double dt) override;
    BodyMotion motion(int body) const override;
    void setVelocity(int body, const Vec3& linear, const Vec3& angular) override;
    void push(int body, const Vec3& force, const DVec3& point) override;
    int add(const BodyDef& def) override;
    CarSums cars() const override;
    BodyMotion car(int car) const override { return motionOf(chassis(car)); }
    void layCar(int car, const BodyMotion& motion) override;
    void remove(int body) override;
    double normalForce(int a, int b) const override;
    Reaction reaction(int joint) const override;
    StepWork work() const override;

    const World& world() const { return world_; }

protected:
    World world_;
    SceneInstance instance_;

private:
    BodyMotion motionOf(BodyId body) const;
    BodyId chassis(int car) const { return instance_.vehicles[static_cast<std::size_t>(car)].chassis(); }
    double time_ = 0;  ///< s
    BodyId idOf(int body) const { return instance_.bodies[static_cast<std::size_t>(body)]; }
};

}  // namespace ragtop::stability
