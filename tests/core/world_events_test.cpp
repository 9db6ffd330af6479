#include <map>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

using BodyPair = std::pair<BodyId, BodyId>;

BodyPair pairOf(const ContactEvent& event) { return std::minmax(event.bodyA, event.bodyB); }

TEST(WorldEvents, ATouchBeginsAndEndsOnce) {
    World world(withoutGravity());
    const BodyId wall = world.create(bodyDef(Box{{0.5f, 5, 5}}, {}, surface(0, 1), BodyType::fixed));
    BodyDef def = bodyDef(Sphere{0.5f}, {-4, 0, 0}, surface(0, 1));
    def.linearVelocity = {5, 0, 0};
    const BodyId ball = world.create(def);
    int begins = 0, ends = 0;
    run(world, 2, kDt, [&] {
        for (const ContactEvent& event : world.contactBegins()) {
            EXPECT_EQ(pairOf(event), BodyPair(std::minmax(wall, ball)));
            EXPECT_EQ(world.bodyOf(event.shapeA), event.bodyA);
            ++begins;
        }
        ends += static_cast<int>(world.contactEnds().size());
    });
    EXPECT_EQ(begins, 1);
    EXPECT_EQ(ends, 1);
}

// Begin and end alternate for each pair, and those that began and have not ended are those that touch.
TEST(WorldEvents, BeginsAndEndsAlternateInAPile) {
    World world;
    addFloor(world);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 40; ++i)
        bodies.push_back(world.create(bodyDef(i % 2 ? Shape(Sphere{0.3f}) : Shape(Box{{0.3f, 0.3f, 0.3f}}),
                                              {0.2 * (i % 5), 1 + 0.3 * i, 0.2 * (i % 3)}, surface(0.4f, 0.3f))));
    std::map<std::pair<ShapeId, ShapeId>, bool> touching;
    const auto listen = [&] {
        for (const ContactEvent& event : world.contactEnds()) {
            bool& state = touching[{event.shapeA, event.shapeB}];
            EXPECT_TRUE(state);
            state = false;
        }
        for (const ContactEvent& event : world.contactBegins()) {
            bool& state = touching[{event.shapeA, event.shapeB}];
            EXPECT_FALSE(state);
            state = true;
        }
    };
    run(world, 6, kDt, listen);
    std::size_t open = 0, listed = 0;
    for (const auto& [pair, state] : touching) open += state;
    std::map<std::pair<ShapeId, ShapeId>, bool> seen;
    world.forEachContact([&](const Contact& contact) { seen[{contact.shapeA, contact.shapeB}] = true; });
    for (const auto& [pair, state] : seen) listed += state;
    EXPECT_EQ(open, listed);
    EXPECT_GT(open, 20u);
    // Those of a destroyed body end in the next step.
    for (int i = 0; i < 10; ++i) world.destroy(bodies[static_cast<std::size_t>(i)]);
    run(world, 1, kDt, listen);
    for (const auto& [pair, state] : touching)
        EXPECT_TRUE(!state || (world.isValid(pair.first) && world.isValid(pair.second)));
}

/// What has begun and ended in each step of a pile that is shot at, comes to rest, sleeps and is lifted. Far off is a
/// shape that may report its motion.
std::vector<ContactEvent> eventsOfAPile(bool reports) {
    WorldSettings settings;
    settings.sleeping = true;
    World world(settings);
    addFloor(world);
    for (int i = 0; i < 40; ++i)
        world.create(bodyDef(i % 2 ? Shape(Sphere{0.3f}) : Shape(Box{{0.3f, 0.3f, 0.3f}}),
                             {0.2 * (i % 5), 1 + 0.3 * i, 0.2 * (i % 3)}, surface(0.4f, 0.3f)));
    const BodyId lift = world.create(bodyDef(Box{{5, 0.1f, 5}}, {0, -0.2, 0}, surface(0.4f, 0), BodyType::kinematic));
    BodyDef far = bodyDef(Sphere{0.5f}, {1000, 0.5, 0}, surface(0.4f, 0), BodyType::fixed);
    far.shapes[0].reportsMotion = reports;
    world.create(far);
    std::vector<ContactEvent> events;
    const auto listen = [&] {
        for (const auto& list : {world.contactBegins(), world.contactEnds()})
            events.insert(events.end(), list.begin(), list.end());
        events.push_back({});
    };
    run(world, 2, kDt, listen);
    for (int i = 0; i < 3; ++i) {
        BodyDef bullet = bodyDef(Sphere{0.05f}, {-5, 0.3 + 0.4 * i, 0.1 * i}, surface(0.4f, 0.5f));
        bullet.linearVelocity = {200, 0, 0};
        world.create(bullet);
    }
    run(world, 6, kDt, listen);
    world.setVelocity(lift, {0, 0.5f, 0}, {});
    run(world, 2, kDt, listen);
    return events;
}

// Whether all contacts are asked, as where motion is reported, or those alone of which the solver tells other things
// than before.
TEST(WorldEvents, AreTheSameWhereAShapeReportsItsMotion) {
    const std::vector<ContactEvent> alone = eventsOfAPile(false), beside = eventsOfAPile(true);
    ASSERT_EQ(alone.size(), beside.size());
    int told = 0;
    for (std::size_t i = 0; i < alone.size(); ++i) {
        EXPECT_TRUE(alone[i].shapeA == beside[i].shapeA && alone[i].shapeB == beside[i].shapeB) << i;
        told += alone[i].bodyA != alone[i].bodyB;
    }
    EXPECT_GT(told, 200);
}

TEST(WorldEvents, ASensorReportsAndFeelsNothing) {
    World world;
    BodyDef gate = bodyDef(Box{{1, 0.5f, 1}}, {}, {}, BodyType::fixed);
    gate.shapes[0].sensor = true;
    const BodyId sensor = world.create(gate);
    const BodyId ball = world.create(bodyDef(Sphere{0.2f}, {0, 3, 0}));
    int begins = 0, ends = 0;
    run(world, 1.2, kDt, [&] {
        for (const ContactEvent& event : world.sensorBegins()) {
            EXPECT_EQ(pairOf(event), BodyPair(std::minmax(sensor, ball)));
            // Overlap is that of the end of the step: it falls at 6.7 m/s, up to 0.12 m in the step that it begins in.
            EXPECT_NEAR(height(world, ball), 0.7 - 0.06, 0.06);
            ++begins;
        }
        for (const ContactEvent& event : world.sensorEnds()) {
            EXPECT_EQ(pairOf(event), BodyPair(std::minmax(sensor, ball)));
            EXPECT_NEAR(height(world, ball), -0.7 - 0.075, 0.075);  // at 8.5 m/s
            ++ends;
        }
        EXPECT_TRUE(world.contactBegins().empty());
    });
    EXPECT_EQ(begins, 1);
    EXPECT_EQ(ends, 1);
    EXPECT_NEAR(height(world, ball), 3 - 0.5 * 9.81 * 1.44, 1e-3);
}

TEST(WorldEvents, FiltersAndGroupsDecideWhoCollides) {
    struct Case {
        Filter a, b;
        bool collide;
    };
    const Case cases[] = {{{1, 1, 0}, {1, 1, 0}, true},    {{1, 2, 0}, {2, 1, 0}, true}, {{1, 2, 0}, {2, 2, 0}, false},
                          {{1, 1, -3}, {1, 1, -3}, false}, {{1, 0, 3}, {1, 0, 3}, true}, {{1, 1, -3}, {1, 1, -4}, true},
                          {{1, 0, 3}, {1, 0, 4}, false}};
    for (const Case& c : cases) {
        World world;
        BodyDef floor = bodyDef(Box{{5, 1, 5}}, {0, -1, 0}, {}, BodyType::fixed);
        BodyDef ball = bodyDef(Sphere{0.3f}, {0, 0.4, 0});
        floor.shapes[0].filter = c.a;
        ball.shapes[0].filter = c.b;
        world.create(floor);
        const BodyId body = world.create(ball);
        run(world, 1);
        EXPECT_EQ(height(world, body) > 0, c.collide) << c.a.category << " " << c.a.mask << " " << c.a.group;
        // Changing the filter takes effect.
        world.setFilter(world.shapes(body)[0], Filter{.category = 8, .mask = 0});
        const double y = height(world, body);
        run(world, 0.5);
        EXPECT_LT(height(world, body), y - 1);
    }
}

TEST(WorldEvents, AFilterCallbackKeepsPairsApart) {
    World world;
    addFloor(world);
    WorldCallbacks callbacks;
    callbacks.filter = [](const PairInfo& pair) { return pair.userDataA != 5 && pair.userDataB != 5; };
    world.setCallbacks(callbacks);
    BodyDef def = bodyDef(Sphere{0.3f}, {0, 1, 0});
    def.shapes[0].userData = 5;
    const BodyId ghost = world.create(def), ball = world.create(bodyDef(Sphere{0.3f}, {3, 1, 0}));
    run(world, 1);
    EXPECT_LT(height(world, ghost), -1);
    EXPECT_NEAR(height(world, ball), 0.3, 0.01);
}

// The impulse of an impact is m Δv, of a slide m g dt per step.
TEST(WorldEvents, SurfacesTellOfImpactSlideAndRoll) {
    World world(withoutSleep());
    Material ground = surface(0.5f);
    ground.surface = 3;
    const BodyId floor = addFloor(world, ground);
    BodyDef def = bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 2.25, 0}, surface(0.5f));
    def.shapes[0].reportsMotion = true;
    def.shapes[0].material.surface = 4;
    const BodyId box = world.create(def);
    const float mass = world.mass(box).mass;
    int impacts = 0;
    float impulse = 0, speed = 0;
    run(world, 1.5, kDt, [&] {
        for (const SurfaceEvent& event : world.surfaceEvents())
            if (event.kind == SurfaceEvent::Kind::impact) {
                ++impacts;
                if (event.speed > speed) impulse = event.impulse;
                speed = std::max(speed, event.speed);
                EXPECT_EQ(event.surfaceA + event.surfaceB, 7u);
                EXPECT_NEAR(event.point.y, 0, 0.1);
                EXPECT_NEAR(event.normal.y, event.bodyA == floor ? 1 : -1, 1e-3);
            }
    });
    const float fall = std::sqrt(2 * kGravity * 2);
    EXPECT_EQ(impacts, 1);
    // Seen at the beginning of the step: up to g dt slower; in its impulse is the weight of that step.
    EXPECT_NEAR(speed, fall, kGravity / 60 + 0.01f);
    EXPECT_NEAR(impulse, mass * fall, mass * kGravity / 60 * 1.5f);

    world.setVelocity(box, {4, 0, 0}, {});
    world.step(kDt);
    ASSERT_EQ(world.surfaceEvents().size(), 1u);
    const SurfaceEvent slide = world.surfaceEvents()[0];
    EXPECT_EQ(slide.kind, SurfaceEvent::Kind::slide);
    EXPECT_NEAR(slide.speed, 4 - 0.5 * 9.81 / 60, 0.05);
    EXPECT_NEAR(slide.impulse, mass * kGravity / 60, 0.05f * mass * kGravity / 60);
    run(world, 2);
    EXPECT_TRUE(world.surfaceEvents().empty());

    BodyDef rolling = bodyDef(Sphere{0.5f}, {0, 0.5, 20}, surface(0.5f));
    rolling.shapes[0].reportsMotion = true;
    rolling.linearVelocity = {3, 0, 0};
    rolling.angularVelocity = {0, 0, -6};
    world.create(rolling);
    run(world, 0.5);
    ASSERT_EQ(world.surfaceEvents().size(), 1u);
    EXPECT_EQ(world.surfaceEvents()[0].kind, SurfaceEvent::Kind::roll);
    EXPECT_NEAR(world.surfaceEvents()[0].speed, 3, 0.05);
}

TEST(WorldEvents, ContactsTellTheForcesOfRest) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}));
    run(world, 3);
    const float weight = world.mass(box).mass * kGravity;
    int contacts = 0;
    world.forEachContact(box, [&](const Contact& contact) {
        ++contacts;
        EXPECT_EQ(contact.pointCount, 4);
        EXPECT_NEAR(contact.normalForce, weight, 0.01f * weight);
        EXPECT_LT(length(contact.frictionForce), 0.01f * weight);
        EXPECT_NEAR(std::abs(contact.normal.y), 1, 1e-5);
        for (int i = 0; i < contact.pointCount; ++i) EXPECT_NEAR(contact.points[i].point.y, 0, 1e-3);
    });
    EXPECT_EQ(contacts, 1);
    EXPECT_EQ(world.stats().touching, 1);
}

}  // namespace
}  // namespace ragtop
