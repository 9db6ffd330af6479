// What a game does with a cooked mesh: loads it and lets something fall on it.

#include <ragtop/cooked.h>
#include <ragtop/world.h>

#include <cstdio>

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const ragtop::Cooked asset = ragtop::loadCooked(arguments[1]);
    if (!asset.mesh || asset.pieces.size() != 1) return 1;
    ragtop::World world;
    ragtop::BodyDef ground;
    ground.type = ragtop::BodyType::fixed;
    ground.shapes = {{.geometry = *asset.mesh}};
    world.create(ground);
    ragtop::BodyDef ball;
    ball.shapes = {{.geometry = ragtop::Sphere{0.1f}}};
    ball.pose.position = {0.2, 1, 0.2};
    const ragtop::BodyId falling = world.create(ball);
    for (int i = 0; i < 20; ++i) world.step(1.0f / 60);
    std::printf("mesh of %zu triangles, ball at %g m\n", asset.mesh->triangles().size(),
                world.pose(falling).position.y);
    return world.pose(falling).position.y > 0 ? 0 : 1;
}
