#include "families.h"

namespace ragtop::stability {

std::vector<Family> allFamilies() {
    return {
        stacks(),   massRatios(), masonry(), inclines(), stopping(), isotropy(),      rotation(), rolling(), restitution(),
        chains(),   overlaps(),   shots(),    internalEdges(), machines(),
    };
}

}  // namespace ragtop::stability
