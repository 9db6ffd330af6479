#pragma once

#include "suite.h"

/// The families of tests, each in a file of its own (docs/stability.md says what each row means).
namespace ragtop::stability {

Family stacks();
Family massRatios();
Family inclines();
Family stopping();
Family isotropy();

/// All of them, in the order of the documentation.
std::vector<Family> allFamilies();

}  // namespace ragtop::stability
