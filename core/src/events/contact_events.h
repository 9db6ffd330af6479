#pragma once

#include <cstdint>

#include "base/stage_runner.h"
#include "contacts/tables.h"
#include "contacts/touch_finds.h"
#include "continuous/swept_bodies.h"
#include "events/event_log.h"
#include "ragtop/query.h"
#include "solve/kernel_table.h"

namespace ragtop {

/// What a step tells of contacts: who touches since it, and no longer; impacts, slides and rolls.
struct ContactEvents {
    const Bodies& bodies;
    const Shapes& shapes;
    Contacts& contacts;
    Manifolds& manifolds;
    const ConstraintGraph& graph;
    const SweptBodies& sweptBodies;
    const KernelTable& kernels;
    ContactFinds& contactFinds;
    EventLog& events;
    float gravity;           ///< m/s²
    float restitutionSpeed;  ///< m/s, slowest impact

    /// Contacts touch when a point carries load or overlaps; begin and end are reported in the order of the list.
    void publish(StageRunner& runner) const;

private:
    bool isTouching(ContactRecord& contact) const;
    void publishContact(std::uint32_t contact) const;
    void publishSurface(const ContactRecord& contact, const ManifoldRecord& manifold, bool wasLoaded) const;
    void publishSweptImpacts() const;
};

/// Which contacts touch is asked of all in the next step.
void forgetTouches(Manifolds& manifolds, ContactFinds& finds);
/// A manifold where its bodies are, with the impulses of the last step.
Contact describe(const ConstTables& tables, float lastSubstep, const ContactRecord& contact,
                 const ManifoldRecord& manifold);

}  // namespace ragtop
