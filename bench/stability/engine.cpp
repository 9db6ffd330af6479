#include "engine.h"

#include <array>

namespace ragtop::stability {

std::span<const EngineKind> engineKinds() {
    static const std::array kinds{
        EngineKind{"ragtop", "Ragtop, default settings", makeRagtop},
    };
    return kinds;
}

}  // namespace ragtop::stability
