#include <memory>

#include "fleet.h"
#include "ragtop/driver.h"
#include "ragtop/world.h"

namespace ragtop::fleet {

namespace {

WorldSettings withoutSleep() {
    WorldSettings settings;
    settings.sleeping = false;
    return settings;
}

/// A plane with what is on it.
struct Place {
    World world{withoutSleep()};
    std::unique_ptr<Vehicle> car;

    Place() { world.create(StaticBody{.shape = Box{{4000, 1, 4000}}, .position = {0, -1, 0}}); }

    void addCar(const VehicleDef& def) {
        car = std::make_unique<Vehicle>(world, def, VehiclePlacement{.speed = Course::kSpeed});
        car->input.steer = steerFor(def.steering, Course::wheelAngle(def), Course::kSpeed);
    }
    /// Boxes that lie apart from each other.
    void addBoxes(int count) {
        for (int i = 0; i < count; ++i)
            world.create(DynamicBody{.shape = Box{{0.25f, 0.25f, 0.25f}},
                                     .position = {200 + 1.0 * (i % 50), 0.25, 1.0 * (i / 50)}});
    }
    /// Links of 1 kg with a load of 10 t, let go sideways.
    void addChains(int count) {
        constexpr int kLinks = 20;
        for (int chain = 0; chain < count; ++chain) {
            const DVec3 from{-200, 40, 3.0 * chain};
            BodyId last;
            for (int i = 0; i <= kLinks; ++i) {
                BodyDef def;
                def.shapes = {{.geometry = Sphere{0.2f}, .density = i < kLinks ? 29.84f : 298400.0f}};
                def.shapes[0].filter.mask = 0;
                def.pose.position = from + DVec3{0.5 * (i + 1), 0, 0};
                const BodyId link = world.create(def);
                JointBodies joined{.a = last, .b = link};
                joined.frameA = last.isNull() ? Frame{toVec3(from), {}} : Frame{};
                joined.frameB = {{-0.5f, 0, 0}, {}};
                world.create(BallDef{.bodies = joined});
                last = link;
            }
        }
    }
    void step() {
        if (car) car->input.throttle = Course::throttleAt(length(world.linearVelocity(car->chassis())));
        world.step(Course::kStep);
    }
};

}  // namespace

std::vector<Tax> measureTaxes(const Course& course, const VehicleDef& def) {
    std::vector<Tax> taxes;
    for (const char* name : {"2000 boxes", "50 chains"}) {
        Place places[3];  // without a car, with one, the car by itself
        const bool boxes = name[0] == '2';
        for (int i = 0; i < 3; ++i) {
            if (i < 2) boxes ? places[i].addBoxes(2000) : places[i].addChains(50);
            if (i > 0) places[i].addCar(def);
            for (int k = 0; k < Course::kWarmSteps; ++k) places[i].step();
        }
        // In turn, some steps at a time: what disturbs one disturbs all.
        constexpr int kRounds = 40, kAtOnce = 15;
        double seconds[3] = {};
        for (int round = 0; round < kRounds; ++round)
            for (int i = 0; i < 3; ++i) {
                const double start = now(course);
                for (int k = 0; k < kAtOnce; ++k) places[i].step();
                seconds[i] += now(course) - start;
            }
        const double perStep = 1e6 / (kRounds * kAtOnce);
        taxes.push_back({name, perStep * seconds[0], perStep * seconds[1], perStep * seconds[2]});
    }
    return taxes;
}

}  // namespace ragtop::fleet
