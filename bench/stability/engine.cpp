#include "engine.h"

#include <vector>

namespace ragtop::stability {

std::span<const EngineKind> engineKinds() {
    static const std::vector<EngineKind> kinds{
        {"ragtop", [](const Scene& scene) { return makeRagtop(scene); }},
#ifdef RAGTOP_WITH_BULLET
        {"bullet", [](const Scene& scene) { return makeBullet(scene); }},
        {"bullet-50", [](const Scene& scene) { return makeBullet(scene, {.iterations = 50}); }},
        {"bullet-240", [](const Scene& scene) { return makeBullet(scene, {.substeps = 4}); }},
#else
        {"bullet", nullptr},
        {"bullet-50", nullptr},
        {"bullet-240", nullptr},
#endif
#ifdef RAGTOP_WITH_MUJOCO
        {"mujoco", [](const Scene& scene) { return makeMujoco(scene); }},
        {"mujoco-trees", [](const Scene& scene) { return makeMujoco(scene, {.joints = MujocoJoints::trees}); }},
#else
        {"mujoco", nullptr},
        {"mujoco-trees", nullptr},
#endif
#ifdef RAGTOP_WITH_ODE
        {"ode", [](const Scene& scene) { return makeOde(scene); }},
        {"ode-exact", [](const Scene& scene) { return makeOde(scene, {.exact = true}); }},
#else
        {"ode", nullptr},
        {"ode-exact", nullptr},
#endif
    };
    return kinds;
}

}  // namespace ragtop::stability
