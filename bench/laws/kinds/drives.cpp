#include <algorithm>
#include <vector>

#include "cars.h"

namespace ragtop::laws {
namespace {

constexpr float kGround = 400;  ///< m, half of a floor's side: nothing gets to its edge that is not driven there
const Quat kAhead{0, 0.70710678f, 0, 0.70710678f};  // a car looks along x

/// Where cars are put, and what can be said of them.
struct Ground {
    DVec3 start{};        ///< m
    Quat lean{};          ///< of the ground there
    float widest = 2.5f;  ///< over the size of a hatchback
    bool isFirm = true;   ///< what is braked comes to rest on it
    bool isIce = false;
};

Quat leaning(float rise) { return normalized(Quat{0, 0, 0.5f * rise, 1}); }

Ground addPlain(Scene& scene, const Material& road) {
    add(scene, fixedBody(Box{{kGround, 1, kGround}}, {0, -1, 0}, road));
    return {};
}

/// To 30°; what is braked stands on it where it is not steeper than a sixth of its friction.
Ground addHill(Scene& scene, Dice& dice, const Material& road) {
    const Quat lean = leaning(oneOf(dice, {0.05f, 0.1f, 0.2f, 0.35f, 0.57f}) * oneOf(dice, {-1.0f, 1.0f}));
    BodyDef hill = fixedBody(Box{{kGround, 1, kGround}}, DVec3{rotate(lean, Vec3{0, -1, 0})}, road);
    hill.pose.rotation = lean;
    add(scene, std::move(hill));
    return {.start = {}, .lean = lean, .isFirm = lean.z * lean.z < 0.06f * 0.06f && road.friction >= 0.6f};
}

/// Kerbs, steps and bumps across the way and aslant.
Ground addSteps(Scene& scene, Dice& dice, const Material& road) {
    addPlain(scene, road);
    for (double x = 4; x < 60; x += static_cast<double>(dice.between(1, 12))) {
        const float height = oneOf(dice, {0.02f, 0.05f, 0.1f, 0.2f, 0.4f});
        const Vec3 half{oneOf(dice, {0.1f, 0.5f, 3.0f}), height, oneOf(dice, {0.2f, 1.0f, 6.0f})};
        BodyDef step = fixedBody(Box{half},
                                 {x, static_cast<double>(oneOf(dice, {0.0f, -0.5f})) * static_cast<double>(height),
                                  static_cast<double>(dice.between(-2, 2))},
                                 road);
        step.pose.rotation = normalized(Quat{0, dice.between(-0.5f, 0.5f), 0, 1});
        add(scene, std::move(step));
    }
    return {};
}

/// Up, a gap, and down.
Ground addJump(Scene& scene, Dice& dice, const Material& road) {
    addPlain(scene, road);
    const float rise = oneOf(dice, {0.1f, 0.3f, 0.6f}), gap = dice.between(0, 6);
    for (const float side : {-1.0f, 1.0f}) {
        const Quat lean = leaning(-side * rise);
        const Vec3 half{4, 0.2f, 3};
        const Vec3 end = rotate(lean, Vec3{side * half.x, half.y, 0});  // its foot, on the floor
        BodyDef ramp = fixedBody(
            Box{half},
            {static_cast<double>(14 + side * (0.5f * gap + std::abs(end.x))), -static_cast<double>(end.y), 0}, road);
        ramp.pose.rotation = lean;
        add(scene, std::move(ramp));
    }
    return {};
}

/// Waves and lumps of up to half a metre, as a grid of heights or as triangles.
Ground addHills(Scene& scene, Dice& dice, const Material& road) {
    constexpr int kSide = 96;
    const float spacing = oneOf(dice, {0.5f, 1.0f, 2.0f}), height = oneOf(dice, {0.05f, 0.15f, 0.5f});
    std::vector<float> heights;
    for (int i = 0; i < kSide * kSide; ++i) heights.push_back(height * dice.between(0, 1));
    const double corner = 0.5 * static_cast<double>(spacing) * (kSide - 1);
    const DVec3 at{-corner, -static_cast<double>(height), -corner};
    if (coin(dice)) {
        add(scene, fixedBody(HeightField(kSide, kSide, spacing, heights), at, road));
        return {.isFirm = false};
    }
    std::vector<Vec3> points;
    std::vector<Triangle> faces;
    for (int row = 0; row < kSide; ++row)
        for (int column = 0; column < kSide; ++column) {
            const auto k = static_cast<std::uint32_t>(points.size());
            points.push_back({spacing * static_cast<float>(column), heights[k], spacing * static_cast<float>(row)});
            if (row == 0 || column == 0) continue;
            const std::uint32_t back = k - kSide;
            faces.push_back({back - 1, k - 1, k}), faces.push_back({back - 1, k, back});
        }
    add(scene, fixedBody(TriangleMesh(points, faces), at, road));
    return {.isFirm = false};
}

/// Loose boxes, balls and rollers of 1 to 500 kg, some in piles.
Ground addLitter(Scene& scene, Dice& dice, const Material& road) {
    addPlain(scene, road);
    const int count = oneOf(dice, {5, 20, 40});
    for (int i = 0; i < count; ++i) {
        const float size = magnitude(dice, 0.05f, 0.5f), mass = magnitude(dice, 1, 500);
        const Shape shape = oneOf(dice, {Shape{Box{{size, size, size}}}, Shape{Box{{size, 0.5f * size, 2 * size}}},
                                         Shape{Sphere{size}}, prism(size, 2 * size)});
        const double up = static_cast<double>(size) + 0.3 * i / 10;
        add(scene,
            solidBody(shape, {6 + 1.2 * (i % 10), up, static_cast<double>(dice.between(-1.5f, 1.5f))}, mass, road));
    }
    return {.isFirm = false};
}

Ground addCrossing(Scene& scene, Dice& dice, const Material& road) {
    addPlain(scene, road);
    const Bridge bridge = addBridge(scene, dice, road);
    return {.start = {-0.5 * bridge.span - 4, kBridgeHeight + 0.05, 0}, .widest = 0.8f, .isFirm = false};
}

/// A plate on ice, which takes what the car gives it.
Ground addPlate(Scene& scene, Dice& dice, const Material& road) {
    addPlain(scene, surface(0));
    add(scene, solidBody(Box{{40, 0.1f, 40}}, {0, 0.1, 0}, magnitude(dice, 10, 10000), road));
    return {.start = {0, 0.2, 0}, .isFirm = false, .isIce = true};
}

/// A platform that speeds up and brakes.
Ground addPlatform(Drawn& drawn, Dice& dice, const Material& road) {
    BodyDef def = fixedBody(Box{{60, 0.5f, 60}}, {0, -0.5, 0}, road);
    def.type = BodyType::kinematic;
    const int body = add(drawn.scene, std::move(def));
    drawn.rides.push_back({body,
                           {dice.between(-20, 20), 0, dice.between(-5, 5)},
                           {dice.between(-3, 3), dice.between(-3, 3), dice.between(-1, 1)},
                           1});
    return {.isFirm = false};
}

Ground addGround(Drawn& drawn, Dice& dice, const Material& road) {
    Scene& scene = drawn.scene;
    switch (dice.below(10)) {
        case 0:
        case 1:
            return addPlain(scene, road);
        case 2:
            return addHill(scene, dice, road);
        case 3:
            return addSteps(scene, dice, road);
        case 4:
            return addJump(scene, dice, road);
        case 5:
            return addHills(scene, dice, road);
        case 6:
            return addLitter(scene, dice, road);
        case 7:
            return addCrossing(scene, dice, road);
        case 8:
            return addPlate(scene, dice, road);
        default:
            return addPlatform(drawn, dice, road);
    }
}

VehicleInput drawInput(Dice& dice) {
    VehicleInput input{.throttle = oneOf(dice, {0.0f, 0.3f, 1.0f}),
                       .brake = oneOf(dice, {0.0f, 0.0f, 0.0f, 0.4f, 1.0f}),
                       .steer = oneOf(dice, {0.0f, 0.0f, -0.3f, 0.3f, -1.0f, 1.0f})};
    input.handbrake = oneOf(dice, {0.0f, 0.0f, 0.0f, 1.0f});
    input.clutch = oneOf(dice, {0.0f, 0.0f, 0.0f, 1.0f});
    if (dice.below(4) == 0) input.gear = oneOf(dice, {-1, 0, 1, 2});
    input.differentialLock = oneOf(dice, {0.0f, 1.0f});
    return input;
}

/// Driven for some seconds, or never, and then braked to the end or let roll.
void drawScript(Dice& dice, SceneVehicle& car, double driven, bool brakes) {
    VehicleInput off{.brake = brakes ? 1.0f : 0.0f, .handbrake = brakes ? 1.0f : 0.0f, .clutch = 1, .gear = 0};
    for (double time = 0; time < driven; time += static_cast<double>(dice.between(0.25f, 2)))
        car.script.push_back({time, drawInput(dice)});
    car.script.push_back({driven, off});
}

/// Upright, leaning, on its side or roof, in the air or on its wheels.
LaidCar drawStart(Dice& dice, const Ground& ground, const VehicleDef& def, float speed) {
    LaidCar laid;
    const bool stands = dice.below(4) != 0;
    const Vec3 up = rotate(ground.lean, Vec3{0, 1, 0}), ahead = rotate(ground.lean, Vec3{1, 0, 0});
    const Quat turn = normalized(Quat{0, oneOf(dice, {0.0f, 0.0f, 0.02f, -0.2f}), 0, 1});
    laid.pose = {ground.start + DVec3{0.02f * up}, ground.lean * turn * kAhead};
    laid.v = speed * rotate(ground.lean * turn, Vec3{1, 0, 0});
    if (stands) return laid;
    // About the middle of its body, high enough that nothing of it is in the ground.
    const Vec3 middle{0, def.chassis.shapes[0].frame.position.y, 0},
        half = std::get<Box>(def.chassis.shapes[0].shape).halfExtents;
    const Quat roll = oneOf(dice, {Quat{0, 0, 0.70710678f, 0.70710678f}, Quat{0, 0, 1, 0}, dice.rotation()});
    const float height = length(half) + 3 * half.y + def.wheels[0].radius * oneOf(dice, {1.0f, 5.0f});
    laid.pose.rotation = laid.pose.rotation * roll;
    laid.pose.position = ground.start + DVec3{height * up - rotate(laid.pose.rotation, middle)};
    laid.v = speed * ahead;
    laid.w = dice.between(0, 4) * anyDirection(dice);
    return laid;
}

/// A trailer behind the first car, hung where both end.
void addTrailer(Dice& dice, Drawn& drawn, const Ground& ground) {
    const SceneVehicle& car = drawn.scene.vehicles.front();
    const auto end = [](const VehicleDef& def) {
        return std::get<Box>(def.chassis.shapes[0].shape).halfExtents.z + 0.4f;
    };
    SceneVehicle trailer;
    trailer.def = drawCar(dice, {.largest = ground.widest, .isTowed = true});
    const Vec3 hook{0, car.def.chassis.shapes[0].frame.position.y, -end(car.def)};
    const Vec3 eye{0, hook.y, end(trailer.def)};
    LaidCar laid = drawn.laid.front();
    laid.pose.position = transformPoint(laid.pose, hook - eye);
    trailer.placement = car.placement;
    drawScript(dice, trailer, 0, drawn.brakes);
    BallDef ball;
    ball.bodies.frameA.position = hook, ball.bodies.frameB.position = eye;
    SceneJoint joint;
    joint.def = ball;
    joint.partA = {ScenePart::Owner::vehicle, 0, -1}, joint.partB = {ScenePart::Owner::vehicle, 1, -1};
    drawn.scene.joints.push_back(joint);
    drawn.scene.vehicles.push_back(std::move(trailer));
    drawn.laid.push_back(laid);
}

}  // namespace

Drawn drawDrive(Dice& dice) {
    Drawn drawn;
    const Material road = surface(oneOf(dice, {0.1f, 0.3f, 0.6f, 0.6f, 1.0f}));
    const Ground ground = addGround(drawn, dice, road);
    SceneVehicle car;
    car.def = drawCar(dice, {.largest = ground.widest});
    const float speed = oneOf(dice, {0.0f, 0.0f, 3.0f, 10.0f, 25.0f});
    const double driven = oneOf(dice, {0.0, 0.0, 3.0, 6.0});
    drawn.scene.step = oneOf(dice, {1.0 / 30, 1.0 / 60, 1.0 / 60, 1.0 / 120});
    car.placement.speed = speed;
    const bool isPlanar = car.def.level == VehicleLevel::bicycle;
    drawn.laid.push_back(drawStart(dice, ground, car.def, speed));
    if (isPlanar) drawn.laid.clear();  // its chassis is led, upright and on the ground
    if (isPlanar) car.placement.position = ground.start, car.placement.heading = 1.5707964f;
    if (ground.isIce) {
        for (WheelDef& wheel : car.def.wheels) wheel.tire.rollingResistance = 0;
        car.def.aerodynamics = {.dragArea = 0};
    }
    drawn.isOnIce = ground.isIce && !isPlanar;
    drawn.isDriven = isPlanar;
    drawn.brakes = ground.isFirm && !isPlanar && road.friction >= 0.3f && dice.below(4) != 0;
    // What damps nothing sways for good.
    for (WheelDef& wheel : car.def.wheels) {
        if (!drawn.brakes) break;
        wheel.suspension.dampingRatio = std::max(wheel.suspension.dampingRatio, 0.2f);
        wheel.tire.dampingRatio = std::max(wheel.tire.dampingRatio, 0.1f);
    }
    drawScript(dice, car, driven, drawn.brakes);
    // It stops at a sixth of the friction, with all that it was driven to.
    const double most = static_cast<double>(speed) + 4 * driven,
                 deceleration = static_cast<double>(road.friction) * 9.81 / 6;
    drawn.seconds = driven + (drawn.brakes ? 10 + most / deceleration : 5.0);
    drawn.scene.vehicles.push_back(std::move(car));
    if (!isPlanar && !ground.isIce && dice.below(5) == 0) addTrailer(dice, drawn, ground);
    return drawn;
}

}  // namespace ragtop::laws
