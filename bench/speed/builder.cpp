#include "builder.h"

#include <algorithm>
#include <utility>

namespace ragtop::speed {

using stability::kWorld;

Vec3 PeerDice::inCube() {
    const float x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return {x, y, z};
}

Builder::Builder(std::string name) {
    scene.name = std::move(name);
    scene.settings.gravity = {0, -10, 0};
    scene.settings.sleeping = false;
}

namespace {

BodyDef bodyAt(Shape shape, const Placing& at) {
    BodyDef def;
    def.shapes.push_back({.geometry = std::move(shape), .material = stability::surface(0.6f)});
    def.shapes[0].filter.group = -at.group;
    def.pose = {at.position, at.rotation};
    def.linearVelocity = at.velocity;
    return def;
}

}  // namespace

int Builder::fixed(Shape shape, const Placing& at) {
    BodyDef def = bodyAt(std::move(shape), at);
    def.type = BodyType::fixed;
    return stability::add(scene, std::move(def));
}

int Builder::moving(Shape shape, float density, const Placing& at) {
    BodyDef def = bodyAt(std::move(shape), at);
    def.shapes[0].density = density;
    return stability::add(scene, std::move(def));
}

int Builder::pusher(Shape shape, const Placing& at) {
    BodyDef def = bodyAt(std::move(shape), at);
    def.type = BodyType::kinematic;
    return stability::add(scene, std::move(def));
}

void Builder::ground(float half) { fixed(Box{{half, 1, half}}, {.position = {0, -1, 0}}); }

void Builder::brickHouse(int courses) {
    constexpr int kBricks = 20;
    constexpr double kPitch = 0.402, kSide = (kBricks - 1) * kPitch + 0.4 + 0.202;
    const Box alongX{{0.2f, 0.1f, 0.1f}}, alongZ{{0.1f, 0.1f, 0.2f}};
    for (int c = 0; c < courses; ++c)
        for (int i = 0; i < kBricks; ++i) {
            const double y = 0.1 + 0.2 * c;
            const double along = 0.2 + i * kPitch + (c % 2 == 1 ? 0.202 : 0) - kSide / 2, face = kSide / 2 - 0.1;
            moving(alongX, 2000, {.position = {along, y, -face}});
            moving(alongZ, 2000, {.position = {face, y, along}});
            moving(alongX, 2000, {.position = {-along, y, face}});
            moving(alongZ, 2000, {.position = {-face, y, -along}});
        }
}

void Builder::pit(float side) {
    constexpr float kThickness = 1, kHeight = 40;  // half extents
    ground(std::max(30.0f, side / 2 + 18));
    const float at = side / 2 + kThickness, along = side / 2 + 2 * kThickness;
    const double x = static_cast<double>(at), y = static_cast<double>(kHeight);
    fixed(Box{{kThickness, kHeight, along}}, {.position = {x, y, 0}});
    fixed(Box{{kThickness, kHeight, along}}, {.position = {-x, y, 0}});
    fixed(Box{{along, kHeight, kThickness}}, {.position = {0, y, x}});
    fixed(Box{{along, kHeight, kThickness}}, {.position = {0, y, -x}});
}

JointBodies Builder::frames(int a, int b, const JointPlace& place) const {
    const Pose joint{place.anchor, rotationFromAxes(place.axis, place.zero, cross(place.axis, place.zero))};
    const auto seenFrom = [&](int body) {
        return relative(body == kWorld ? Pose{} : scene.bodies[static_cast<std::size_t>(body)].def.pose, joint);
    };
    JointBodies bodies;
    bodies.frameA = seenFrom(a);
    bodies.frameB = seenFrom(b);
    return bodies;
}

BallDef& Builder::ball(int a, int b, const JointPlace& place) {
    BallDef def;
    def.bodies = frames(a, b, place);
    scene.joints.push_back({{}, a, b, def});
    return std::get<BallDef>(scene.joints.back().def);
}

HingeDef& Builder::hinge(int a, int b, const JointPlace& place) {
    HingeDef def;
    def.bodies = frames(a, b, place);
    scene.joints.push_back({{}, a, b, def});
    return std::get<HingeDef>(scene.joints.back().def);
}

namespace {

/// Puts limbs and joints where they are on a person who stands at `origin`.
class RagdollBuilder {
public:
    RagdollBuilder(Builder& builder, const Pose& origin) : builder_(builder), origin_(origin) {
        group_ = ++builder.groups;
    }
    int limb(float radius, float halfHeight, const Vec3& at, bool level) {
        const Quat turned = level ? origin_.rotation * kTurnedAlongX : origin_.rotation;
        return builder_.moving(Capsule{radius, halfHeight}, 1000,
                               {.position = transformPoint(origin_, at), .rotation = turned, .group = group_});
    }
    void cone(int a, int b, const JointPlace& place, float swing, float twist, float friction) {
        BallDef& def = builder_.ball(a, b, turned(place));
        def.swingLimit = swing;
        def.twistLimit = Range{-twist, twist};
        def.friction = friction;
    }
    void hinge(int a, int b, const JointPlace& place, Range limit, float friction) {
        HingeDef& def = builder_.hinge(a, b, turned(place));
        def.limit = limit;
        def.friction = friction;
    }

private:
    JointPlace turned(const JointPlace& place) const {
        return {transformPoint(origin_, toVec3(place.anchor)), rotate(origin_.rotation, place.axis),
                rotate(origin_.rotation, place.zero)};
    }
    Builder& builder_;
    Pose origin_;
    int group_;
};

}  // namespace

void addRagdoll(Builder& builder, const DVec3& position, const Quat& rotation) {
    RagdollBuilder r(builder, {position, rotation});
    const int pelvis = r.limb(0.13f, 0.08f, {}, true), belly = r.limb(0.12f, 0.06f, {0, 0.20f, 0}, false);
    const int chest = r.limb(0.14f, 0.10f, {0, 0.42f, 0}, true), head = r.limb(0.10f, 0.04f, {0, 0.74f, 0}, false);
    r.cone(pelvis, belly, {{0, 0.11, 0}, {0, 1, 0}, {1, 0, 0}}, 0.35f, 0.35f, 4);
    r.cone(belly, chest, {{0, 0.31, 0}, {0, 1, 0}, {1, 0, 0}}, 0.35f, 0.35f, 4);
    r.cone(chest, head, {{0, 0.60, 0}, {0, 1, 0}, {1, 0, 0}}, 0.5f, 0.8f, 3);
    for (const float side : {-1.0f, 1.0f}) {
        const double s = static_cast<double>(side);
        const int upperArm = r.limb(0.055f, 0.10f, {side * 0.42f, 0.48f, 0}, true);
        const int lowerArm = r.limb(0.045f, 0.10f, {side * 0.70f, 0.48f, 0}, true);
        const int thigh = r.limb(0.08f, 0.14f, {side * 0.11f, -0.27f, 0}, false);
        const int shin = r.limb(0.06f, 0.15f, {side * 0.11f, -0.70f, 0}, false);
        r.cone(chest, upperArm, {{s * 0.28, 0.48, 0}, {side, 0, 0}, {0, 1, 0}}, 1.0f, 0.7f, 3);
        r.hinge(upperArm, lowerArm, {{s * 0.56, 0.48, 0}, {0, side, 0}, {side, 0, 0}}, {-2.2f, 0.05f}, 2);
        r.cone(pelvis, thigh, {{s * 0.11, -0.06, 0}, {0, -1, 0}, {1, 0, 0}}, 0.8f, 0.4f, 3);
        r.hinge(thigh, shin, {{s * 0.11, -0.49, 0}, {1, 0, 0}, {0, -1, 0}}, {-0.05f, 2.2f}, 2);
    }
}

ConvexHull stone(PeerDice& dice) {
    std::vector<Vec3> points(12 + dice.bits() % 9);
    for (Vec3& point : points) {
        do point = dice.inCube();
        while (length(point) < 0.1f || length(point) > 1);
        point = (0.5f / length(point)) * point;
    }
    return ConvexHull(points);
}

void addPyramid(Builder& builder, const DVec3& at, int base) {
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            builder.moving(Box{}, 1000, {.position = at + DVec3{(i - (base - row - 1) * 0.5) * 1.02, 0.5 + row, 0}});
}

}  // namespace ragtop::speed
