#include "parts.h"

namespace ragtop::laws {
namespace {

/// A limb from one point to another.
struct Limb {
    int parent;
    DVec3 from, to;
    float radius, swing;
};

/// A man of 1.8 m with outstretched arms, from the pelvis outwards.
constexpr int kLeftHand = 5;
const std::vector<Limb>& limbs() {
    static const std::vector<Limb> kLimbs{
        {-1, {0, 0.95, 0}, {0, 1.15, 0}, 0.13f, 0},            // pelvis
        {0, {0, 1.15, 0}, {0, 1.45, 0}, 0.14f, 0.5f},          // chest
        {1, {0, 1.55, 0}, {0, 1.72, 0}, 0.09f, 0.6f},          // head
        {1, {-0.2, 1.42, 0}, {-0.48, 1.42, 0}, 0.05f, 1.5f},   // left arm
        {3, {-0.48, 1.42, 0}, {-0.72, 1.42, 0}, 0.04f, 1.3f},  // left forearm
        {4, {-0.72, 1.42, 0}, {-0.84, 1.42, 0}, 0.035f, 0.8f}, // left hand
        {1, {0.2, 1.42, 0}, {0.48, 1.42, 0}, 0.05f, 1.5f},     // right arm
        {6, {0.48, 1.42, 0}, {0.72, 1.42, 0}, 0.04f, 1.3f},    // right forearm
        {7, {0.72, 1.42, 0}, {0.84, 1.42, 0}, 0.035f, 0.8f},   // right hand
        {0, {-0.1, 0.92, 0}, {-0.1, 0.5, 0}, 0.08f, 1.2f},     // left thigh
        {9, {-0.1, 0.5, 0}, {-0.1, 0.1, 0}, 0.06f, 1.2f},      // left shank
        {10, {-0.1, 0.08, 0}, {-0.1, 0.05, 0.16}, 0.04f, 0.5f},
        {0, {0.1, 0.92, 0}, {0.1, 0.5, 0}, 0.08f, 1.2f},       // right thigh
        {12, {0.1, 0.5, 0}, {0.1, 0.1, 0}, 0.06f, 1.2f},       // right shank
        {13, {0.1, 0.08, 0}, {0.1, 0.05, 0.16}, 0.04f, 0.5f},
    };
    return kLimbs;
}

/// Parts collide with what they are not joined to by the filter of one group.
void addHuman(Scene& scene, Dice& dice, const Material& skin, float spring) {
    const int first = static_cast<int>(scene.bodies.size());
    const float friction = oneOf(dice, {0.0f, 0.5f, 3.0f});
    for (const Limb& limb : limbs()) {
        const DVec3 way = limb.to - limb.from;
        const double length = std::sqrt(dot(way, way));
        BodyDef def = solidOfDensity(Capsule{limb.radius, static_cast<float>(length / 2)}, 0.5 * (limb.from + limb.to) + DVec3{0, 3, 0}, 1000, skin);
        def.pose.rotation = rotationBetween({0, 1, 0}, toVec3((1 / length) * way));
        def.shapes[0].filter.group = -1;
        const int body = add(scene, std::move(def));
        if (limb.parent < 0) continue;
        BallDef joint;
        joint.bodies = jointFrames(scene, first + limb.parent, body, limb.from + DVec3{0, 3, 0}, toVec3((1 / length) * way));
        joint.swingLimit = limb.swing;
        joint.twistLimit = Range{-0.7f, 0.7f};
        joint.friction = friction;
        if (spring > 0) joint.spring = Spring{.stiffness = spring, .damping = 0};
        scene.joints.push_back({{}, first + limb.parent, body, joint});
    }
}

}  // namespace

Drawn drawFigure(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material skin = surface(0.6f);
    addFloor(scene, skin, {0, -5, 0});
    const std::uint32_t way = dice.below(4);
    const bool stiff = way == 3;
    const float spring = stiff ? magnitude(dice, 100, 1e6f) : 0.0f;
    const int first = static_cast<int>(scene.bodies.size());
    addHuman(scene, dice, skin, spring);
    const DVec3 hand = limbs()[kLeftHand].to + DVec3{0, 3, 0};
    if (way == 0) {  // hangs
        addBall(scene, kWorld, first + kLeftHand, hand);
    } else if (way == 1) {  // is shaken
        BodyDef grip = solidBody(Box{{0.02f, 0.02f, 0.02f}}, hand, 1, skin);
        grip.type = BodyType::kinematic;
        grip.shapes[0].filter.group = -1;
        const int body = add(scene, std::move(grip));
        addBall(scene, body, first + kLeftHand, hand);
        drawn.shakers.push_back({body, dice.between(0.3f, 1), 1});
    } else {  // is thrown
        const Vec3 spin{dice.between(-8, 8), dice.between(-8, 8), dice.between(-8, 8)};
        const DVec3 pelvis = scene.bodies[static_cast<std::size_t>(first)].def.pose.position;
        for (std::size_t i = static_cast<std::size_t>(first); i < scene.bodies.size(); ++i) {
            BodyDef& def = scene.bodies[i].def;
            def.angularVelocity = spin;
            def.linearVelocity = Vec3{0, 2, 0} + cross(spin, toVec3(def.pose.position - pelvis));
        }
        if (stiff) scene.settings.gravity = {};
    }
    return drawn;
}

}  // namespace ragtop::laws
