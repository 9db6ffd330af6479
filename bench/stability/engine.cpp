#include "engine.h"

#include <vector>

namespace ragtop::stability {

std::span<const EngineKind> engineKinds() {
    static const std::vector<EngineKind> kinds{
        {"ragtop", makeRagtop},
#ifdef RAGTOP_WITH_BULLET
        {"bullet", makeBullet}, {"bullet-50", makeBullet50},       {"bullet-240", makeBullet240},
#else
        {"bullet", nullptr},    {"bullet-50", nullptr},    {"bullet-240", nullptr},
#endif
#ifdef RAGTOP_WITH_MUJOCO
        {"mujoco", makeMujoco}, {"mujoco-trees", makeMujocoTrees},
#else
        {"mujoco", nullptr},    {"mujoco-trees", nullptr},
#endif
#ifdef RAGTOP_WITH_ODE
        {"ode", makeOde},       {"ode-exact", makeOdeExact},
#else
        {"ode", nullptr},       {"ode-exact", nullptr},
#endif
    };
    return kinds;
}

}  // namespace ragtop::stability
