#include "families.h"

namespace ragtop::stability {

std::vector<Family> allFamilies() {
    return {
        stacks(), massRatios(), inclines(), stopping(), isotropy(),
    };
}

}  // namespace ragtop::stability
