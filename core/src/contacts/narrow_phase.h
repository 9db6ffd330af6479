#pragma once

#include <cstdint>

#include "base/stage_runner.h"
#include "broadphase/broadphase.h"
#include "contacts/contact_writer.h"
#include "contacts/ghost_contacts.h"
#include "contacts/pair_places.h"

namespace ragtop {

/// The narrow phase of all awake contacts, once per step: what touches, and what of a contact that changes.
struct NarrowPhase {
    Bodies& bodies;  ///< how far each may go in the step
    const Shapes& shapes;
    Contacts& contacts;
    Manifolds& manifolds;
    const Broadphase& broadphase;
    ContactFinds& contactFinds;  ///< per contact, what changes
    ContactWriter writer;
    GhostView ghosts;
    float dt;  ///< s, of the step

    /// Contacts are found early enough that the motion of the step cannot pass them.
    void collide(StageRunner& runner);
    /// What sensors overlap where the bodies are at the end of the step. Their manifolds carry no impulses and need no
    /// place.
    void updateSensors(StageRunner& runner);

private:
    void lookAhead(StageRunner& runner);
    void updateSome(int begin, int end, int last, int worker);
    void updateContact(std::uint32_t contact, const PairPlace& place, int worker);
    std::uint8_t keepManifolds(ContactRecord& contact);
    bool reuseManifolds(ContactRecord& contact, const PairPlace& place, double travel) const;
    int findKept(ContactRecord& contact, const PairPlace& place, Manifold* found);
    std::uint8_t collideAnew(ContactRecord& contact, const PairPlace& place, double travel, int worker);
    void prefetchCollision(const ContactRecord& contact) const;
    void prefetchShapes(const ContactRecord& contact) const;
};

}  // namespace ragtop
