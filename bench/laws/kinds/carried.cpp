#include <algorithm>
#include <numbers>

#include "parts.h"

namespace ragtop::laws {
namespace {

constexpr float kFriction = 0.5f;

/// Up to which acceleration, of g, along x and along z statics lets a structure stand.
struct Stands {
    float x = 0, z = 0;
};

/// Tips as a whole about the edge of its lowest box where its middle, count/2 high, leaves the box, half a width away.
Stands addStack(Scene& scene, Dice& dice, const Material& material) {
    const int count = oneOf(dice, {5, 10, 20, 40});
    for (int i = 0; i < count; ++i) add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5 + i, 0}, 1, material));
    const float most = std::min(kFriction, 1.0f / static_cast<float>(count));
    return {most, most};
}

/// Along the wall the line of each load stays within its slope, one half to one, as long as nothing slides; across it
/// the pyramid tips like the stack that it is one box thick.
Stands addPyramid(Scene& scene, Dice& dice, const Material& material) {
    const int base = oneOf(dice, {4, 8});
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {(i - (base - row - 1) / 2.0) * 1.02, 0.5 + row, 0}, 1, material));
    if (coin(dice)) add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, base + 0.5, 0}, 300, material));
    return {kFriction / 4, 0};
}

/// As a stack of two, at the most.
Stands addHeavyOnLight(Scene& scene, Dice& dice, const Material& material) {
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, material));
    const float mass = magnitude(dice, 10, 10000);
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 1.5, 0}, mass, material));
    // The middle of both is (0.5 + 1.5 m)/(1 + m) high, half a width from the edge.
    const float most = std::min(kFriction, 0.5f * (1 + mass) / (0.5f + 1.5f * mass));
    return {most, most};
}

/// A round arch of voussoirs thicker than the least that stands, 0.106 radii: nothing is left for pushing it sideways.
Stands addArch(Scene& scene, Dice& dice, const Material& material) {
    const int stones = oneOf(dice, {7, 11, 15});
    const double inner = 4, outer = inner * static_cast<double>(dice.between(1.2f, 1.5f));
    const auto corner = [&](double radius, int joint) {
        const double angle = std::numbers::pi * joint / stones;
        return DVec3{radius * std::cos(angle), joint % stones == 0 ? 0 : radius * std::sin(angle), 0};
    };
    for (int i = 0; i < stones; ++i) {
        const DVec3 corners[] = {corner(inner, i), corner(outer, i), corner(outer, i + 1), corner(inner, i + 1)};
        DVec3 middle;
        for (const DVec3& c : corners) middle = middle + 0.25 * c;
        std::vector<Vec3> hull;
        for (const DVec3& c : corners)
            for (const float z : {-0.5f, 0.5f}) hull.push_back(toVec3(c - middle) + Vec3{0, 0, z});
        add(scene, solidOfDensity(ConvexHull{hull}, middle, 1000, material));
    }
    return {};
}

/// What carries it, body 0: it is at rest or moves evenly, drifts as a raft, or speeds up and brakes.
void addPlatform(Scene& scene, const Vec3& v, bool isRaft) {
    constexpr float kHalf = 20;
    const Material matter = surface(kFriction);
    BodyDef platform = fixedBody(Box{{kHalf, 1, kHalf}}, {0, -1, 0}, matter);
    platform.type = isRaft ? BodyType::dynamic : BodyType::kinematic;
    if (isRaft) platform.shapes[0].density = 1000;
    platform.linearVelocity = v;
    add(scene, std::move(platform));
}

/// Ice that a raft drifts over, for as long as it is watched.
void addIce(Scene& scene, float speed, double seconds) {
    const float half = 40 + 2 * speed * static_cast<float>(seconds);
    add(scene, fixedBody(Box{{half, 1, half}}, {0, -3, 0}, surface(0)));
}

}  // namespace

Drawn drawCarried(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    drawn.stands = true;
    drawn.seconds = 20;
    const float speed = oneOf(dice, {0.0f, 0.1f, 2.0f, 10.0f, 50.0f});
    const int way = static_cast<int>(dice.below(3));
    const bool isRaft = way == 1, speedsUp = way == 2;
    const Vec3 v{speed * dice.between(-1, 1), !isRaft && coin(dice) ? 0.25f * speed : 0.0f, speed};
    addPlatform(scene, v, isRaft);
    const Material matter = surface(kFriction);
    const Stands stands = oneOf(dice, {addStack, addPyramid, addHeavyOnLight, addArch})(scene, dice, matter);
    for (SceneBody& body : scene.bodies) body.def.linearVelocity = v;
    if (isRaft) addIce(scene, speed, drawn.seconds);
    if (speedsUp) {
        // A lorry by up to nine tenths of what statics lets stand, a lift by up to 0.3 g, or both.
        const float g = static_cast<float>(stability::kGravity), lift = coin(dice) ? dice.between(-0.3f, 0.3f) : 0.0f;
        const float sideways = 0.9f * (1 - std::abs(lift)) * oneOf(dice, {0.0f, 0.5f, 1.0f});
        const float turn = dice.between(-0.7f, 0.7f);
        const Vec3 along{sideways * stands.x * std::sqrt(1 - turn * turn), lift, sideways * stands.z * turn};
        drawn.rides.push_back(
            {.body = 0, .start = v, .acceleration = g * along, .phase = static_cast<double>(dice.between(1, 4))});
    }
    return drawn;
}

}  // namespace ragtop::laws
