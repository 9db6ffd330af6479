#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

Material uneven(float friction, float share) {
    Material material = surface(friction);
    material.slidingShare = share;
    return material;
}

// Once it slides, only the dynamic coefficient brakes: from 4 m/s with 0.6 · 0.5 it stops after v²/(2 · 0.3 g).
TEST(WorldFrictionMemory, SlidingHasTheDynamicCoefficient) {
    World world(withoutSleep());
    addFloor(world, uneven(0.6f, 0.5f));
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, uneven(0.6f, 0.5f)));
    run(world, 1);
    const double start = world.pose(box).position.x;
    world.setVelocity(box, {4, 0, 0}, {});
    run(world, 3);
    const double expected = 16 / (2 * 0.3 * 9.81);
    EXPECT_NEAR(world.pose(box).position.x - start, expected, 0.002 * expected);
}

// A block on a belt, held by a spring: it sticks until k x = μs m g, then slips to the mirror image about μk m g / k,
// where it comes to rest for a moment: the stroke is 2 (μs − μk) m g / k. The belt adds what it moves meanwhile, which
// the slow one here makes small: in half a period, π √(m/k), 0.02 m/s make 20 mm, of which it rides along for less than
// half before it slips and after it sticks, so 5 mm/s, a quarter of that, are used.
TEST(WorldFrictionMemory, StickSlipHasTheStrokeOfTheCoefficients) {
    World world(withoutSleep());
    const BodyId floor = addFloor(world, uneven(0.6f, 2.0f / 3));
    BodyDef def = bodyDef(Box{{0.25f, 0.125f, 0.25f}}, {0, 0.125, 0}, uneven(0.6f, 2.0f / 3));
    def.locks = {.rotationX = true, .rotationY = true, .rotationZ = true};
    const BodyId block = world.create(def);
    const float mass = world.mass(block).mass, k = 10 * mass;
    SliderDef slider;
    slider.bodies.b = block;
    slider.bodies.frameA.position = {0, 0.125f, 0};
    slider.spring = Spring{k, 0};
    world.create(JointDef{slider});
    run(world, 0.5);
    Material belt = uneven(0.6f, 2.0f / 3);
    belt.surfaceVelocity = {0.005f, 0, 0};
    world.setMaterial(world.shapes(floor)[0], belt);
    double highest = 0, lowest = 0, stroke = 0;
    bool slips = false;
    int strokes = 0;
    run(world, 120, kDt, [&] {
        const double x = world.pose(block).position.x;
        const float v = world.linearVelocity(block).x;
        if (!slips && v < -0.05f) slips = true;
        if (!slips) highest = x;
        if (slips) lowest = std::min(lowest == 0 ? x : lowest, x);
        if (slips && v > 0) {
            stroke = highest - lowest, slips = false, lowest = 0, ++strokes;
            const double expected = 2 * 0.2 * 9.81 / 10;
            EXPECT_NEAR(stroke, expected, 0.02 * expected) << strokes;
        }
    });
    EXPECT_GE(strokes, 1);
}

// Across the grain the coefficient is another: distances are v²/(2 μ g) each.
TEST(WorldFrictionMemory, AGrainBrakesByDirection) {
    for (const bool along : {true, false}) {
        World world(withoutSleep());
        Material skate = surface(0.4f);
        skate.grain = {2, 0, 0};
        skate.crossFriction = 2;
        addFloor(world, surface(0.4f));
        const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, skate));
        run(world, 1);
        world.setVelocity(box, along ? Vec3{4, 0, 0} : Vec3{0, 0, 4}, {});
        run(world, 3);
        const double moved = along ? world.pose(box).position.x : world.pose(box).position.z;
        const double expected = 16 / (2 * (along ? 0.4 : 0.8) * 9.81);
        EXPECT_NEAR(moved, expected, 0.003 * expected) << along;
    }
}

// Creep is what is left of the velocity along a slope below the friction angle, here and a kilometre away.
TEST(WorldFrictionMemory, NothingCreepsOnASlope) {
    for (const double far : {0.0, 1000.0}) {
        const float theta = 0.4636f;
        const Quat tilt = rotationAbout({0, 1, 0}, 0.4f) * rotationAbout({0, 0, 1}, -theta);
        const DVec3 origin{far, 0.3 * far, -0.7 * far};
        World world(withoutSleep());
        const Material material = surface(1.01f * std::tan(theta));
        BodyDef floor = bodyDef(Box{{50, 1, 50}}, {}, material, BodyType::fixed);
        floor.pose = {origin + rotate(tilt, {0, -1, 0}), tilt};
        world.create(floor);
        BodyDef def = bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {}, material);
        def.pose = {origin + rotate(tilt, {0, 0.25f, 0}), tilt};
        const BodyId box = world.create(def);
        run(world, 2);
        const DVec3 start = world.pose(box).position;
        run(world, 60);
        const Vec3 moved = relative(world.pose(box).position, start);
        const Vec3 normal = rotate(tilt, {0, 1, 0});
        EXPECT_LT(length(moved - dot(moved, normal) * normal), 60 * 1e-6f) << far;
    }
}

// A ball that rolls without slipping on a table that turns with Ω moves in circles with 2/7 Ω (Milne 1948).
TEST(WorldFrictionMemory, ABallOnATurntableCirclesAtTwoSevenths) {
    World world(withoutSleep());
    BodyDef table = bodyDef(Box{{20, 0.5f, 20}}, {0, -0.5, 0}, surface(1), BodyType::kinematic);
    table.angularVelocity = {0, 2, 0};
    world.create(table);
    // Rolling at the start: v = u + ω × r ŷ, and for the circle about the axis of the table v = 2/7 Ω × p.
    const float rate = 2.0f * 2 / 7, r = 0.25f, at = 2;
    BodyDef def = bodyDef(Sphere{r}, {at, r, 0}, surface(1));
    def.linearVelocity = {0, 0, -rate * at};
    const float slip = -2.0f * at + rate * at;  // velocity of the table minus that of the ball, along z
    def.angularVelocity = {-slip / r, 0, 0};
    const BodyId ball = world.create(def);
    double turned = 0, before = 0;
    run(world, 20, kDt, [&] {
        const DVec3 p = world.pose(ball).position;
        const double now = std::atan2(-p.z, p.x);
        double change = now - before;
        if (change < -3.14159265) change += 2 * 3.14159265358979;
        turned += change, before = now;
    });
    EXPECT_NEAR(turned / 20, rate, 0.005 * rate);
}

TEST(WorldFrictionMemory, RulesOfTwoSurfaces) {
    EXPECT_EQ(combined(CombineRule::geometricMean, 0.25f, CombineRule::geometricMean, 1.0f), 0.5f);
    EXPECT_EQ(combined(CombineRule::average, 0.25f, CombineRule::geometricMean, 1.0f), 0.625f);
    EXPECT_EQ(combined(CombineRule::average, 0.25f, CombineRule::minimum, 1.0f), 0.25f);
    EXPECT_EQ(combined(CombineRule::product, 0.25f, CombineRule::minimum, 0.5f), 0.125f);
    EXPECT_EQ(combined(CombineRule::maximum, 0.25f, CombineRule::product, 1.0f), 1.0f);
}

// The two ways of solving friction agree where the answer is one.
TEST(WorldFrictionMemory, SequentialFrictionStopsWhereSimultaneousDoes) {
    WorldSettings settings = withoutSleep();
    settings.sequentialFriction = true;
    World world(settings);
    addFloor(world, surface(0.5f));
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, surface(0.5f)));
    run(world, 1);
    world.setVelocity(box, {5, 0, 0}, {});
    run(world, 2);
    const double expected = 25 / (2 * 0.5 * 9.81);
    EXPECT_NEAR(world.pose(box).position.x, expected, 0.002 * expected);
}

TEST(WorldFrictionMemory, MaterialsSayWhatIsWrong) {
    Material material;
    material.slidingShare = 1.5f;
    EXPECT_NE(whyInvalid(material).find("slidingShare is 1.5"), std::string::npos);
    material = {};
    material.crossFriction = 0;
    EXPECT_NE(whyInvalid(material).find("crossFriction is 0"), std::string::npos);
    material = {};
    material.spinningResistance = -1;
    EXPECT_NE(whyInvalid(material).find("spinningResistance is -1"), std::string::npos);
}

// Equal balls at e = 1 hand their momentum on: k balls come in, k leave, whether they touch or not. Impacts of one
// substep are played in the order of the graph, not of time, which at the end of a substep costs a percent.
TEST(WorldFrictionMemory, ACradleEjectsAsManyAsComeIn) {
    for (const double gap : {0.0, 0.001, 0.0137})
        for (int k = 1; k <= 4; ++k) {
            World world(withoutGravity());
            std::vector<BodyId> balls;
            for (int i = 0; i < 5; ++i) {
                BodyDef def = bodyDef(Sphere{0.5f}, {(i < k ? -3.01 : 0) + i * (1 + gap), 0, 0}, surface(0, 1));
                if (i < k) def.linearVelocity = {2, 0, 0};
                balls.push_back(world.create(def));
            }
            run(world, 3);
            for (int i = 0; i < 5; ++i)
                EXPECT_NEAR(world.linearVelocity(balls[static_cast<std::size_t>(i)]).x, i >= 5 - k ? 2 : 0, 0.025)
                    << gap << " " << k << " " << i;
        }
}

// Height and time of flight are those of the law, v = √(2 g h): rounding alone is left, some ε per bounce and substep.
TEST(WorldFrictionMemory, TwentyBouncesLoseNothing) {
    World world(withoutSleep());
    addFloor(world, surface(0.5f, 1));
    const BodyId ball = world.create(bodyDef(Sphere{0.1f}, {0, 5.1, 0}, surface(0.5f, 1)));
    double t = 0, before = -1;
    int apexes = 0;
    while (apexes < 20 && t < 60) {
        world.step(kDt);
        t += kDt;
        const double v = world.linearVelocity(ball).y;
        if (v <= 0 && before > 0) {
            ++apexes;
            EXPECT_NEAR(height(world, ball) - 0.1 + v * v / (2 * 9.81), 5, 1e-4 * 5) << apexes;
            EXPECT_NEAR(t + v / 9.81, apexes * 2 * std::sqrt(2 * 5 / 9.81), 1e-4 * t) << apexes;
        }
        before = v;
    }
    EXPECT_EQ(apexes, 20);
}

}  // namespace
}  // namespace ragtop
