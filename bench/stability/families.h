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
Family wedges();
Family painleve();
Family rotation();
Family rolling();
Family restitution();
Family walls();
Family chains();
Family loops();
Family motors();
Family limits();
Family jointStates();
Family jointChecks();
Family overlaps();
Family shots();
Family internalEdges();
Family stepSizes();
Family machines();
Family dominoes();
Family towers();
Family balls();
Family drift();
Family mechanisms();
Family determinism();
Family nonconvex();
Family doors();

/// All of them, in the order of the documentation.
std::vector<Family> allFamilies();

}  // namespace ragtop::stability
