#pragma once

#include "suite.h"

/// The families of tests, each in a file of its own (docs/stability.md says what each row means).
namespace ragtop::stability {

Family stacks();
Family massRatios();
Family masonry();
Family inclines();
Family stopping();
Family isotropy();
Family rotation();
Family rolling();
Family restitution();
Family chains();
Family overlaps();
Family shots();
Family internalEdges();
Family machines();

/// All of them, in the order of the documentation.
std::vector<Family> allFamilies();

}  // namespace ragtop::stability
