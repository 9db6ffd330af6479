// Bullet in double precision has the same names as in single. This file and Bullet's adapter make a module of their
// own, built with BT_USE_DOUBLE_PRECISION, whose names nobody else sees.
#include "../engine.h"

extern "C" __attribute__((visibility("default"))) ragtop::stability::Engine* ragtopMakeBulletDouble(
    const ragtop::Scene* scene, const ragtop::stability::BulletOptions* options) {
    return ragtop::stability::makeBullet(*scene, *options).release();
}
