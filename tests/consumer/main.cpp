#include <ragtop/ragtop.h>

#include <cstdio>

int main() {
    ragtop::World world;
    world.create(ragtop::StaticBody{.shape = ragtop::Box{{50, 1, 50}}, .position = {0, -1, 0}});
    auto brick = world.create(
        ragtop::DynamicBody{.shape = ragtop::Box{{.2f, .1f, .1f}}, .density = 2000, .position = {0, 1, 0}});

    ragtop::Recording recording{world};
    for (int i = 0; i < 120; ++i) {
        world.step(1.0 / 60);
        recording.capture();
    }
    recording.write("hello.glb");
    const auto car = ragtop::loadVehicle(ragtop::dataFolder() / "vehicles/hatchback.car.json");
    std::printf("the shipped car has %zu wheels\n", car.wheels.size());

    const double height = static_cast<double>(world.pose(brick).position.y);
    std::printf("the brick rests at %.3f m\n", height);
    return height > 0.09 && height < 0.11 ? 0 : 1;
}
