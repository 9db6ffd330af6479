#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ragtop/world.h"

namespace ragtop {
namespace {

/// m, of the deepest contact with a body.
double deepestIn(const World& world, BodyId body) {
    double deepest = 0;
    world.forEachContact(body, [&](const Contact& contact) {
        for (int i = 0; i < contact.pointCount; ++i)
            deepest = std::max(deepest, -static_cast<double>(contact.points[i].separation));
    });
    return deepest;
}

/// A chain of boxes falls by 5 cm on a fixed beam, over whose edges the ends bend it.
double deepestInABeam(int links, float ends) {
    World world;
    const BodyId beam = world.create(StaticBody{.shape = Box{{0.25f, 0.25f, 2}}, .position = {0, 6, 0}});
    constexpr double kPitch = 0.4;
    BodyId before;
    for (int i = 0; i < links; ++i) {
        const double x = (i - (links - 1) / 2.0) * kPitch + 0.1;
        const bool isEnd = i == 0 || i + 1 == links;
        const BodyId link = world.create(DynamicBody{
            .shape = Box{{0.18f, 0.1f, 0.1f}}, .density = isEnd ? 1000 * ends : 1000, .position = {x, 6.4, 0}});
        if (i > 0) {
            BallDef ball;
            ball.bodies.a = before, ball.bodies.b = link;
            ball.bodies.frameA.position = {0.2f, 0, 0}, ball.bodies.frameB.position = {-0.2f, 0, 0};
            world.create(ball);
        }
        before = link;
    }
    double deepest = 0;
    for (int i = 0; i < 300; ++i) {
        world.step(1.0 / 60);
        deepest = std::max(deepest, deepestIn(world, beam));
    }
    return deepest;
}

/// A link that bends over the beam's edge has it nearly in its face. With a point at one end alone links rocked from
/// end to end and sank in by up to 0.3 m, three times their half width; half of that half width is allowed.
TEST(EdgeContacts, LinksUnderALoadDoNotSinkIntoTheEdgeTheyBendOver) {
    for (const int links : {9, 12, 17, 24})
        for (const float ends : {1.0f, 12.0f, 40.0f}) {
            SCOPED_TRACE(testing::Message() << links << " links, ends " << ends);
            EXPECT_LT(deepestInABeam(links, ends), 0.05);
        }
}

}  // namespace
}  // namespace ragtop
