#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "ragtop/tasks.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// So many boxes, one above the other with little room, that their contacts are put in the order of space as they fall.
struct Heap {
    static constexpr int kSide = 13;
    World world;

    explicit Heap(const WorldConfig& config) : world(withoutSleep(), config) {
        addFloor(world);
        for (int i = 0; i < kSide * kSide * kSide; ++i) {
            const int x = i % kSide, y = i / kSide % kSide, z = i / (kSide * kSide);
            world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {1.01 * x + 0.003 * (y % 3), 0.505 + 1.01 * y, 1.01 * z}));
        }
    }
    void play(int steps) {
        for (int i = 0; i < steps; ++i) world.step(kDt);
    }
};

TEST(ContactOrder, LanesThreadsAndASavedStateGiveTheSameBits) {
    Heap eight({.lanes = 8}), four({.tasks = threadTasks(4), .lanes = 4}), restored({.lanes = 8});
    eight.play(20);
    four.play(20);
    ASSERT_GT(eight.world.stats().contacts, 4096);
    EXPECT_EQ(eight.world.hash(), four.world.hash());

    restored.play(3);
    std::vector<std::byte> state(restored.world.saveSize());
    restored.world.save(state);
    restored.play(5);
    restored.world.restore(state);
    restored.play(17);
    EXPECT_EQ(restored.world.hash(), eight.world.hash());
}

/// Pairs with a mesh have several manifolds each, one after the other, wherever they are put.
TEST(ContactOrder, MeshesBelowAPileGiveTheSameBitsAfterASavedState) {
    const auto play = [](bool saves) {
        Heap heap({.lanes = 8});
        std::vector<Vec3> vertices;
        for (int i = 0; i < 4; ++i) vertices.push_back({i % 2 != 0 ? 20.0f : -5.0f, 0, i / 2 != 0 ? 20.0f : -5.0f});
        const std::vector<Triangle> triangles{{0, 2, 1}, {1, 2, 3}};
        heap.world.create(StaticBody{.shape = TriangleMesh{vertices, triangles}, .position = {0, 0.01, 0}});
        heap.play(6);
        if (saves) {
            std::vector<std::byte> state(heap.world.saveSize());
            heap.world.save(state);
            heap.play(3);
            heap.world.restore(state);
        }
        heap.play(14);
        return heap.world.hash();
    };
    EXPECT_EQ(play(false), play(true));
}

/// What is in order goes on: bodies can be destroyed, and the rest comes to rest without falling through anything.
TEST(ContactOrder, BodiesAreDestroyedAndMetAsBefore) {
    Heap heap({.lanes = 8});
    heap.play(5);
    const std::vector<BodyId> bodies(heap.world.bodies().begin(), heap.world.bodies().end());
    for (std::size_t i = 1; i < bodies.size(); i += 3) heap.world.destroy(bodies[i]);
    heap.play(20);
    for (const BodyId body : heap.world.bodies()) EXPECT_GT(heap.world.pose(body).position.y, -1.01);
}

}  // namespace
}  // namespace ragtop
