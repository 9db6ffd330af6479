#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../stability/engine.h"
#include "../../stability/limit_analysis.h"
#include "parts.h"

namespace ragtop::laws {
namespace {

/// What a structure is made of.
struct Stones {
    Scene& scene;
    Dice& dice;
    Material material;
    float least = 1000, most = 1000;  ///< kg/m³

    void box(const Vec3& half, const DVec3& at) { add(scene, solidOfDensity(Box{half}, at, density(), material)); }
    void hull(std::span<const DVec3> outline, float depth) {
        DVec3 middle;
        for (const DVec3& corner : outline) middle = middle + (1.0 / static_cast<double>(outline.size())) * corner;
        std::vector<Vec3> points;
        for (const DVec3& corner : outline)
            for (const float side : {-0.5f, 0.5f}) points.push_back(toVec3(corner - middle) + Vec3{0, 0, side * depth});
        add(scene, solidOfDensity(ConvexHull{points}, middle, density(), material));
    }
    float density() { return least < most ? magnitude(dice, least, most) : least; }
};

/// Courses of bricks of any length, some left out, each a little in front of or behind the others.
void addWall(Stones stones) {
    Dice& dice = stones.dice;
    const float height = magnitude(dice, 0.1f, 0.8f), depth = height * dice.between(0.8f, 2),
                aside = dice.between(0, 0.3f);
    const float length = height * dice.between(3, 10), open = coin(dice) ? 0.0f : 0.15f;
    const int courses = 3 + static_cast<int>(dice.below(10));
    for (int course = 0; course < courses; ++course) {
        float x = -0.5f * length;
        while (x < 0.5f * length - 0.1f * height) {
            const float end = std::min(0.5f * length, x + height * dice.between(0.7f, 3)),
                        z = aside * depth * dice.between(-0.5f, 0.5f);
            if (dice.between(0, 1) >= open)
                stones.box({0.5f * (end - x) - 0.001f * height, 0.5f * height, 0.5f * depth},
                           {0.5 * static_cast<double>(x + end), (course + 0.5) * static_cast<double>(height),
                            static_cast<double>(z)});
            x = end;
        }
    }
}

/// One stone of any size on another, anywhere on it.
void addCairn(Stones stones) {
    Dice& dice = stones.dice;
    const float size = magnitude(dice, 0.1f, 1);
    const int count = 3 + static_cast<int>(dice.below(14));
    const float aside = dice.between(0, 0.5f);
    double y = 0, x = 0, z = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3 half{size * dice.between(0.3f, 1), size * dice.between(0.1f, 0.6f), size * dice.between(0.3f, 1)};
        stones.box(half, {x, y + static_cast<double>(half.y), z});
        y += 2 * static_cast<double>(half.y);
        x += static_cast<double>(aside * half.x * dice.between(-1, 1));
        z += static_cast<double>(aside * half.z * dice.between(-1, 1));
    }
}

/// Two piers and what lies on them, with the same on top, narrower.
void addPortals(Stones stones) {
    Dice& dice = stones.dice;
    const float size = magnitude(dice, 0.1f, 0.5f);
    float span = size * dice.between(3, 8), y = 0;
    for (int level = 0; level <= static_cast<int>(dice.below(4)); ++level) {
        const int stonesOfPier = 1 + static_cast<int>(dice.below(5));
        const float half = 0.5f * size * dice.between(0.7f, 1.3f), beam = 0.5f * size * dice.between(0.3f, 1.2f);
        for (int i = 0; i < stonesOfPier; ++i, y += 2 * half)
            for (const float side : {-0.5f, 0.5f})
                stones.box({0.5f * size, half, 0.5f * size}, {DVec3{Vec3{side * span, y + half, 0}}});
        stones.box({0.5f * span + size * dice.between(0, 1), beam, 0.5f * size},
                   DVec3{Vec3{size * dice.between(-0.3f, 0.3f), y + beam, 0}});
        y += 2 * beam;
        span = std::max(1.2f * size, span * dice.between(0.4f, 0.9f));
    }
}

/// A round or a flat arch of as many stones as one likes, thick or thin, between the floor's two ends.
void addArc(Stones stones) {
    Dice& dice = stones.dice;
    const int count = 3 + static_cast<int>(dice.below(15));
    const double inner = static_cast<double>(magnitude(dice, 0.5f, 4)),
                 outer = inner * static_cast<double>(dice.between(1.08f, 1.5f));
    const float depth = static_cast<float>(inner) * dice.between(0.15f, 0.5f);
    const auto corner = [&](double radius, int joint) {
        const double angle = std::numbers::pi * joint / count;
        return DVec3{radius * std::cos(angle), joint % count == 0 ? 0 : radius * std::sin(angle), 0};
    };
    for (int i = 0; i < count; ++i)
        stones.hull(std::vector{corner(inner, i), corner(outer, i), corner(outer, i + 1), corner(inner, i + 1)}, depth);
}

/// Planks that reach further and further out, with weights on their other ends.
void addCorbel(Stones stones) {
    Dice& dice = stones.dice;
    const float size = magnitude(dice, 0.1f, 0.6f), length = size * dice.between(2, 4), out = dice.between(0.05f, 0.5f);
    const int count = 2 + static_cast<int>(dice.below(6));
    float x = 0, y = 0;
    for (int i = 0; i < count; ++i, y += size, x += out * length * dice.between(0, 0.5f))
        stones.box({0.5f * length, 0.5f * size, 0.5f * size}, DVec3{Vec3{x, y + 0.5f * size, 0}});
    const int weights = static_cast<int>(dice.below(4));
    for (int i = 0; i < weights; ++i, y += size)
        stones.box({0.5f * size, 0.5f * size, 0.5f * size},
                   DVec3{Vec3{x - length * dice.between(0.2f, 0.5f), y + 0.5f * size, 0}});
}

/// Pairs of plates that lean against each other, side by side, a plate on two tops.
void addCards(Stones stones) {
    Dice& dice = stones.dice;
    const float length = magnitude(dice, 0.2f, 2), thick = length * dice.between(0.02f, 0.15f),
                depth = length * dice.between(0.3f, 1);
    const SinCos lean = sinCos(dice.between(0.15f, 0.7f));
    const float a = 0.5f * length, b = 0.5f * thick, reach = b * lean.cos + a * lean.sin,
                foot = b * lean.sin + a * lean.cos;
    const int pairs = 1 + static_cast<int>(dice.below(4));
    for (int i = 0; i < pairs; ++i)
        for (const float side : {-1.0f, 1.0f}) {
            const Vec3 at{4 * reach * static_cast<float>(i) + side * reach, foot, 0};
            stones.box({b, a, 0.5f * depth}, DVec3{at});
            stones.scene.bodies.back().def.pose.rotation =
                Quat{0, 0, side * std::sqrt(0.5f * (1 - lean.cos)), std::sqrt(0.5f * (1 + lean.cos))};
        }
    const float top = 2 * foot;
    if (pairs > 1 && coin(dice)) stones.box({0.6f * length, b, 0.5f * depth}, DVec3{Vec3{2 * reach, top + b, 0}});
}

/// What limit analysis says of the contacts of a scene's first millisecond.
class Statics {
public:
    explicit Statics(const Scene& scene) : friction_(scene.bodies[0].def.shapes[0].material.friction) {
        WorldSettings settings;
        settings.gravity = scene.settings.gravity;
        World world(settings);
        const SceneInstance made(scene, world);
        for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
            const MassProperties mass = stability::massOf(scene.bodies[i].def);
            blocks_.push_back({static_cast<double>(mass.mass) * stability::kGravity,
                               transformPoint(scene.bodies[i].def.pose, mass.center)});
        }
        world.step(1e-3);
        const auto blockOf = [&](BodyId body) {
            return static_cast<int>(std::ranges::find(made.bodies, body) - made.bodies.begin()) - 1;
        };
        world.forEachContact([&](const Contact& contact) {
            const Vec3& n = contact.normal;
            stability::Joint joint{blockOf(contact.bodyA), blockOf(contact.bodyB), {}, DVec3{n}, {}};
            const Vec3 across = std::abs(n.y) > 0.5f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
            joint.tangent = DVec3{normalized(across - dot(across, n) * n)};
            for (int i = 0; i < contact.pointCount; ++i)
                if (contact.points[i].separation < 1e-4f) joint.points.push_back(contact.points[i].point);
            if (!joint.points.empty()) joints_.push_back(joint);
        });
    }
    /// With friction and weights that lean aside, by so much of themselves.
    bool stands(float share, const Vec3& aside) const {
        stability::LimitAnalysis limit(8);
        for (const Block& block : blocks_) {
            const int i = limit.addBlock(block.weight, block.center);
            limit.addForce(i, block.weight * DVec3{aside}, block.center);
        }
        for (const stability::Joint& joint : joints_) limit.addJoint(joint);
        return limit.stands(static_cast<double>(share * friction_));
    }

private:
    struct Block {
        double weight;
        DVec3 center;
    };
    float friction_;
    std::vector<Block> blocks_;
    std::vector<stability::Joint> joints_;
};

/// Does it stand, or fall, whatever its friction and its weights are off by? What has gaps at its sides may lean into
/// them and stand.
void judge(Drawn& drawn, bool hasGaps) {
    constexpr float kLean = 0.03f, kLess = 0.9f, kMore = 1.2f;  // the pyramid inside a cone has 0.92 of it
    const Vec3 leans[] = {{}, {kLean, 0, 0}, {-kLean, 0, 0}, {0, 0, kLean}, {0, 0, -kLean}};
    const Statics statics(drawn.scene);
    const auto stands = [&](float share) {
        return [&statics, share](const Vec3& lean) { return statics.stands(share, lean); };
    };
    try {
        drawn.stands = std::ranges::all_of(leans, stands(kLess));
        drawn.falls = !hasGaps && std::ranges::none_of(leans, stands(kMore));
    } catch (const stability::Missing&) {
        // Without limit analysis the other laws are left.
    }
}

}  // namespace

Drawn drawMasonry(Dice& dice) {
    Drawn drawn;
    drawn.seconds = 20;
    const float friction = magnitude(dice, 0.2f, 1.2f);
    const Material material = surface(friction);
    Scene& scene = drawn.scene;
    addFloor(scene, material);
    Stones stones{scene, dice, material};
    if (coin(dice)) stones.least = 100, stones.most = oneOf(dice, {1000.0f, 10000.0f});
    const auto build = oneOf(dice, {addWall, addCairn, addPortals, addArc, addCorbel, addCards});
    build(stones);
    stability::Slope slope;
    if (coin(dice)) {
        slope.theta = std::atan(static_cast<double>(friction * dice.between(0, 1)));
        slope.heading = static_cast<double>(dice.between(0, 6));
    }
    for (SceneBody& body : scene.bodies) body.def = onSlope(slope, body.def);
    judge(drawn, build == addWall);
    return drawn;
}

}  // namespace ragtop::laws
