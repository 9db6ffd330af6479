#pragma once

#include <atomic>
#include <cstdint>
#include <memory_resource>
#include <span>

#include "model/module_work.h"
#include "broadphase/broadphase.h"
#include "contacts/contact_writer.h"
#include "contacts/ghost_contacts.h"
#include "events/event_log.h"
#include "islands/articulations.h"
#include "islands/direct_set.h"
#include "islands/islands.h"

/// Who takes part: which contacts there are, which constraints are in the graph, and which bodies are awake, asleep or
/// frozen.
namespace ragtop {

/// Which bodies a step solves (freezing.cpp).
struct Freezing {
    explicit Freezing(std::pmr::memory_resource* memory) : unfrozen(memory) {}
    /// Counts the steps for which a body has been still; `slow`: below what counts as that, over the whole step.
    void record(BodyRecord& body, bool slow);
    /// m/s, when gravity gives so much in a substep.
    static float slowest(float gravityStep);
    std::atomic<bool> anyStill{false};      ///< has any body been still for long enough to rest?
    std::span<const std::uint32_t> solved;  ///< awake bodies that do not rest
    AlignedArray<std::uint32_t> unfrozen;   ///< the same while some rest
};

/// May the joint hold anything? Bodies that are enabled, of which forces move one.
bool mayHold(const Bodies& bodies, const JointRecord& joint);

/// What changes as things come to take part, or no longer do.
struct Activity {
    Bodies& bodies;
    const Shapes& shapes;
    Contacts& contacts;
    Manifolds& manifolds;
    Joints& joints;
    const Couplings& couplings;
    ConstraintGraph& graph;
    Broadphase& broadphase;  ///< pairs
    Islands& islands;        ///< that solvers are to be chosen anew; the stack of bodies that wake
    Articulations& articulations;
    DirectSet& directSet;
    ContactFinds& contactFinds;
    EventLog& events;
    ContactWriter writer;

    // contact_changes.cpp
    void createContact(std::uint32_t shapeA, std::uint32_t shapeB) const;
    void destroyContact(std::uint32_t contact) const;
    /// Contacts that came or went in the narrow phase, in the order of the list, so that colours depend on the scene
    /// alone. `mayStore`: bodies may fall asleep in this step.
    void applyContactChanges(const GhostView& ghosts, bool mayStore) const;

    // membership.cpp
    void addToGraph(std::uint32_t manifold) const;
    /// The load of a contact that a direct solve has left, as one that is carried.
    void carryWholeLoad(std::uint32_t manifold) const;
    void removeFromGraph(std::uint32_t manifold) const;
    void addJointToGraph(std::uint32_t joint) const;
    void removeJointFromGraph(std::uint32_t joint) const;
    /// Moves all constraints of islands that are, or no longer are, solved directly to the list of their solver: of
    /// some islands if there are lists of them.
    void applyChoices(const ConstTables& tables, const IslandLists* some) const;

    // sleeping.cpp
    /// Islands that have been quiet for so many seconds.
    void sleepQuietIslands(const ConstTables& tables, float sleepTime) const;
    /// Takes a body out of all awake lists; its constraints keep their impulses for the day it wakes.
    void sleepBody(std::uint32_t body) const;
    /// The same, and nobody is told.
    void leaveAwake(std::uint32_t body) const;
    /// Wakes a body and all sleeping ones that it touches or is joined to, directly or through others.
    void wakeBody(std::uint32_t body) const;
    /// Those on the stack of Islands.
    void wakeStack() const;
    /// Puts a body into the lists of what is awake, with its constraints; what wakes with it is put on the stack.
    void enterAwake(std::uint32_t body) const;
    /// Puts the contacts of a body that woke back into the graph, those with bodies that still sleep excepted.
    void restoreContacts(std::uint32_t body) const;
    /// A body and all that touch it or are joined to it.
    void wakeTouching(std::uint32_t body) const;

    // freezing.cpp
    /// Bodies that have been still for long enough come to rest where they are.
    void freezeStillBodies(Freezing& freezing, const ModuleWork& moduleWork, bool mayFreeze) const;
    /// Something has changed about a body that rests: it is solved again.
    void unfreeze(std::uint32_t body) const;
    /// The bodies that this step solves.
    void collectSolved(Freezing& freezing, const ModuleWork& moduleWork, bool mayFreeze) const;

private:
    void addAwakeContact(std::uint32_t contact) const;
    void applyContactChange(std::uint32_t contact, const GhostView& ghosts) const;
    void recordShiftedLoads() const;
    void recordGraphChange(GraphPlace place) const;
    void recordSleep(std::uint32_t body, bool asleep) const;
    void pushJoined(std::uint32_t body) const;
    void pushCoupledBodies(std::uint32_t joint) const;
};

}  // namespace ragtop
