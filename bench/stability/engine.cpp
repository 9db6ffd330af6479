#include "engine.h"

#include <vector>

namespace ragtop::stability {

std::span<const EngineKind> engineKinds() {
    static const std::vector<EngineKind> kinds{
        {"ragtop", makeRagtop},
#ifdef RAGTOP_WITH_BULLET
        {"bullet", makeBullet}, {"bullet-240", makeBullet240},
#endif
#ifdef RAGTOP_WITH_MUJOCO
        {"mujoco", makeMujoco},
#endif
#ifdef RAGTOP_WITH_ODE
        {"ode", makeOde},       {"ode-exact", makeOdeExact},
#endif
    };
    return kinds;
}

}  // namespace ragtop::stability
