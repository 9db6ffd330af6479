#include "parts.h"

namespace ragtop::laws {

Drawn drawBridge(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material wood = surface(0.6f);
    const int planks = oneOf(dice, {10, 20, 40, 60}), balls = oneOf(dice, {1, 2}), boxes = oneOf(dice, {0, 5, 10, 20});
    const float thickness = oneOf(dice, {0.05f, 0.1f}), density = oneOf(dice, {300.0f, 600.0f});
    // Nearly taut: the banks are a thousandth nearer than the planks are long; slack: a tenth.
    const double pitch = 0.6, slack = coin(dice) ? 0.001 : 0.1, span = planks * pitch, y = 10;
    addFloor(scene, wood);
    // The planks lie on a shallow parabola whose length is that of the planks: s ≈ L (1 + 8/3 (d/L)²).
    const double sag = span * std::sqrt(3.0 / 8 * slack / (1 - slack));
    const auto height = [&](double x) { return y - 4 * sag * (0.25 - x * x / (span * span)); };
    const double side = balls == 1 ? 0.0 : 0.9;
    int before = kWorld;
    for (int i = 0; i <= planks; ++i) {
        const double edge = (i - planks / 2.0) * pitch * (1 - slack), middle = edge + 0.5 * pitch * (1 - slack);
        int plank = kWorld;
        if (i < planks) {
            const float turn = static_cast<float>((height(edge + pitch) - height(edge)) / pitch);
            BodyDef def = solidOfDensity(Box{{0.28f, thickness / 2, 1}}, {middle, height(middle), 0}, density, wood);
            def.pose.rotation = normalized(Quat{0, 0, turn / 2, 1});
            plank = add(scene, std::move(def));
        }
        for (int k = 0; k < balls; ++k) addBall(scene, before, plank, {edge, height(edge), (k == 0 ? -side : side)});
        before = plank;
    }
    for (int i = 0; i < boxes; ++i) {
        const float mass = magnitude(dice, 15, 150), half = 0.25f;
        const double x = static_cast<double>(dice.between(-0.4f, 0.4f)) * span, z = static_cast<double>(dice.between(-0.5f, 0.5f));
        add(scene, solidBody(Box{{half, half, half}}, {x, y + 1.5 + 0.7 * i, z}, mass, wood));
    }
    drawn.seconds = 8;
    return drawn;
}

Drawn drawNet(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const int n = oneOf(dice, {6, 10, 14});
    const float radius = 0.04f, density = oneOf(dice, {1000.0f, 3000.0f});
    const double pitch = oneOf(dice, {0.15, 0.25}), y = 8, middle = pitch * (n - 1) / 2;
    const Material cord = surface(0.5f);
    addFloor(scene, cord);
    const int first = static_cast<int>(scene.bodies.size());
    for (int i = 0; i < n * n; ++i)
        add(scene, solidOfDensity(Sphere{radius}, {i % n * pitch - middle, y, i / n * pitch - middle}, density, cord));
    const auto place = [&](int i) { return scene.bodies[static_cast<std::size_t>(first + i)].def.pose.position; };
    const auto tie = [&](int i, int j) { addBall(scene, first + i, first + j, 0.5 * (place(i) + place(j))); };
    for (int i = 0; i < n * n; ++i) {
        if (i % n + 1 < n) tie(i, i + 1);
        if (i / n + 1 < n) tie(i, i + n);
    }
    for (const int corner : {0, n - 1, n * (n - 1), n * n - 1}) addBall(scene, kWorld, first + corner, place(corner));
    const float mass = magnitude(dice, 1, 113);
    add(scene, solidBody(Sphere{0.3f}, {static_cast<double>(dice.between(-0.25f, 0.25f)), y + 2.3, 0}, mass, cord));
    return drawn;
}

}  // namespace ragtop::laws
