#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// `count` boxes of 0.4 m in a row along x, 0.5 m apart, joined half way; the joints stand `gap` open along y.
struct TreeRow {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;

    TreeRow(World& world, int count, double height, float gap = 0, float density = 1000) {
        for (int i = 0; i < count; ++i) {
            BodyDef def = bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0.5 * i, height + static_cast<double>(gap) * i, 0});
            def.shapes[0].density = density;
            bodies.push_back(world.create(def));
            if (i == 0) continue;
            HingeDef hinge{.bodies = {.a = bodies[bodies.size() - 2],
                                      .b = bodies.back(),
                                      .frameA = {{0.25f, 0, 0}, {}},
                                      .frameB = {{-0.25f, 0, 0}, {}}}};
            hinge.limit = Range{-1, 1};  // what has none is solved directly
            joints.push_back(world.create(hinge));
        }
    }
    float gap(const World& world) const {
        float most = 0;
        for (const JointId joint : joints) most = std::max(most, world.state(joint).gap);
        return most;
    }
};

// Bodies at rest are moved together and stay at rest: what is moved gets no speed. Each sweep closes a joint but for
// the second order of its turns, so that two bodies are together after a step of four; nothing acts from outside, so
// the centre of mass stays where it is but for rounding.
TEST(WorldFreeTrees, OpenJointsCloseWithoutSpeed) {
    World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
    const TreeRow row(world, 2, 5, 0.02f);
    const double before = world.centerOfMass(row.bodies[0]).y + world.centerOfMass(row.bodies[1]).y;
    world.step(kDt);
    EXPECT_LT(row.gap(world), 1e-5f);
    for (const BodyId body : row.bodies) {
        EXPECT_LT(length(world.linearVelocity(body)), 1e-5f);
        EXPECT_LT(length(world.angularVelocity(body)), 1e-5f);
    }
    EXPECT_NEAR(world.centerOfMass(row.bodies[0]).y + world.centerOfMass(row.bodies[1]).y, before, 1e-6);
}

// A soft row leaks a tenth of its load per substep, by which it would stand open by λ/(h m ω²) = a/(2π 60 Hz)², 0.07 mm
// for a load of the body's own weight and 30 times that for the block's. In a free tree nothing leaks.
TEST(WorldFreeTrees, ALoadDoesNotOpenThem) {
    World world(withoutSleep());
    world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}});
    for (const double x : {0.0, 2.0})
        world.create(StaticBody{.shape = Box{{0.25f, 0.5f, 0.5f}}, .position = {x, 0.5, 0}});
    const TreeRow row(world, 5, 1.2);
    BodyDef block = bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {1.0, 1.6, 0});
    block.shapes[0].density = 30000;
    world.create(block);
    run(world, 5);
    EXPECT_LT(row.gap(world), 1e-4f);
}

// A restored world finds anew who belongs to which free tree; one that goes on knows it from the step before. Both are
// the same to the bit whatever happens to joints, bodies and sleep in between.
TEST(WorldFreeTrees, AreKnownAfterWhateverHappensToThem) {
    World world, restored;
    std::vector<TreeRow> rows;
    for (World* each : {&world, &restored}) {
        each->create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}});
        for (const double height : {0.5, 1.2, 2.0}) rows.emplace_back(*each, 6, height);
    }
    std::vector<std::byte> state;
    for (int i = 0; i < 400; ++i) {
        for (std::size_t k : {0u, 3u}) {
            World& each = k == 0 ? world : restored;
            if (i == 30) each.destroy(rows[k].joints[2]);
            if (i == 60) each.setMass(rows[k + 1].bodies[1], massOf(Box{{0.2f, 0.2f, 0.2f}}, 50000));
            if (i == 90) each.destroy(rows[k + 2].bodies[3]);
            if (i == 120) rows.emplace_back(each, 3, 4.0);
            if (i == 330) each.applyAngularImpulse(rows[k].bodies[0], {0, 5, 0});
            each.step(kDt);
        }
        ASSERT_EQ(world.hash(), restored.hash()) << "step " << i;
        state.resize(restored.saveSize());
        restored.save(state);
        restored.restore(state);
    }
}

}  // namespace
}  // namespace ragtop
