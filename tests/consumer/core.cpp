#include <ragtop/world.h>

#include <cstdio>

int main() {
    ragtop::World world;
    world.create(ragtop::StaticBody{.shape = ragtop::Box{{50, 1, 50}}, .position = {0, -1, 0}});
    const auto brick = world.create(
        ragtop::DynamicBody{.shape = ragtop::Box{{.2f, .1f, .1f}}, .density = 2000, .position = {0, 1, 0}});
    for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
    const double height = world.pose(brick).position.y;
    std::printf("the brick rests at %.3f m\n", height);
    return height > 0.09 && height < 0.11 ? 0 : 1;
}
