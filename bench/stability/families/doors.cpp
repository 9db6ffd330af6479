#include <cmath>
#include <memory>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"
#include "ragtop/animated_body.h"

namespace ragtop::stability {
namespace {
namespace doors_cases {

constexpr float kBudget = 300;  ///< N

/// A sliding door closes within 2 s on a box of 10.8 kg that stands before a wall.
struct Doorway {
    World world;
    BodyId door{}, box{};
    std::unique_ptr<AnimatedBody> animation;
    double pressed = 0;  ///< N, the most that the animation gave while blocked
    double apart = 0;    ///< m, between the door and where its clock says it is
    double back = 9;     ///< m, the least travel after it was blocked
    int blocked = 0;
    bool broke = false;

    Doorway(WhenBlocked whenBlocked, double dt) : dt_(dt) {
        WorldSettings settings;
        settings.sleeping = false;
        world.setSettings(settings);
        world.create(fixedBody(Box{{100, 1, 100}}, {0, -1, 0}, surface(0.3f)));
        world.create(fixedBody(Box{{0.1f, 1, 1}}, {2.1, 1, 0}, surface(0.3f)));
        door = world.create(solidBody(Box{{0.05f, 1, 0.5f}}, {0, 1.1, 0}, 20, surface(0.3f)));
        box = world.create(solidBody(Box{{0.3f, 0.3f, 0.3f}}, {1.3, 0.3, 0}, 10.8f, surface(0)));
        AnimatedBodyDef def;
        def.body = door;
        def.keys = {{0, {{0, 1.1, 0}, {}}}, {2, {{1.5, 1.1, 0}, {}}}};
        def.maxForce = kBudget;
        def.maxTorque = 1000;
        def.whenBlocked = whenBlocked;
        animation = std::make_unique<AnimatedBody>(world, def);
    }
    double travel() const { return world.pose(door).position.x; }
    void advance(double seconds) {
        // What the door itself had of momentum is over after a few steps.
        constexpr double kImpact = 0.1;
        for (int left = static_cast<int>(std::lround(seconds / dt_)); left > 0; --left) {
            world.step(dt_);
            const AnimationState now = animation->state();
            blocked = now.blocked && now.rate > -0.1f ? blocked + 1 : 0;
            if (blocked * dt_ > kImpact) pressed = larger(pressed, static_cast<double>(now.force));
            if (pressed > 0) back = smaller(back, travel());
            broke |= !now.broken.isNull();
            apart = larger(apart, std::abs(travel() - animation->at(now.clock).position.x));
        }
    }

private:
    double dt_;
};

void expectBudget(Trial& trial, const Doorway& doorway) {
    trial.expectNear("force", doorway.pressed, kBudget, 0.05 * kBudget, "N");
    trial.expectAtMost("door from its clock", doorway.apart, 1e-3, "m");
}

void stalls(Trial& trial) {
    Doorway doorway(WhenBlocked::stall, trial.dt());
    doorway.advance(6);
    expectBudget(trial, doorway);
    trial.expectNear("stands at the box", doorway.travel(), 2 - 0.6 - 0.05, 5e-3, "m");
    doorway.world.destroy(doorway.box);
    doorway.advance(2);
    trial.expectNear("goes on when it is free", doorway.travel(), 1.5, 1e-3, "m");
}

void yields(Trial& trial) {
    Doorway doorway(WhenBlocked::yield, trial.dt());
    doorway.advance(8);
    expectBudget(trial, doorway);
    trial.expectNear("goes back to", doorway.back, 0, 1e-3, "m");
}

void breaks(Trial& trial) {
    Doorway doorway(WhenBlocked::breakThrough, trial.dt());
    doorway.advance(4);
    expectBudget(trial, doorway);
    trial.expectNear("breaks the box", doorway.broke ? 1 : 0, 1, 0, "1");
    trial.expectNear("closes", doorway.travel(), 1.5, 1e-3, "m");
}

}  // namespace doors_cases
}  // namespace

Family doors() {
    using namespace doors_cases;
    return {"doors",
            {{"stalls", stalls, Kind::ragtopOnly},
             {"yields", yields, Kind::ragtopOnly},
             {"breaks what is in its way", breaks, Kind::ragtopOnly}}};
}

}  // namespace ragtop::stability
