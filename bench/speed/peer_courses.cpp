#include <cmath>

#include "builder.h"
#include "courses.h"

namespace ragtop::speed {

Course makePyramid() {
    Builder b("pyramid");
    b.ground(100);
    addPyramid(b, {}, 30);
    return {std::move(b.scene), {{"pyramid", 300}}};
}

/// Four walls of 25 courses of bricks laid dry, each corner in bond; then a ball of 5 t at 25 m/s.
Course makeBrickHouse() {
    Builder b("brick_house");
    b.ground(100);
    b.brickHouse(25);
    Builder ball("ball");
    ball.moving(Sphere{0.8f}, 2331.4f, {.position = {0, 2.5, -(8.24 / 2 + 2.5)}, .velocity = {0, 0, 25}});
    return {std::move(b.scene), {{"brick_house_settle", 120}, {"brick_house_smash", 240, {ball.scene.bodies[0].def}}}};
}

Course makeRagdollPile() {
    Builder b("ragdoll_pile");
    b.pit(8);
    PeerDice dice(7);
    for (int layer = 0; layer < 20; ++layer)
        for (int i = 0; i < 10; ++i) {
            const double x = (i % 5 - 2) * 1.45, z = i / 5 == 1 ? 1.7 : -1.7;
            const float yaw = dice.between(-0.3f, 0.3f) + (layer % 2 == 1 ? kPi : 0);
            const float lean = 1.57079633f + dice.between(-0.1f, 0.1f);
            const Quat rotation = rotationAbout({0, 1, 0}, yaw) * rotationAbout({1, 0, 0}, lean);
            const float dx = dice.between(-0.05f, 0.05f), dz = dice.between(-0.05f, 0.05f);
            addRagdoll(b, DVec3{x, 1.0 + layer * 0.7, z} + Vec3{dx, 0, dz}, rotation);
        }
    return {std::move(b.scene), {{"ragdoll_pile", 600}}};
}

namespace {

/// A box of random size and rotation, drawn in the order of the other engines' scene.
void addBoxOfPile(Builder& b, PeerDice& dice, const DVec3& cell) {
    const auto size = [&] { return dice.between(0.2f, 0.6f); };
    const float hx = size(), hy = size(), hz = size();
    const float angle = dice.between(0, 3);
    const Vec3 axis = dice.inCube() + Vec3{0, 0, 0.01f};
    const float dx = dice.between(-0.05f, 0.05f), dz = dice.between(-0.05f, 0.05f);
    b.moving(Box{{hx, hy, hz}}, 1000, {.position = cell + Vec3{dx, 0, dz}, .rotation = rotationAbout(axis, angle)});
}

}  // namespace

Course makeBoxPile() {
    Builder b("box_pile");
    b.pit(12);
    PeerDice dice(11);
    for (int i = 0; i < 2000; ++i) {
        const int layer = i / 64, k = i % 64;
        addBoxOfPile(b, dice, {(k % 8 - 3.5) * 1.4, 1.2 + layer * 1.5, (k / 8 - 3.5) * 1.4});
    }
    return {std::move(b.scene), {{"box_pile", 600}}};
}

Course makeScaling(int bodies) {
    constexpr int kLayers = 16;
    const int side = static_cast<int>(std::ceil(std::sqrt(bodies / static_cast<double>(kLayers))));
    Builder b("scaling_" + std::to_string(bodies / 1000) + "k");
    b.pit(1.4f * static_cast<float>(side) + 0.8f);
    PeerDice dice(19);
    for (int i = 0; i < bodies; ++i) {
        const int layer = i / (side * side), k = i % (side * side);
        const double middle = (side - 1) * 0.5;
        addBoxOfPile(b, dice, {(k % side - middle) * 1.4, 1.2 + layer * 1.5, (k / side - middle) * 1.4});
    }
    return {b.scene, {{"", 180}, {b.scene.name, 60}}};
}

Course makeHullPile() {
    Builder b("hull_pile");
    b.pit(12);
    PeerDice dice(13);
    for (int i = 0; i < 1000; ++i) {
        const int layer = i / 81, k = i % 81;
        ConvexHull hull = stone(dice);
        const float dx = dice.between(-0.05f, 0.05f), dz = dice.between(-0.05f, 0.05f);
        const DVec3 cell{(k % 9 - 4) * 1.25, 1.0 + layer * 1.2, (k / 9 - 4) * 1.25};
        b.moving(std::move(hull), 1000, {.position = cell + Vec3{dx, 0, dz}});
    }
    return {std::move(b.scene), {{"hull_pile", 600}}};
}

namespace {

float hills(float x, float z) { return 0.5f * std::sin(x * 0.5f) * std::cos(z * 0.5f); }

/// 80,000 triangles on a square of 200 m.
TriangleMesh hillMesh() {
    constexpr std::uint32_t kCells = 200;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t z = 0; z <= kCells; ++z)
        for (std::uint32_t x = 0; x <= kCells; ++x) {
            const float px = static_cast<float>(x) - 100, pz = static_cast<float>(z) - 100;
            vertices.push_back({px, hills(px, pz), pz});
            if (x == kCells || z == kCells) continue;
            const std::uint32_t s = z * (kCells + 1) + x, below = s + kCells + 1;
            triangles.push_back({s, below, s + 1});
            triangles.push_back({s + 1, below, below + 1});
        }
    return TriangleMesh(vertices, triangles);
}

}  // namespace

Course makeMeshDrive() {
    Builder b("mesh_drive");
    b.fixed(hillMesh(), {});
    PeerDice dice(17);
    for (int i = 0; i < 200; ++i) {
        const float x = (static_cast<float>(i % 20) - 9.5f) * 2.2f, z = (static_cast<float>(i / 20) - 4.5f) * 2.2f;
        const float heading = dice.between(0, 6.283f);
        const Placing at{.position = DVec3{Vec3{x, hills(x, z) + 1, z}},
                         .velocity = {8 * std::cos(heading), 0, 8 * std::sin(heading)}};
        if (i % 2 == 1)
            b.moving(Sphere{0.4f}, 1000, at);
        else
            b.moving(Box{{0.4f, 0.4f, 0.4f}}, 1000, at);
    }
    return {std::move(b.scene), {{"mesh_drive", 600}}};
}

namespace {

/// Fifty chains of twenty links that swing down from the horizontal, a ball of 1,000 kg at the end of each.
Course makeChains(const std::string& name, float linkDensity) {
    constexpr int kLinks = 20;
    constexpr double kHeight = 60;
    Builder b(name);
    b.ground(300);
    for (int chain = 0; chain < 50; ++chain) {
        const double z = (chain - 25) * 3.0;
        int previous = stability::kWorld;
        for (int i = 0; i < kLinks; ++i) {
            const int link =
                b.moving(Capsule{0.05f, 0.1f}, linkDensity,
                         {.position = {0.15 + i * 0.3, kHeight, z}, .rotation = kTurnedAlongX, .group = chain + 1});
            b.ball(previous, link, {{i * 0.3, kHeight, z}});
            previous = link;
        }
        const int ball = b.moving(Sphere{0.5f}, 1909.86f, {.position = {6.5, kHeight, z}, .group = chain + 1});
        b.ball(previous, ball, {{6, kHeight, z}});
    }
    return {std::move(b.scene), {{name, 600}}};
}

}  // namespace

Course makeWreckingChain() { return makeChains("wrecking_chain", 47.7465f); }
Course makeChain100to1() { return makeChains("chain_100to1", 4774.65f); }

}  // namespace ragtop::speed
