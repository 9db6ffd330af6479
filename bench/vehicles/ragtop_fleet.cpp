#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "../../tests/core/heap_counter.h"
#include "fleet.h"
#include "ragtop/driver.h"
#include "ragtop/tasks.h"
#include "ragtop/world.h"

namespace ragtop::fleet {

namespace {

void addGround(World& world, const Terrain& terrain) {
    if (terrain.heights.empty()) {
        world.create(StaticBody{.shape = Box{{4000, 1, 4000}}, .position = {0, -1, 0}});
    } else if (terrain.triangles) {
        const std::vector<int> indices = terrain.indices();
        std::vector<Triangle> triangles;
        for (std::size_t i = 0; i < indices.size(); i += 3)
            triangles.push_back({static_cast<std::uint32_t>(indices[i]), static_cast<std::uint32_t>(indices[i + 1]),
                                 static_cast<std::uint32_t>(indices[i + 2])});
        world.create(StaticBody{.shape = TriangleMesh(terrain.vertices(), triangles)});
    } else {
        const float corner = -terrain.extent();
        world.create(
            StaticBody{.shape = HeightField(terrain.columns, terrain.columns, Terrain::kSpacing, terrain.heights),
                       .position = DVec3(Vec3{corner, 0, corner})});
    }
    for (const Terrain::Block& block : terrain.blocks)
        world.create(StaticBody{.shape = Box{block.halfExtents}, .position = block.center});
}

/// Names of the parts of a step as a user of cars would ask for them.
std::string partOf(const std::string& stage) {
    if (stage == "modules") return "driver";
    if (stage == "look") return "ground";
    return stage == "modules after" ? "after" : "world";
}

}  // namespace

Result driveRagtop(const Course& course, const Terrain& terrain, const VehicleDef& def) {
    World world({}, {.tasks = course.threads > 1 ? threadTasks(course.threads) : serialTasks()});
    addGround(world, terrain);
    const std::size_t without = world.saveSize();
    std::deque<Vehicle> cars;
    for (int i = 0; i < course.cars; ++i) {
        DVec3 place = course.placeOf(i);
        place.y = static_cast<double>(terrain.heightAt(place.x, place.z)) + 0.1;
        cars.emplace_back(world, def, VehiclePlacement{.position = place, .speed = course.asleep ? 0 : Course::kSpeed});
        if (course.asleep)
            cars.back().input.handbrake = 1;
        else
            cars.back().input.steer = steerFor(def.steering, Course::wheelAngle(def), Course::kSpeed);
    }
    Result result;
    std::map<std::string, double> parts;
    double start = 0;
    long calls = 0;
    for (int i = 0; course.asleep && i < Course::kMostSteps && world.stats().awakeBodies > 0; ++i)
        world.step(Course::kStep);
    for (int i = 0; i < Course::kWarmSteps + Course::kSteps; ++i) {
        if (i == Course::kWarmSteps) start = now(course);
        for (Vehicle& car : cars)
            if (!course.asleep) car.input.throttle = Course::throttleAt(length(world.linearVelocity(car.chassis())));
        const long before = heapCalls();
        world.step(Course::kStep);
        if (i < Course::kWarmSteps) continue;
        calls += heapCalls() - before;
        const StepStats stats = world.stats();
        for (const StepStats::Stage& stage : stats.stages) parts[partOf(stage.name)] += stage.ms;
        parts["solver of the car"] += stats.modulesMs;
        parts["world"] -= stats.modulesMs;
    }
    result.microseconds = 1e6 * (now(course) - start) / (course.cars * Course::kSteps);
    result.allocations = static_cast<double>(calls) / Course::kSteps;
    for (const auto& [name, ms] : parts) result.parts.emplace_back(name, 1e3 * ms / (course.cars * Course::kSteps));
    result.stateBytes = static_cast<double>(world.saveSize() - without) / course.cars;
    for (const Vehicle& car : cars) {
        const float speed = length(world.linearVelocity(car.chassis()));
        result.speed += static_cast<double>(speed) / course.cars;
        const bool upright = rotate(world.pose(car.chassis()).rotation, {0, 1, 0}).y > 0.7f;
        result.driving += upright && speed > 1;
    }
    return result;
}

}  // namespace ragtop::fleet
