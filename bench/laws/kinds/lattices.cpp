#include "parts.h"

namespace ragtop::laws {
namespace {

/// Of one lattice.
struct Springs {
    int side[3] = {2, 2, 2};  ///< balls along each edge
    float pitch = 0.25f;      ///< m
    int reach = 1;            ///< neighbours: 1 along edges, 2 over faces' diagonals too, 3 over cells' too
    Spring spring;
};

/// The damping ratio is that of two balls alone.
Springs drawSprings(Dice& dice, float mass) {
    Springs springs;
    for (int& side : springs.side) side = 2 + static_cast<int>(dice.below(4));
    springs.pitch = dice.between(0.22f, 0.5f);
    springs.reach = 1 + static_cast<int>(dice.below(3));
    // From 0.1 m of sag of a ball by its weight, to 19 rad of a pair in a substep of 1/240 s.
    springs.spring.stiffness = mass * magnitude(dice, 100, 1e7f);
    const float ratio = dice.below(4) == 0 ? 0.0f : magnitude(dice, 0.01f, 30);
    springs.spring.damping = 2 * ratio * std::sqrt(springs.spring.stiffness * 0.5f * mass);
    return springs;
}

void join(Scene& scene, const Springs& springs, int a, int b) {
    DistanceDef joint;
    const DVec3 way = scene.bodies[static_cast<std::size_t>(b)].def.pose.position -
                      scene.bodies[static_cast<std::size_t>(a)].def.pose.position;
    joint.rest = static_cast<float>(std::sqrt(dot(way, way)));
    joint.spring = springs.spring;
    scene.joints.push_back({.bodyA = a, .bodyB = b, .def = joint});
}

/// Each ball to those of its neighbours that come after it.
void joinNeighbours(Scene& scene, const Springs& springs, int first) {
    const auto& n = springs.side;
    const auto at = [&](int x, int y, int z) { return first + (x * n[1] + y) * n[2] + z; };
    const auto isIn = [](int i, int side) { return i >= 0 && i < side; };
    for (int i = 0; i < n[0] * n[1] * n[2]; ++i)
        for (int way = 14; way < 27; ++way) {
            const int dx = way / 9 - 1, dy = way / 3 % 3 - 1, dz = way % 3 - 1;
            const int x = i / (n[1] * n[2]) + dx, y = i / n[2] % n[1] + dy, z = i % n[2] + dz;
            if (std::abs(dx) + std::abs(dy) + std::abs(dz) > springs.reach) continue;
            if (isIn(x, n[0]) && isIn(y, n[1]) && isIn(z, n[2])) join(scene, springs, first + i, at(x, y, z));
        }
}

}  // namespace

Drawn drawLattice(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material matter = surface(dice.between(0.2f, 0.9f));
    addFloor(scene, matter);
    const float density = 1000, radius = 0.1f, mass = 4.19f * radius * radius * radius * density;
    const Springs springs = drawSprings(dice, mass);
    const auto speed = [&](float most) { return dice.between(-most, most); };
    const Vec3 v{speed(4), speed(4), speed(4)};
    const bool hangs = dice.below(3) == 0;
    const int first = static_cast<int>(scene.bodies.size());
    const auto& n = springs.side;
    const float height = dice.between(0.2f, 3);
    for (int i = 0; i < n[0] * n[1] * n[2]; ++i) {
        const Vec3 at{static_cast<float>(i / (n[1] * n[2])), static_cast<float>(i / n[2] % n[1]),
                      static_cast<float>(i % n[2])};
        BodyDef ball = solidOfDensity(Sphere{radius}, DVec3{springs.pitch * at + Vec3{0, height, 0}}, density, matter);
        ball.linearVelocity = v;
        if (hangs && i == 0) ball.type = BodyType::fixed, ball.linearVelocity = {};
        add(scene, std::move(ball));
    }
    joinNeighbours(scene, springs, first);
    if (coin(dice)) {
        const Vec3 middle = 0.5f * springs.pitch * Vec3{static_cast<float>(n[0] - 1), 0, static_cast<float>(n[2] - 1)};
        const float size = dice.between(0.1f, 0.3f), fall = dice.between(0.5f, 4);
        const float top = height + springs.pitch * static_cast<float>(n[1]) + size + fall;
        add(scene, solidOfDensity(Box{{size, size, size}}, DVec3{middle + Vec3{0, top, 0}}, magnitude(dice, 100, 10000),
                                  matter));
    }
    drawn.seconds = 6;
    return drawn;
}

}  // namespace ragtop::laws
