#include "parts.h"

namespace ragtop::laws {
namespace {

constexpr Vec3 kAcross{0, 0, 1};

/// A bar of square section between two points.
int addBar(Scene& scene, const DVec3& from, const DVec3& to, float half, float mass, const Material& wood) {
    const DVec3 way = to - from;
    const auto length = static_cast<float>(std::sqrt(dot(way, way)));
    BodyDef def = solidBody(Box{{length / 2, half, half}}, 0.5 * (from + to), mass, wood);
    def.pose.rotation = rotationBetween({1, 0, 0}, (1 / length) * toVec3(way));
    return add(scene, std::move(def));
}

/// Bars on balls from a point of one body, in a line; returns the last bar.
int addChain(Scene& scene, int body, const DVec3& from, const DVec3& to, int links, float mass, const Material& wood) {
    DVec3 at = from;
    for (int i = 0; i < links; ++i) {
        const DVec3 next = from + (static_cast<double>(i + 1) / links) * (to - from);
        const int bar = addBar(scene, at, next, 0.05f, mass, wood);
        addBall(scene, body, bar, at);
        body = bar, at = next;
    }
    return body;
}

/// Boxes on each other.
void addStack(Scene& scene, Dice& dice, DVec3 at, int count, float mass, const Material& wood) {
    for (int i = 0; i < count; ++i) {
        const float half = dice.between(0.1f, 0.3f);
        at.y += static_cast<double>(half) + 0.002;
        add(scene, solidBody(Box{{half, half, half}}, at, mass * magnitude(dice, 0.1f, 10), wood));
        at.y += static_cast<double>(half);
    }
}

/// A deck of planks, joined or not, that hangs by ropes from two cables of bars between towers; loads fall on it.
void drawSuspended(Scene& scene, Dice& dice, const Material& wood) {
    constexpr double kSpacing = 0.8, kDeck = 12;
    const int planks = oneOf(dice, {8, 16, 24});
    const float plank = magnitude(dice, 5, 200), bar = plank * oneOf(dice, {0.02f, 0.1f, 0.5f});
    const double span = planks * kSpacing, sag = span * static_cast<double>(dice.between(0.08f, 0.25f));
    const bool isJoined = coin(dice);
    const auto node = [&](int i, double z) {
        const double x = (i - planks / 2.0) * kSpacing;
        return DVec3{x, kDeck + 1 + 4 * sag * x * x / (span * span), z};
    };
    std::vector<int> deck;
    for (int i = 0; i < planks; ++i) {
        const double x = (i + 0.5 - planks / 2.0) * kSpacing;
        deck.push_back(add(scene, solidBody(Box{{0.38f, 0.05f, 1}}, {x, kDeck, 0}, plank, wood)));
        const DVec3 edge{x - kSpacing / 2, kDeck, 0};
        if (i == 0 || isJoined) addHinge(scene, i == 0 ? kWorld : deck[deck.size() - 2], deck.back(), edge, kAcross);
    }
    addHinge(scene, deck.back(), kWorld, {span / 2, kDeck, 0}, kAcross);
    for (const double z : {-0.9, 0.9}) {
        int before = kWorld;
        for (int i = 0; i < planks; ++i) {
            const int own = addBar(scene, node(i, z), node(i + 1, z), 0.04f, bar, wood);
            addBall(scene, before, own, node(i, z));
            const DVec3 x = {kSpacing * 0.05, 0, 0}, low{node(i, z).x, kDeck, z};
            DistanceDef& rope = addDistance(scene, own, deck[static_cast<std::size_t>(i)], node(i, z), low + x);
            const DVec3 way = node(i, z) - low - x;
            rope.limit = Range{0, static_cast<float>(std::sqrt(dot(way, way)))};
            before = own;
        }
        addBall(scene, before, kWorld, node(planks, z));
    }
    for (int loads = oneOf(dice, {1, 3, 6}); loads > 0; --loads) {
        const float half = dice.between(0.15f, 0.4f);
        BodyDef load = solidBody(Box{{half, half, half}},
                                 {static_cast<double>(dice.between(-0.4f, 0.4f)) * span, kDeck + 0.5 + loads, 0},
                                 plank * magnitude(dice, 0.1f, 50), wood);
        load.linearVelocity = {dice.between(-5, 5), dice.between(-8, 0), 0};
        add(scene, std::move(load));
    }
}

/// A leaf on a driven hinge, by itself or with a beam above it on rods, lifts what stands on it.
void drawDrawbridge(Scene& scene, Dice& dice, const Material& wood) {
    const float length = dice.between(2, 6), mass = magnitude(dice, 50, 2000);
    const double height = 6, half = 0.5 * static_cast<double>(length);
    const int leaf = add(scene, solidBody(Box{{length / 2, 0.1f, 1}}, {half, height, 0}, mass, wood));
    HingeDef& hinge = addHinge(scene, kWorld, leaf, {0, height, 0}, kAcross);
    hinge.limit = Range{-0.02f, dice.between(0.8f, 1.4f)};
    const float torque = mass * 9.81f * length / 2 * magnitude(dice, 0.3f, 30);
    hinge.motor = Motor{.targetSpeed = (coin(dice) ? 1.0f : -1.0f) * magnitude(dice, 0.2f, 5), .maxForce = torque};
    if (coin(dice)) {
        const double above = height + 3, back = -static_cast<double>(dice.between(0.3f, 1));
        const int beam = addBar(scene, {back * half * 2, above, 0}, {2 * half, above, 0}, 0.1f, mass / 4, wood);
        addHinge(scene, kWorld, beam, {0, above, 0}, kAcross);
        const double x = 2 * half - 0.1;
        DistanceDef& rod = addDistance(scene, beam, leaf, {x, above, 0}, {x, height, 0});
        rod.limit = Range{coin(dice) ? 0.0f : 3.0f, 3};
        const float weight = mass * magnitude(dice, 0.5f, 20);
        const DVec3 low{back * half * 2, above - 1, 0};
        const int load = add(scene, solidBody(Box{{0.4f, 0.4f, 0.4f}}, low, weight, wood));
        addBall(scene, addChain(scene, beam, low + DVec3{0, 1, 0}, low + DVec3{0, 0.4, 0}, 2, mass / 100, wood), load,
                low + DVec3{0, 0.4, 0});
    }
    for (int stacks = static_cast<int>(dice.below(3)); stacks > 0; --stacks)
        addStack(scene, dice, {half * (0.3 + 0.5 * stacks), height + 0.1, 0}, 1 + static_cast<int>(dice.below(3)),
                 mass * magnitude(dice, 0.02f, 2), wood);
}

/// A heavy ball on a chain swings into a bridge.
void drawWrecker(Scene& scene, Dice& dice, const Material& wood) {
    const Bridge bridge = addBridge(scene, dice, wood);
    const float radius = dice.between(0.2f, 0.5f), mass = bridge.plank * magnitude(dice, 1, 300);
    const double x = static_cast<double>(dice.between(-0.3f, 0.3f)) * bridge.span, length = 3 + 3 * dice.between(0, 1);
    const DVec3 top{x, bridge.height(x) + length + static_cast<double>(radius) + 0.1 * dice.between(-1, 1), 0};
    const double aside = static_cast<double>(dice.between(0.3f, 0.95f)) * (coin(dice) ? 1 : -1);
    const DVec3 way =
        coin(dice) ? DVec3{aside, -std::sqrt(1 - aside * aside), 0} : DVec3{0, -std::sqrt(1 - aside * aside), aside};
    const DVec3 at = top + length * way;
    const int ball = add(scene, solidBody(Sphere{radius}, at, mass, wood));
    const DVec3 end = at - static_cast<double>(radius) * way;
    addBall(scene,
            addChain(scene, kWorld, top, end, oneOf(dice, {2, 6, 12}), mass * oneOf(dice, {0.002f, 0.02f}), wood), ball,
            end);
    if (coin(dice)) addStack(scene, dice, {x, bridge.height(x) + 0.1, 0}, 3, bridge.plank, wood);
}

/// Cars on balls, rods or springs behind each other, over a bridge.
void drawTrain(Scene& scene, Dice& dice, const Material& wood) {
    const Bridge bridge = addBridge(scene, dice, wood);
    const int cars = 2 + static_cast<int>(dice.below(6));
    const float mass = bridge.plank * magnitude(dice, 1, 50), speed = dice.between(0, 8);
    const std::uint32_t by = dice.below(3);
    double x = -0.5 * bridge.span - 1.5;
    int before = kWorld;
    for (int i = 0; i < cars; ++i, x -= 2.2) {
        const DVec3 at{x, kBridgeHeight + 0.06, 0};
        const int car = addCar(scene, dice, at, mass * magnitude(dice, 0.3f, 3), speed, wood);
        const DVec3 middle = scene.bodies[static_cast<std::size_t>(car)].def.pose.position;
        const DVec3 front = middle + DVec3{0.9, 0, 0}, back = middle + DVec3{1.3, 0, 0};
        if (i > 0 && by == 0) addBall(scene, before, car, middle + DVec3{1.1, 0, 0});
        if (i > 0 && by > 0) {
            DistanceDef& rod = addDistance(scene, before, car, {back.x, front.y, 0}, front);
            rod.rest = 0.4f;
            if (by == 1)
                rod.limit = Range{0.4f, 0.4f};
            else
                rod.spring = Spring{.stiffness = mass * magnitude(dice, 100, 1e5f), .damping = mass};
        }
        before = car;
    }
    if (x < -0.5 * bridge.span - 9)  // beyond the bank
        add(scene, fixedBody(Box{{10, 0.05f, 2}}, {-0.5 * bridge.span - 20.05, kBridgeHeight, 0}, wood));
}

/// An arm with a weight, hung or fixed, and something to throw.
void drawCatapult(Scene& scene, Dice& dice, const Material& wood) {
    const double height = 3, arm = 4, share = static_cast<double>(dice.between(0.15f, 0.5f));
    const float mass = magnitude(dice, 5, 100), weight = mass * magnitude(dice, 1, 100);
    const double rise = static_cast<double>(dice.between(0.2f, 0.6f));  // of the short end
    const Vec3 along{static_cast<float>(std::sqrt(1 - rise * rise)), static_cast<float>(rise), 0};
    const DVec3 pivot{0, height, 0}, low = pivot - (1 - share) * arm * DVec3{along},
                                     high = pivot + share * arm * DVec3{along};
    const int beam = addBar(scene, low, high, 0.1f, mass, wood);
    HingeDef& hinge = addHinge(scene, kWorld, beam, pivot, kAcross);
    if (coin(dice)) hinge.limit = Range{-dice.between(0.8f, 2.5f), 0.1f};
    const float half = dice.between(0.2f, 0.5f);
    const DVec3 below = high - DVec3{0, 0.5 + static_cast<double>(half), 0};
    const int load = add(scene, solidBody(Box{{half, half, half}}, coin(dice) ? below : high, weight, wood));
    addHinge(scene, beam, load, high, kAcross);
    const float radius = dice.between(0.1f, 0.3f);
    const DVec3 up{-along.y, along.x, 0};
    const int stone =
        add(scene, solidBody(Sphere{radius}, low + 0.2 * DVec3{along} + (0.1 + static_cast<double>(radius)) * up,
                             mass * magnitude(dice, 0.01f, 2), wood));
    if (coin(dice)) {  // in a sling
        const DVec3 at = scene.bodies[static_cast<std::size_t>(stone)].def.pose.position;
        addDistance(scene, beam, stone, low, at).limit = Range{0, dice.between(0.5f, 2)};
    }
    addStack(scene, dice, {2 + 3 * dice.between(0, 1), 0, 0}, 4, mass, wood);
}

/// A plank on a hinge, on a block or on a rail, a stack on one end, something heavy falls on the other.
void drawSeesaw(Scene& scene, Dice& dice, const Material& wood) {
    const float mass = magnitude(dice, 10, 200);
    int base = kWorld;
    if (coin(dice))
        base = add(scene, solidBody(Box{{0.4f, 0.5f, 0.5f}}, {0, 0.5, 0}, mass * magnitude(dice, 0.5f, 10), wood));
    const int plank = add(scene, solidBody(Box{{2, 0.06f, 0.5f}}, {0, 1.1, 0}, mass, wood));
    if (dice.below(4) != 0) addHinge(scene, base, plank, {0, 1.1, 0}, kAcross);
    addStack(scene, dice, {-1.6, 1.16, 0}, 1 + static_cast<int>(dice.below(6)), mass * magnitude(dice, 0.02f, 5), wood);
    const float half = dice.between(0.2f, 0.5f);
    BodyDef load =
        solidBody(coin(dice) ? Shape{Box{{half, half, half}}} : Shape{Sphere{half}},
                  {1.5, 2 + 6 * static_cast<double>(dice.between(0, 1)), 0}, mass * magnitude(dice, 0.3f, 100), wood);
    load.angularVelocity = {0, 0, dice.between(-5, 5)};
    add(scene, std::move(load));
}

/// Wagons in a row, one runs into them.
void drawWagons(Scene& scene, Dice& dice, const Material& wood) {
    constexpr double kPitch = 2.2;  // m: wheels of 0.4 m that stand 0.7 m before and behind the middles meet
    const int wagons = 2 + static_cast<int>(dice.below(8));
    const float mass = magnitude(dice, 10, 1000);
    const bool isEven = coin(dice), isSprung = coin(dice);
    int before = kWorld;
    for (int i = 0; i < wagons; ++i) {
        const bool strikes = i + 1 == wagons;
        const DVec3 at{-kPitch * i - (strikes ? 2.0 : 0.001 * i), 0.002, 0};
        const int car = addCar(scene, dice, at, isEven ? mass : mass * magnitude(dice, 0.1f, 10),
                               strikes ? dice.between(1, 20) : 0.0f, wood);
        if (i > 0 && !strikes && isSprung) {
            const DVec3 middle = scene.bodies[static_cast<std::size_t>(car)].def.pose.position;
            DistanceDef& buffer =
                addDistance(scene, before, car, middle + DVec3{kPitch, 0.1, 0}, middle + DVec3{0, 0.1, 0});
            buffer.rest = static_cast<float>(kPitch);
            buffer.spring = Spring{.stiffness = mass * magnitude(dice, 100, 1e5f), .damping = 0};
        }
        before = car;
    }
}

/// A driven wheel with a rod and a piston that presses a heap in a pit.
void drawPress(Scene& scene, Dice& dice, const Material& wood) {
    const float mass = magnitude(dice, 10, 1000), radius = dice.between(0.3f, 0.8f);
    const double height = 6, rod = 2.5 * static_cast<double>(radius), y = height - static_cast<double>(radius) - rod;
    const int wheel = add(scene, solidBody(prism(radius, 0.2f), {0, height, 1}, mass, wood));
    HingeDef& hinge = addHinge(scene, kWorld, wheel, {0, height, 1}, kAcross);
    const float torque = mass * 9.81f * radius * magnitude(dice, 0.3f, 300), speed = magnitude(dice, 0.5f, 20);
    hinge.motor = Motor{.targetSpeed = coin(dice) ? speed : -speed, .maxForce = torque};
    const double start = static_cast<double>(dice.between(-0.95f, 0.95f)), r = static_cast<double>(radius) * 0.9;
    const DVec3 pin{r * start, height - r * std::sqrt(1 - start * start), 1};
    const DVec3 end{0, pin.y - std::sqrt(rod * rod - pin.x * pin.x), 1};
    const int bar = addBar(scene, pin, end, 0.05f, mass * oneOf(dice, {0.01f, 0.1f}), wood);
    coin(dice) ? static_cast<void>(addHinge(scene, wheel, bar, pin, kAcross)) : addBall(scene, wheel, bar, pin);
    const int piston =
        add(scene, solidBody(Box{{0.7f, 0.2f, 0.7f}}, {0, end.y - 0.2, 0}, mass * magnitude(dice, 0.1f, 10), wood));
    addHinge(scene, bar, piston, end, kAcross);
    addSlider(scene, kWorld, piston, {0, end.y - 0.2, 0}, {0, 1, 0});
    const double bottom = y - 0.5 - 2 * static_cast<double>(dice.between(0, 0.8f));
    add(scene, fixedBody(Box{{1.2f, 0.5f, 1.2f}}, {0, bottom - 0.5, 0}, wood));
    for (const Vec3& side : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
        add(scene, fixedBody(Box{{0.2f + std::abs(side.z), 0.8f, 0.2f + std::abs(side.x)}},
                             DVec3{0, bottom + 0.5, 0} + DVec3{side}, wood));
    for (int i = static_cast<int>(dice.below(24)); i >= 0; --i) {
        const float half = dice.between(0.05f, 0.15f);
        const DVec3 at = DVec3{0.4 * (i % 3 - 1), bottom + 0.2 + 0.3 * (i / 9), 0.4 * (i / 3 % 3 - 1)};
        add(scene, solidOfDensity(coin(dice) ? Shape{Box{{half, half, half}}} : Shape{Sphere{half}}, at,
                                  magnitude(dice, 100, 10000), wood));
    }
}

}  // namespace

Drawn drawMachine(Dice& dice) {
    using Draw = void (*)(Scene&, Dice&, const Material&);
    static constexpr Draw kDraws[] = {drawSuspended, drawDrawbridge, drawWrecker, drawTrain,
                                      drawCatapult,  drawSeesaw,     drawWagons,  drawPress};
    Drawn drawn;
    const Material wood = surface(oneOf(dice, {0.3f, 0.6f, 1.0f}));
    addFloor(drawn.scene, wood);
    kDraws[dice.below(std::size(kDraws))](drawn.scene, dice, wood);
    drawn.seconds = 8;
    return drawn;
}

}  // namespace ragtop::laws
