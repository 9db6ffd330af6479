#include "parts.h"

namespace ragtop::laws {
namespace {

/// A rope between corners of two bodies that are not turned, `slack` longer than the way; the world's frame is its own.
void addRope(Scene& scene, int a, const Vec3& inA, int b, const Vec3& inB, float slack) {
    const auto place = [&](int body, const Vec3& local) {
        return body == kWorld ? DVec3{local}
                              : scene.bodies[static_cast<std::size_t>(body)].def.pose.position + DVec3{local};
    };
    const DVec3 way = place(b, inB) - place(a, inA);
    DistanceDef rope;
    rope.bodies.frameA.position = inA;
    rope.bodies.frameB.position = inB;
    rope.limit = Range{0, slack * static_cast<float>(std::sqrt(dot(way, way)))};
    scene.joints.push_back({.bodyA = a, .bodyB = b, .def = rope});
}

Vec3 anyWay(Dice& dice, float most) {
    return {dice.between(-most, most), dice.between(-most, most), dice.between(-most, most)};
}

/// On handles at its corners and beyond.
void hangOne(Scene& scene, Dice& dice, const Material& wood) {
    const Vec3 half{dice.between(0.1f, 1), dice.between(0.1f, 1), dice.between(0.1f, 1)};
    const DVec3 at{0, 15, 0};
    BodyDef def = solidOfDensity(Box{half}, at, 1000, wood);
    def.linearVelocity = anyWay(dice, 6);
    def.angularVelocity = anyWay(dice, 4);
    const int body = add(scene, std::move(def));
    for (int ropes = 1 + static_cast<int>(dice.below(4)); ropes > 0; --ropes) {
        const auto side = [&] { return (coin(dice) ? 1.0f : -1.0f) * (dice.below(4) == 0 ? 2.0f : 1.0f); };
        const Vec3 handle{side() * half.x, side() * half.y, side() * half.z};
        const Vec3 up = normalized(Vec3{dice.between(-1, 1), dice.between(0.2f, 1), dice.between(-1, 1)});
        addRope(scene, kWorld, toVec3(at) + handle + dice.between(1, 3) * up, body, handle, dice.between(1, 1.4f));
    }
}

/// Rungs below each other on two ropes or four; boxes lie on the lowest.
void hangLadder(Scene& scene, Dice& dice, const Material& wood) {
    const int rungs = 1 + static_cast<int>(dice.below(8)), ropes = coin(dice) ? 2 : 4;
    const float last = magnitude(dice, 0.05f, 20), speed = dice.between(0, 4);
    int above = kWorld;
    Vec3 halfAbove{0.6f, 0, 0.3f};
    DVec3 at{0, 20, 0};
    for (int i = 0; i < rungs; ++i) {
        const Vec3 half{dice.between(0.4f, 1), dice.between(0.03f, 0.3f), dice.between(0.2f, 0.4f)};
        const float length = dice.between(0.4f, 1.5f), slack = dice.between(1, 1.5f);
        at.y -= static_cast<double>(halfAbove.y + length + half.y);
        BodyDef def = solidOfDensity(Box{half}, at, i + 1 == rungs ? 1000 * last : 1000, wood);
        def.linearVelocity = anyWay(dice, speed);
        const int rung = add(scene, std::move(def));
        for (int rope = 0; rope < ropes; ++rope) {
            const float x = rope % 2 == 0 ? 1.0f : -1.0f, z = ropes == 2 ? 0.0f : (rope < 2 ? 1.0f : -1.0f);
            const Vec3 inAbove = above == kWorld ? Vec3{x * halfAbove.x, 20, z * halfAbove.z}
                                                 : Vec3{x * halfAbove.x, -halfAbove.y, z * halfAbove.z};
            addRope(scene, above, inAbove, rung, {x * half.x, half.y, z * half.z}, slack);
        }
        above = rung, halfAbove = half;
    }
    for (int boxes = static_cast<int>(dice.below(5)); boxes > 0; --boxes) {
        const float size = dice.between(0.05f, 0.2f);
        const double y = at.y + static_cast<double>(halfAbove.y + size) + 0.5 * boxes;
        add(scene, solidOfDensity(Box{{size, size, size}}, {at.x, y, at.z}, magnitude(dice, 100, 10000), wood));
    }
}

}  // namespace

Drawn drawHung(Dice& dice) {
    Drawn drawn;
    const Material wood = surface(0.6f);
    addFloor(drawn.scene, wood, {0, -20, 0});
    if (coin(dice))
        hangOne(drawn.scene, dice, wood);
    else
        hangLadder(drawn.scene, dice, wood);
    drawn.seconds = 8;
    return drawn;
}

}  // namespace ragtop::laws
