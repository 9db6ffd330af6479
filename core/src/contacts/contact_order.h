#pragma once

#include "base/pair_set.h"
#include "base/stage_memory.h"
#include "constraints/constraint_graph.h"
#include "contacts/contacts.h"
#include "contacts/manifolds.h"
#include "model/bodies.h"

namespace ragtop {

/// All that knows the numbers of contacts and manifolds.
struct ContactTables {
    Bodies& bodies;
    Contacts& contacts;
    Manifolds& manifolds;
    PairSet& pairs;
    ConstraintGraph& graph;
};

/// Puts contacts, their manifolds and their lanes in the order of space where as many were made since the last time as
/// there are. True where it did: then every number of a contact or manifold that was kept elsewhere is out of date.
bool orderContacts(const ContactTables& tables, StageMemory& memory);

}  // namespace ragtop
