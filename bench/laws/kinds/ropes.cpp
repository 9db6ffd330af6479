#include "parts.h"

namespace ragtop::laws {

/// Statics holds the heavier end while the ratio of the weights is below e^{μφ} [Euler, Eytelwein]; where friction
/// bites by half the thickness below the middle of the rope, e^{μφ R/(R + t)}.
Drawn drawDrum(Dice& dice) {
    constexpr double kPi2 = 1.5707963267948966, kRadius = 1, kThick = 0.05;
    Drawn drawn;
    Scene& scene = drawn.scene;
    const float friction = oneOf(dice, {0.1f, 0.3f, 0.5f});
    const Material hemp = surface(friction);
    const double y = 12, length = oneOf(dice, {0.2, 0.3});
    addFloor(scene, hemp, {0, -20, 0});
    BodyDef drum = fixedBody(Capsule{static_cast<float>(kRadius), 1}, {0, y, 0}, hemp);
    drum.pose.rotation = rotationBetween({0, 1, 0}, {0, 0, 1});
    add(scene, std::move(drum));
    // Half a turn over the top, and some links down on each side.
    const int around = static_cast<int>(std::ceil(2 * kPi2 * (kRadius + kThick) / length)), hanging = 4;
    const double step = 2 * kPi2 / around, r = (kRadius + kThick) / std::cos(0.5 * step);  // links touch half way
    std::vector<DVec3> knots;
    for (int i = hanging; i > 0; --i) knots.push_back({-r, y - i * length, 0});
    for (int i = 0; i <= around; ++i) knots.push_back({-r * std::cos(step * i), y + r * std::sin(step * i), 0});
    for (int i = 1; i <= hanging; ++i) knots.push_back({r, y - i * length, 0});
    int before = kWorld;
    const auto weigh = [&](const DVec3& at, float mass) {
        return add(scene, solidBody(Sphere{0.3f}, at + DVec3{0, -0.3, 0}, mass, hemp));
    };
    const float lighter = magnitude(dice, 10, 500);
    const float ratio = oneOf(dice, {1.0f, 1.5f, 2.2f, 4.0f});
    before = weigh(knots.front(), lighter);
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const DVec3 way = knots[i + 1] - knots[i];
        const double size = std::sqrt(dot(way, way));
        BodyDef link = solidBody(Capsule{static_cast<float>(kThick), static_cast<float>(size / 2 - kThick)},
                                 0.5 * (knots[i] + knots[i + 1]), 0.6f, hemp);
        link.pose.rotation = rotationBetween({0, 1, 0}, toVec3((1 / size) * way));
        const int body = add(scene, std::move(link));
        addBall(scene, before, body, knots[i]);
        before = body;
    }
    addBall(scene, before, weigh(knots.back(), lighter * ratio), knots.back());
    constexpr double kSafe = 0.9;  // of that: the last tenth depends on how links lie
    drawn.stands = ratio <= kSafe * std::exp(static_cast<double>(friction) * 2 * kPi2 * kRadius / (kRadius + kThick));
    drawn.seconds = 5;
    return drawn;
}

Drawn drawBeam(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material iron = surface(0.5f);
    addFloor(scene, iron);
    add(scene, fixedBody(Box{{0.25f, 0.25f, 2}}, {0, 6, 0}, iron));
    const int links = 8 + static_cast<int>(dice.below(30));
    const float ends = oneOf(dice, {1.0f, 4.0f, 12.0f, 40.0f});
    const double pitch = 0.4, off = pitch * static_cast<double>(dice.between(-2, 2)), y = 6.25 + 0.1 + 0.05;
    int before = kWorld;
    for (int i = 0; i < links; ++i) {
        const double x = (i - (links - 1) / 2.0) * pitch + off;
        const bool end = i == 0 || i + 1 == links;
        const int link = add(scene, solidOfDensity(Box{{0.18f, 0.1f, 0.1f}}, {x, y, 0}, end ? 1000 * ends : 1000, iron));
        if (before != kWorld) addBall(scene, before, link, {x - pitch / 2, y, 0});
        before = link;
    }
    drawn.seconds = 8;
    return drawn;
}

Drawn drawPendulum(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material steel = surface(0.3f);
    const int links = 1 + static_cast<int>(dice.below(30));
    const float length = oneOf(dice, {0.2f, 0.5f}), ratio = magnitude(dice, 1, 1000);
    const bool hinged = coin(dice);
    DVec3 at{0, 20, 0};
    // Hanging down, aslant or level.
    const Vec3 along = normalized(Vec3{dice.between(-1, 1), dice.between(-1, 0.25f), dice.between(-0.25f, 0.25f)});
    const Vec3 axis = normalized(cross(along, Vec3{0.125f, 0.25f, 1}));
    int before = kWorld;
    for (int i = 0; i < links; ++i) {
        const bool last = i + 1 == links;
        const float mass = last ? ratio : 1.0f, radius = last ? 0.3f : length / 8;
        const double half = last ? 0.3 : static_cast<double>(length) / 2;
        const DVec3 middle = at + half * DVec3{along};
        Shape shape = last ? Shape{Sphere{radius}} : Shape{Capsule{radius, length / 2 - radius}};
        BodyDef def = solidBody(std::move(shape), middle, mass, steel);
        def.pose.rotation = rotationBetween({0, 1, 0}, along);
        if (last) def.linearVelocity = Vec3{0, 0, dice.between(-3, 3)};
        const int body = add(scene, std::move(def));
        if (hinged && i % 2 == 0)
            addHinge(scene, before, body, at, axis);
        else
            addBall(scene, before, body, at);
        before = body;
        at = middle + half * DVec3{along};
    }
    drawn.seconds = 8;
    return drawn;
}

}  // namespace ragtop::laws
