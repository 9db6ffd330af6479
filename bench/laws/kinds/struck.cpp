#include "parts.h"

namespace ragtop::laws {
namespace {

/// What a figure is made with: its links shrink in mass from the first to the last of each limb.
struct Growth {
    float size = 1;      ///< m, of a limb
    float mass = 1;      ///< kg, of its trunk
    float lighter = 1;   ///< each link than the one before
    float width = 1;     ///< rad, of its limits
    float friction = 0;  ///< N m
    bool hinges = false, limits = false;
    const Material& skin;
};

BodyDef limbBody(const DVec3& from, const Vec3& direction, float length, float radius, float mass,
                 const Material& skin) {
    const float half = std::max(0.5f * length - radius, 0.1f * length);
    const Vec3 middle = 0.5f * length * direction;
    BodyDef def = solidBody(Capsule{radius, half}, from + DVec3{middle}, mass, skin);
    def.pose.rotation = rotationBetween({0, 1, 0}, direction);
    def.shapes[0].filter.group = -1;
    return def;
}

void addLimb(Scene& scene, Dice& dice, const Growth& growth, int trunk, DVec3 from, const Vec3& direction, int links) {
    const float length = growth.size / static_cast<float>(links);
    const float radius = dice.between(0.08f, 0.3f) * length;
    float mass = growth.mass;
    int parent = trunk;
    for (int i = 0; i < links; ++i) {
        mass /= growth.lighter;
        const int link = add(scene, limbBody(from, direction, length, radius, mass, growth.skin));
        const float friction = growth.friction * mass * 9.81f * length;
        if (growth.hinges && i % 2 == 1) {
            const Vec3 across =
                normalized(cross(direction, std::abs(direction.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
            HingeDef& hinge = addHinge(scene, parent, link, from, across);
            hinge.friction = friction;
            if (growth.limits) hinge.limit = Range{-0.05f, growth.width};
        } else {
            BallDef ball;
            ball.bodies = jointFrames(scene, parent, link, from, direction);
            ball.friction = friction;
            if (growth.limits)
                ball.swingLimit = growth.width, ball.twistLimit = Range{-0.5f * growth.width, 0.5f * growth.width};
            scene.joints.push_back({{}, parent, link, ball});
        }
        from = from + DVec3{length * direction};
        parent = link;
    }
}

/// A trunk with limbs to all sides. Parts of it pass through each other.
void addStar(Scene& scene, Dice& dice, float size, const DVec3& at, const Material& skin) {
    const int limbs = 1 + static_cast<int>(dice.below(6)), links = 1 + static_cast<int>(dice.below(5));
    const float ratio = magnitude(dice, 1, 1000);
    Growth growth{.size = size, .skin = skin};
    const float scale = growth.size * growth.size * growth.size;
    growth.mass = magnitude(dice, 30, 3000) * scale;
    growth.lighter = std::pow(ratio, 1 / static_cast<float>(links));
    growth.limits = dice.below(4) != 0;
    growth.width = coin(dice) ? dice.between(0.06f, 0.3f) : dice.between(0.3f, 1.4f);
    growth.hinges = coin(dice);
    growth.friction = oneOf(dice, {0.0f, 0.1f, 2.0f});
    const float radius = dice.between(0.1f, 0.3f) * growth.size;
    BodyDef def = solidBody(Sphere{radius}, at, growth.mass, skin);
    def.shapes[0].filter.group = -1;
    const int trunk = add(scene, std::move(def));
    for (int limb = 0; limb < limbs; ++limb) {
        const Vec3 direction = anyDirection(dice);
        addLimb(scene, dice, growth, trunk, at + DVec3{radius * direction}, direction, links);
    }
}

}  // namespace

/// The ball flies at a part of the figure, from so far that it has not met any.
Drawn drawStruck(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material skin = surface(0.6f, oneOf(dice, {0.0f, 0.0f, 0.5f}));
    const float size = magnitude(dice, 0.05f, 1), reach = 1.3f * size;  // of a limb, and of one beyond the trunk
    const DVec3 at{0, static_cast<double>(dice.between(1, 2) * reach), 0};
    if (coin(dice))
        scene.settings.gravity = {};
    else
        addFloor(scene, skin);
    const std::size_t first = scene.bodies.size();
    addStar(scene, dice, size, at, skin);
    const std::size_t parts = scene.bodies.size() - first;
    const DVec3 aim = scene.bodies[first + dice.below(static_cast<std::uint32_t>(parts))].def.pose.position;
    const float mass = magnitude(dice, 0.1f, 100), radius = std::cbrt(mass / 4189.0f), speed = magnitude(dice, 1, 40);
    Vec3 way = anyDirection(dice);
    way.y = -std::abs(way.y);
    const float away = 2.2f * reach + radius;  // from any part, wherever it aims at
    BodyDef ball = solidBody(Sphere{radius}, aim + DVec3{-away * way}, mass, skin);
    ball.linearVelocity = speed * way;
    add(scene, std::move(ball));
    return drawn;
}

}  // namespace ragtop::laws
