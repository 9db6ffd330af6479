#pragma once

#include <string>

#include "broadphase/broadphase.h"
#include "contacts/tables.h"

namespace ragtop {

/// The first fact that does not hold between two calls: about lists, tables, the graph and its lanes, sleep, the broad
/// phase and numbers; empty when all do. As slow as saving the world; see World::validate.
std::string firstBroken(const ConstTables& tables, const Broadphase& broadphase);

}  // namespace ragtop
