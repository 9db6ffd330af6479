#include "families.h"

namespace ragtop::stability {

std::vector<Family> allFamilies() {
    return {
        stacks(),      massRatios(),  masonry(),     inclines(),   stopping(),      isotropy(),  wedges(),   painleve(),
        rotation(),    rolling(),     restitution(), walls(),      chains(),        loops(),     motors(),   limits(),
        jointStates(), jointChecks(), overlaps(),    shots(),      internalEdges(), stepSizes(), machines(), dominoes(),
        towers(),      balls(),       drift(),       mechanisms(), determinism(),   nonconvex(), doors(),
    };
}

}  // namespace ragtop::stability
