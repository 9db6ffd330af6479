#include <vector>

#include "scenes.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Walls of light boxes under a heavy one lose their loads in the air and land as hard on light boxes as on the ground.
/// What falls through a gap of g comes down by g; 1 mm more is a five-hundredth of a box.
TEST(DirectLanding, OfAWallUnderAHeavyBoxMovesNothingElse) {
    scenes::Dice dice(20);
    for (int scene = 0; scene < 12; ++scene) {
        World world{withoutSleep()};
        addFloor(world, surface(0.5f));
        const int base = 3 + static_cast<int>(dice.below(6));
        const auto gap = 1e-3 * static_cast<double>(dice.between(0.0625f, 1));
        const float mass = dice.between(30, 1000);
        std::vector<BodyId> boxes;
        std::vector<DVec3> from;
        const auto add = [&](const DVec3& at, float kg) {
            BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, at + DVec3{0, gap, 0}, surface(0.5f));
            def.shapes[0].density = kg;
            boxes.push_back(world.create(def));
            from.push_back(world.pose(boxes.back()).position);
        };
        for (int row = 0; row < base; ++row)
            for (int i = 0; i < base - row; ++i) add({(i - (base - row - 1) / 2.0) * 1.02, 0.5 + row, 0}, 1);
        add({0, base + 0.5, 0}, mass);
        for (int i = 0; i < 300; ++i) world.step(kDt);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const DVec3 moved = world.pose(boxes[i]).position - from[i];
            EXPECT_NEAR(moved.x, 0, 1e-3) << scene << ": " << base << " below " << mass << " kg, gap " << gap;
            EXPECT_NEAR(moved.y, -gap, 1e-3) << scene << ": " << base << " below " << mass << " kg, gap " << gap;
        }
    }
}

}  // namespace
}  // namespace ragtop
