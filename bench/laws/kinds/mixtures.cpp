#include "parts.h"

namespace ragtop::laws {
namespace {

Vec3 anyWay(Dice& dice) { return normalized(Vec3{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)}, {0, 1, 0}); }

Shape anySolid(Dice& dice, float size) {
    switch (dice.below(3)) {
        case 0:
            return Sphere{size};
        case 1:
            return Capsule{0.4f * size, 0.6f * size};
        default:
            return Box{{size, size * dice.between(0.25f, 1), size * dice.between(0.25f, 1)}};
    }
}

/// One to three solids, which may overlap.
BodyDef anyCompound(Dice& dice, const DVec3& at, float densities, const Material& material) {
    BodyDef def;
    const std::uint32_t parts = dice.below(4) == 0 ? 3 : 1;
    for (std::uint32_t i = 0; i < parts; ++i) {
        ShapeDef shape{.geometry = anySolid(dice, dice.between(0.1f, 0.5f)),
                       .density = magnitude(dice, 500, 500 * densities),
                       .material = material};
        if (i > 0) shape.frame = {dice.between(0.1f, 0.5f) * anyWay(dice), dice.rotation()};
        def.shapes.push_back(std::move(shape));
    }
    def.pose = {at, dice.rotation()};
    return def;
}

Range around(Dice& dice, float most) { return {-dice.between(0.1f, most), dice.between(0.1f, most)}; }

void drawAxis(Dice& dice, float most, AxisDef& axis) {
    if (coin(dice)) axis.limit = around(dice, most);
    if (dice.below(4) == 0) axis.motor = Motor{.targetSpeed = dice.between(-3, 3), .maxForce = magnitude(dice, 1, 1000)};
}

Motor anyMotor(Dice& dice, float speed, float force) {
    return {.targetSpeed = dice.between(-speed, speed), .maxForce = magnitude(dice, force / 1000, force)};
}

Spring anySpring(Dice& dice) { return {.stiffness = magnitude(dice, 10, 10000), .damping = magnitude(dice, 0.1f, 100)}; }

/// Fills in what a joint has beside its bodies.
void drawOptions(Dice&, FixedDef&) {}
void drawOptions(Dice& dice, BallDef& def) {
    if (coin(dice)) return;
    def.swingLimit = dice.between(0.3f, 1.5f);
    def.twistLimit = around(dice, 1.5f);
    def.friction = magnitude(dice, 0.1f, 10);
    if (coin(dice)) def.spring = anySpring(dice);
}
void drawOptions(Dice& dice, HingeDef& def) {
    if (coin(dice)) def.limit = around(dice, 1.5f);
    if (coin(dice)) def.motor = anyMotor(dice, 10, 1000);
    if (dice.below(4) == 0) def.spring = anySpring(dice);
}
void drawOptions(Dice& dice, SliderDef& def) {
    def.limit = around(dice, 1);
    if (coin(dice)) def.motor = anyMotor(dice, 2, 10000);
}
void drawOptions(Dice& dice, DistanceDef& def) { def.limit = Range{0, dice.between(0.1f, 1)}; }
void drawOptions(Dice& dice, CylindricalDef& def) { drawAxis(dice, 1.5f, def.turn), drawAxis(dice, 0.5f, def.travel); }
void drawOptions(Dice& dice, UniversalDef& def) { drawAxis(dice, 1, def.first), drawAxis(dice, 1, def.second); }
void drawOptions(Dice& dice, PlaneDef& def) { drawAxis(dice, 0.5f, def.y), drawAxis(dice, 0.5f, def.z); }
void drawOptions(Dice& dice, ScrewDef& def) { def.pitch = dice.between(0.01f, 0.2f), drawAxis(dice, 1.5f, def.turn); }
void drawOptions(Dice& dice, SixDofDef& def) { drawAxis(dice, 1, def.twist); }

template <class Def>
void joinBy(Scene& scene, Dice& dice, int a, int b, const DVec3& point) {
    scene.joints.push_back({{}, a, b, Def{}});
    Def& def = std::get<Def>(scene.joints.back().def);
    def.bodies = jointFrames(scene, a, b, point, anyWay(dice));
    def.bodies.collide = dice.below(3) == 0;
    drawOptions(dice, def);
}

void join(Scene& scene, Dice& dice, int a, int b, const DVec3& point) {
    using Join = void (*)(Scene&, Dice&, int, int, const DVec3&);
    const Join by = oneOf<Join>(dice, {joinBy<BallDef>, joinBy<HingeDef>, joinBy<FixedDef>, joinBy<SliderDef>, joinBy<DistanceDef>,
                                 joinBy<CylindricalDef>, joinBy<UniversalDef>, joinBy<PlaneDef>, joinBy<ScrewDef>, joinBy<SixDofDef>});
    by(scene, dice, a, b, point);
}

}  // namespace

Drawn drawMixture(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material matter = surface(dice.between(0.2f, 0.9f), dice.below(4) == 0 ? 0.5f : 0.0f);
    addFloor(scene, matter);
    if (coin(dice)) {
        BodyDef plate = fixedBody(Box{{2, 0.2f, 2}}, {0, 1, 0}, matter);
        plate.type = BodyType::kinematic;
        plate.linearVelocity = {dice.between(-1, 1), 0, 0};
        plate.angularVelocity = {0, dice.between(-1, 1), 0};
        add(scene, std::move(plate));
    }
    const std::uint32_t groups = 2 + dice.below(5);
    for (std::uint32_t g = 0; g < groups; ++g) {
        const float densities = oneOf(dice, {1.0f, 100.0f});
        const bool hung = dice.below(3) == 0, joined = dice.below(4) != 0;
        const std::uint32_t count = 2 + dice.below(10);
        DVec3 at{static_cast<double>(dice.between(-3, 3)), static_cast<double>(dice.between(2, 6)), static_cast<double>(dice.between(-3, 3))};
        int before = hung ? kWorld : -2, first = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const int body = add(scene, anyCompound(dice, at, densities, matter));
            const DVec3 way = 0.5 * DVec3{anyWay(dice)};
            if (joined && before != -2) join(scene, dice, before, body, at - 0.5 * way);
            if (i == 0) first = body;
            before = body;
            at = at + way;
        }
        if (joined && count > 3 && dice.below(3) == 0) join(scene, dice, first, before, at);
    }
    drawn.isDriven = true;
    drawn.seconds = 8;
    return drawn;
}

}  // namespace ragtop::laws
