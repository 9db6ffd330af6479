#include "parts.h"

namespace ragtop::laws {
namespace {

constexpr double kPlankPitch = 0.6;  ///< m, from joint to joint of a plank

}  // namespace

Bridge addBridge(Scene& scene, Dice& dice, const Material& wood) {
    const int planks = oneOf(dice, {10, 20, 40, 60}), joints = oneOf(dice, {1, 2});
    const bool hinged = coin(dice);
    const double slack = oneOf(dice, {0.001, 0.03, 0.1}), pitch = kPlankPitch * (1 - slack);
    Bridge bridge;
    bridge.plank = magnitude(dice, 1, 100);
    bridge.span = planks * pitch;
    // A shallow parabola whose length is that of the planks: s ≈ L (1 + 8/3 (d/L)²).
    bridge.sag = bridge.span * std::sqrt(3.0 / 8 * slack / (1 - slack));
    const float thickness = oneOf(dice, {0.05f, 0.1f});
    constexpr float kBank = 5;  // m, half of its length
    const double away = 0.5 * bridge.span + static_cast<double>(kBank) + 0.02;
    int before = add(scene, fixedBody(Box{{kBank, thickness / 2, 2}}, {-away, kBridgeHeight, 0}, wood));
    const int last = add(scene, fixedBody(Box{{kBank, thickness / 2, 2}}, {away, kBridgeHeight, 0}, wood));
    for (int i = 0; i <= planks; ++i) {
        const double edge = (i - planks / 2.0) * pitch, middle = edge + 0.5 * pitch;
        int plank = last;
        if (i < planks) {
            const double rise = bridge.height(edge + pitch) - bridge.height(edge);
            BodyDef def =
                solidBody(Box{{0.28f, thickness / 2, 1}}, {middle, bridge.height(middle), 0}, bridge.plank, wood);
            def.pose.rotation = normalized(Quat{0, 0, static_cast<float>(rise / pitch) / 2, 1});
            plank = add(scene, std::move(def));
        }
        for (int k = 0; k < joints; ++k) {
            const DVec3 at{edge, bridge.height(edge), joints == 1 ? 0.0 : (k == 0 ? -0.9 : 0.9)};
            hinged ? static_cast<void>(addHinge(scene, before, plank, at, {0, 0, 1}))
                   : addBall(scene, before, plank, at);
        }
        before = plank;
    }
    return bridge;
}

Shape prism(float radius, float half) {
    const float a = 0.5f * radius, b = std::sqrt(3.0f) * a;
    std::vector<Vec3> points;
    for (const Vec3& corner : {Vec3{radius, 0, 0}, Vec3{b, a, 0}, Vec3{a, b, 0}})
        for (const float z : {-half, half})
            for (int quarter = 0; quarter < 4; ++quarter) {
                const float x = quarter % 2 == 0 ? corner.x : -corner.y, y = quarter % 2 == 0 ? corner.y : corner.x;
                const float sign = quarter < 2 ? 1.0f : -1.0f;
                points.push_back({sign * x, sign * y, z});
            }
    return ConvexHull(points);
}

int addCar(Scene& scene, Dice& dice, const DVec3& at, float mass, float speed, const Material& rubber) {
    const float radius = oneOf(dice, {0.25f, 0.4f}), wheelShare = oneOf(dice, {0.02f, 0.05f, 0.15f});
    const bool round = coin(dice), driven = coin(dice);
    BodyDef box = solidBody(Box{{0.9f, 0.2f, 0.5f}}, at + DVec3{0, static_cast<double>(radius) + 0.15, 0},
                            mass * (1 - 4 * wheelShare), rubber);
    box.linearVelocity = {speed, 0, 0};
    const int body = add(scene, std::move(box));
    for (const double x : {-0.7, 0.7})
        for (const double z : {-0.7, 0.7}) {
            const DVec3 hub = at + DVec3{x, static_cast<double>(radius), z};
            const Shape shape = round ? Shape{Sphere{radius}} : prism(radius, 0.1f);
            BodyDef wheel = solidBody(shape, hub, mass * wheelShare, rubber);
            wheel.linearVelocity = {speed, 0, 0};
            wheel.angularVelocity = {0, 0, -speed / radius};
            HingeDef& hinge = addHinge(scene, body, add(scene, std::move(wheel)), hub, {0, 0, 1});
            if (driven) hinge.motor = Motor{.targetSpeed = -(speed + 3) / radius, .maxForce = 1.5f * mass * radius};
        }
    return body;
}

Drawn drawCrossing(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material wood = surface(0.6f);
    addFloor(scene, wood);
    const Bridge bridge = addBridge(scene, dice, wood);
    const int loads = oneOf(dice, {1, 1, 2, 5});
    for (int i = 0; i < loads; ++i) {
        const float mass = bridge.plank * magnitude(dice, 1, 100), speed = dice.between(0, 10);
        const double x = static_cast<double>(dice.between(-0.6f, 0.4f)) * bridge.span - 1.0;
        const double drop = static_cast<double>(oneOf(dice, {0.1f, 0.1f, 1.5f})) + 1.5 * i;
        const DVec3 at{x, bridge.height(x) + drop, static_cast<double>(dice.between(-0.3f, 0.3f))};
        const std::uint32_t what = dice.below(4);
        if (what < 2) {
            addCar(scene, dice, at, mass, speed, wood);
            continue;
        }
        const float size = dice.between(0.25f, 0.6f);
        const Shape shape =
            what == 2 ? Shape{Sphere{size}} : (coin(dice) ? prism(size, 0.6f) : Shape{Box{{size, size, size}}});
        BodyDef load = solidBody(shape, at + DVec3{0, static_cast<double>(size), 0}, mass, wood);
        load.linearVelocity = {speed, 0, 0};
        load.angularVelocity = {0, 0, -speed / size};
        add(scene, std::move(load));
    }
    drawn.seconds = 8;
    return drawn;
}

}  // namespace ragtop::laws
