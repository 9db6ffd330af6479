#include "parts.h"

namespace ragtop::laws {
namespace {

void addStack(Scene& scene, Dice& dice, const Material& material) {
    const int count = oneOf(dice, {5, 10, 20, 40});
    for (int i = 0; i < count; ++i) add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5 + i, 0}, 1, material));
}

void addPyramid(Scene& scene, Dice& dice, const Material& material) {
    const int base = oneOf(dice, {4, 8});
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {(i - (base - row - 1) / 2.0) * 1.02, 0.5 + row, 0}, 1, material));
    if (coin(dice)) add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, base + 0.5, 0}, 300, material));
}

void addHeavyOnLight(Scene& scene, Dice& dice, const Material& material) {
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, 1, material));
    add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, {0, 1.5, 0}, magnitude(dice, 10, 10000), material));
}

}  // namespace

Drawn drawCarried(Dice& dice) {
    Drawn drawn;
    Scene& scene = drawn.scene;
    const Material matter = surface(0.5f);
    const float speed = oneOf(dice, {0.0f, 0.1f, 2.0f, 10.0f, 50.0f});
    const Vec3 v{speed * dice.between(-1, 1), coin(dice) ? 0.25f * speed : 0.0f, speed};
    BodyDef platform = fixedBody(Box{{20, 1, 20}}, {0, -1, 0}, matter);
    platform.type = BodyType::kinematic;
    platform.linearVelocity = v;
    add(scene, std::move(platform));
    oneOf(dice, {addStack, addPyramid, addHeavyOnLight})(scene, dice, matter);
    for (SceneBody& body : scene.bodies) body.def.linearVelocity = v;
    drawn.stands = true;
    drawn.seconds = 20;
    return drawn;
}

}  // namespace ragtop::laws
