#pragma once

#include "../suite.h"

namespace ragtop::stability {

void addSqueezerCases(Family& family);

}  // namespace ragtop::stability
