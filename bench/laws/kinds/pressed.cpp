#include "parts.h"

namespace ragtop::laws {

namespace {

Shape lightShape(Dice& dice, float size) {
    switch (dice.below(3)) {
        case 0:
            return Box{{size, size, size}};
        case 1:
            return Capsule{0.6f * size, 0.4f * size};
        default:
            return Sphere{size};
    }
}

/// Four walls about the middle, `half` from it to their inner faces.
void addPit(Scene& scene, float half, const Material& matter) {
    constexpr float kThick = 0.2f, kHigh = 2;
    for (const float side : {-1.0f, 1.0f}) {
        const auto at = static_cast<double>(side * (half + kThick));
        add(scene, fixedBody(Box{{kThick, kHigh, half + 2 * kThick}}, {at, static_cast<double>(kHigh), 0}, matter));
        add(scene, fixedBody(Box{{half + 2 * kThick, kHigh, kThick}}, {0, static_cast<double>(kHigh), at}, matter));
    }
}

/// Two walls that close from three metres each to what their bodies need, or less, and stay there.
void addPress(Drawn& drawn, Dice& dice, float size, const Material& matter) {
    constexpr float kThick = 0.2f, kFrom = 3;
    const float left = dice.between(0.7f, 1.6f) * size, phase = dice.between(0.8f, 2);
    for (const float side : {-1.0f, 1.0f}) {
        BodyDef wall = fixedBody(Box{{kThick, 2, 2}}, {static_cast<double>(side * (kFrom + kThick)), 2, 0}, matter);
        wall.type = BodyType::kinematic;
        Ride ride;
        ride.body = add(drawn.scene, std::move(wall));
        ride.phase = static_cast<double>(phase);
        ride.acceleration = {-side * (kFrom - left) / (2 * phase * phase), 0, 0};
        drawn.rides.push_back(ride);
    }
}

}  // namespace

Drawn drawPressed(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material matter = surface(dice.between(0.2f, 0.9f));
    addFloor(scene, matter);
    const bool closes = coin(dice);
    const float size = dice.between(0.1f, 0.3f), density = magnitude(dice, 10, 1000);
    const int across = closes ? 3 : 3 + static_cast<int>(dice.below(3)), layers = 1 + static_cast<int>(dice.below(2));
    const float pitch = 2.1f * size, half = 0.5f * pitch * static_cast<float>(across);
    if (closes)
        addPress(drawn, dice, size, matter);
    else
        addPit(scene, half, matter);
    for (int layer = 0; layer < layers; ++layer)
        for (int i = 0; i < across * across; ++i) {
            const auto along = [&](int k) {
                return static_cast<double>((static_cast<float>(k) + 0.5f) * pitch - half);
            };
            const DVec3 at{along(i % across), (layer + 0.55) * static_cast<double>(pitch), along(i / across)};
            add(scene, solidOfDensity(lightShape(dice, size), at, density, matter));
        }
    if (!closes) {
        const float width = 0.9f * half;
        const double top =
            (layers + 0.6) * static_cast<double>(pitch) + 0.3 + static_cast<double>(dice.between(0, 1.5f));
        add(scene, solidOfDensity(Box{{width, 0.3f, width}}, {0, top, 0}, magnitude(dice, 1000, 20000), matter));
    }
    drawn.seconds = 8;
    return drawn;
}

}  // namespace ragtop::laws
