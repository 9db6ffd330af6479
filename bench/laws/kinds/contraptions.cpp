#include "parts.h"

namespace ragtop::laws {
namespace {

constexpr float kWholeTurn = 6.2831853f;

/// Some convex shape; `reach` is how far its surface is from its middle along its x axis, m.
Shape anyShape(Dice& dice, float size, float& reach) {
    reach = size;
    switch (dice.below(3)) {
        case 0:
            return Sphere{size};
        case 1:
            return Box{{size, size * dice.between(0.25f, 1), size * dice.between(0.25f, 1)}};
        default: {
            const float radius = size * dice.between(0.25f, 0.75f);
            return Capsule{radius, size - radius};
        }
    }
}

/// Turns x of the shape to `direction`, or its y, along which a capsule lies.
Quat towards(const Shape& shape, const Vec3& direction) {
    const bool alongY = std::holds_alternative<Capsule>(shape);
    return rotationBetween(alongY ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, direction);
}

void addAnyJoint(Scene& scene, Dice& dice, int a, int b, const DVec3& point, const Vec3& axis) {
    switch (dice.below(3)) {
        case 0:
            addBall(scene, a, b, point);
            break;
        case 1: {
            BallDef def;
            def.bodies = jointFrames(scene, a, b, point, axis);
            def.swingLimit = dice.between(0.3f, 1.5f);
            def.friction = magnitude(dice, 0.1f, 10);
            scene.joints.push_back({{}, a, b, def});
            break;
        }
        default: {
            HingeDef& hinge = addHinge(scene, a, b, point, axis);
            hinge.limit = Range{-dice.between(0.1f, 1.5f), dice.between(0.1f, 1.5f)};
        }
    }
}

}  // namespace

Drawn drawContraption(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material matter = surface(0.5f);
    addFloor(scene, matter);
    const int count = 3 + static_cast<int>(dice.below(40));
    const double height = static_cast<double>(dice.between(4, 7));
    std::vector<float> reaches;
    std::vector<int> members;
    for (int i = 0; i < count; ++i) {
        float reach = 0;
        const float size = dice.between(0.1f, 0.5f);
        Shape shape = anyShape(dice, size, reach);
        DVec3 at{0, height, 0};
        Vec3 direction = anyDirection(dice);
        int parent = -1;
        if (i > 0) {
            parent = static_cast<int>(dice.below(static_cast<std::uint32_t>(i)));
            if (direction.y < -0.5f) direction.y = -direction.y;  // upwards, so that it begins above the floor
            const auto p = static_cast<std::size_t>(parent);
            at = scene.bodies[static_cast<std::size_t>(members[p])].def.pose.position +
                 static_cast<double>(reaches[p] + reach) * DVec3{direction};
        }
        BodyDef def = solidOfDensity(shape, at, magnitude(dice, 500, 50000), matter);
        def.pose.rotation = towards(shape, direction);
        reaches.push_back(reach);
        members.push_back(add(scene, std::move(def)));
        if (parent < 0) continue;
        const auto p = static_cast<std::size_t>(parent);
        const DVec3 point = at - static_cast<double>(reach) * DVec3{direction};
        addAnyJoint(scene, dice, members[p], members.back(), point, anyDirection(dice));
    }
    const std::uint32_t loops = dice.below(static_cast<std::uint32_t>(count / 2 + 1));
    for (std::uint32_t i = 0; i < loops; ++i) {
        const std::uint32_t a = dice.below(static_cast<std::uint32_t>(count)), b = dice.below(static_cast<std::uint32_t>(count));
        if (a == b) continue;
        const auto place = [&](std::uint32_t k) { return scene.bodies[static_cast<std::size_t>(members[k])].def.pose.position; };
        addAnyJoint(scene, dice, members[a], members[b], 0.5 * (place(a) + place(b)), anyDirection(dice));
    }
    const std::uint32_t boxes = dice.below(6);
    for (std::uint32_t i = 0; i < boxes; ++i) {
        const float half = dice.between(0.1f, 0.5f);
        const DVec3 at{static_cast<double>(dice.between(-1, 1)), height + 12 + 1.5 * i, static_cast<double>(dice.between(-1, 1))};
        add(scene, solidOfDensity(Box{{half, half, half}}, at, magnitude(dice, 500, 5000), matter));
    }
    drawn.seconds = 8;
    return drawn;
}

Drawn drawHeap(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material matter = surface(dice.between(0.2f, 0.9f));
    addFloor(scene, matter);
    const int count = 20 + static_cast<int>(dice.below(100));
    const float ratio = oneOf(dice, {1.0f, 30.0f, 1000.0f}), sizes = oneOf(dice, {1.5f, 5.0f, 20.0f});
    for (int i = 0; i < count; ++i) {
        float reach = 0;
        const float size = magnitude(dice, 0.5f / sizes, 0.5f);
        Shape shape = anyShape(dice, size, reach);
        const DVec3 at{static_cast<double>(dice.between(-1, 1)), 1 + 1.1 * (i / 2), static_cast<double>(dice.between(-1, 1)) + (i % 2) * 2.2};
        BodyDef def = solidOfDensity(shape, at, magnitude(dice, 100, 100 * ratio), matter);
        def.pose.rotation = dice.rotation();
        def.angularVelocity = {kWholeTurn * dice.between(-0.5f, 0.5f), 0, 0};
        add(scene, std::move(def));
    }
    drawn.seconds = 10;
    return drawn;
}

}  // namespace ragtop::laws
