#include <utility>

#include "builder.h"
#include "courses.h"

namespace ragtop::speed {

Course makeManyPyramids() {
    Builder b("many_pyramids");
    b.ground(150);
    for (int row = 0; row < 14; ++row)
        for (int column = 0; column < 14; ++column) addPyramid(b, {(column - 6.5) * 14, 0, (row - 6.5) * 4}, 10);
    return {std::move(b.scene), {{"many_pyramids", 200}}};
}

/// A cloth of 100 × 100 balls that hangs from the middle of its upper edge.
Course makeJointGrid() {
    constexpr int kSide = 100;
    Builder b("joint_grid");
    for (int row = 0; row < kSide; ++row)
        for (int column = 0; column < kSide; ++column) {
            const Placing at{.position = {column - 0.5 * kSide, 100.0 - row, 0}, .group = 1};
            const bool held = row == 0 && column >= kSide / 2 - 3 && column <= kSide / 2 + 3;
            const int body = held ? b.fixed(Sphere{0.4f}, at) : b.moving(Sphere{0.4f}, 1000, at);
            if (row > 0) b.ball(body - kSide, body, {at.position + DVec3{0, 0.5, 0}});
            if (column > 0) b.ball(body - 1, body, {at.position - DVec3{0.5, 0, 0}});
        }
    // What joins two bodies that are held is no joint.
    std::erase_if(b.scene.joints, [&](const SceneJoint& joint) {
        const auto held = [&](int body) {
            return b.scene.bodies[static_cast<std::size_t>(body)].def.type == BodyType::fixed;
        };
        return held(joint.bodyA) && held(joint.bodyB);
    });
    return {std::move(b.scene), {{"joint_grid", 300}}};
}

/// Stones and capsules in a pit, and a blade that comes through them at 1.5 m/s.
Course makeJunkyard() {
    constexpr int kPerLayer = 22;
    Builder b("junkyard");
    b.pit(30);
    b.pusher(Box{{14.9f, 2, 0.25f}}, {.position = {0, 2, -14.5}, .velocity = {0, 0, 1.5f}});
    PeerDice dice(23);
    for (int i = 0; i < 5000; ++i) {
        const int layer = i / (kPerLayer * kPerLayer), k = i % (kPerLayer * kPerLayer);
        const double middle = (kPerLayer - 1) * 0.5;
        const float angle = dice.between(0, 3);
        const Placing at{
            .position = {(k % kPerLayer - middle) * 1.2, 1.0 + layer * 1.2, (k / kPerLayer - middle) * 1.2},
            .rotation = rotationAbout(dice.inCube() + Vec3{0, 0, 0.01f}, angle)};
        if (i % 2 == 0)
            b.moving(stone(dice), 1000, at);
        else
            b.moving(Capsule{0.2f, 0.3f}, 1000, at);
    }
    return {std::move(b.scene), {{"junkyard", 480}}};
}

/// A hundred ragdolls fall on stairs.
Course makeRain() {
    Builder b("rain");
    b.ground(60);
    for (int i = 0; i < 24; ++i)
        b.fixed(Box{{8, 0.1f * static_cast<float>(i + 1), 0.3f}}, {.position = {0, 0.1 * (i + 1), -0.6 * i}});
    PeerDice dice(29);
    for (int i = 0; i < 100; ++i) {
        const float yaw = dice.between(0, 6.283f), lean = dice.between(-1.5f, 1.5f);
        const Quat rotation = rotationAbout({0, 1, 0}, yaw) * rotationAbout({1, 0, 0}, lean);
        addRagdoll(b, {(i % 4 - 1.5) * 3.2, 7.0 + (i / 4) * 1.2, -2.0 - (i / 4 % 5) * 2.4}, rotation);
    }
    return {std::move(b.scene), {{"rain", 480}}};
}

/// 50,000 boxes that lie and have fallen asleep, and ten that may not sleep.
Course makeSleepers() {
    Builder b("sleepers");
    b.scene.settings.sleeping = true;
    b.ground(320);
    for (int i = 0; i < 10000; ++i) addPyramid(b, {(i % 100 - 49.5) * 6, 0, (i / 100 - 49.5) * 6 + 2}, 2);
    for (int i = 0; i < 20000; ++i)
        b.moving(Box{}, 1000, {.position = {(i % 200 - 99.5) * 3, 0.5, (i / 200 - 49.5) * 6 - 1}});
    for (int i = 0; i < 10; ++i) {
        b.moving(Box{}, 1000, {.position = {i * 2.0, 0.5, 310}});
        b.scene.bodies.back().def.allowSleep = false;
    }
    return {std::move(b.scene), {{"", 120}, {"sleepers", 300}}};
}

namespace {

Course beginningOf(Course course, const std::string& name) {
    course.scene.name = name;
    course.windows.resize(1);
    course.windows[0].name = name;
    course.windows[0].steps = 300;
    return course;
}

}  // namespace

Course withOffsets(Course course, const std::string& name) {
    constexpr float kMost = 1e-3f;
    PeerDice dice(37);
    for (SceneBody& body : course.scene.bodies) {
        if (body.def.type != BodyType::dynamic) continue;
        const float x = dice.between(-kMost, kMost), z = dice.between(-kMost, kMost);
        body.def.pose.position = body.def.pose.position + Vec3{x, 0, z};
    }
    return beginningOf(std::move(course), name);
}

Course withNudges(Course course, const std::string& name) {
    course.nudged = true;
    return beginningOf(std::move(course), name);
}

}  // namespace ragtop::speed
