#pragma once

#include <cstdint>
#include <span>

#include "contacts/surfaces.h"
#include "contacts/tables.h"
#include "contacts/touch_finds.h"
#include "narrowphase/manifold.h"

namespace ragtop {

/// Writes what is found of contacts into their manifolds, and into the lanes of those in the graph.
struct ContactWriter {
    const Bodies& bodies;
    const Shapes& shapes;
    Contacts& contacts;
    Manifolds& manifolds;
    ConstraintGraph& graph;
    const WorldCallbacks& callbacks;
    bool surfacesForgotten;  ///< lanes are to be told anew what the surfaces are
    float h, lastSubstep;    ///< s, of a substep now, and in the last step

    bool sameSubstep() const { return lastSubstep == h; }
    /// N s, of substeps of the last step.
    ManifoldImpulses impulsesOf(const ManifoldRecord& manifold) const {
        return manifolds.impulsesOf(manifold, graph, lastSubstep);
    }
    /// Writes what the surfaces do to each other; a callback may change it in every step.
    void writeSurface(const ContactRecord& contact, const ManifoldRecord& manifold) const;
    /// Where surfaces may have changed, they are written anew for all manifolds that have a lane.
    void refreshSurfaces(ContactRecord& contact) const;
    /// Writes a manifold with its impulses into its lane.
    void writeLane(const ContactRecord& contact, const ManifoldRecord& manifold,
                   const ManifoldImpulses& impulses) const;
    /// Of what has neither a lane nor stored impulses, they are zero and stay so.
    void writeImpulses(const ContactRecord& contact, const ManifoldRecord& manifold,
                       const ManifoldImpulses& impulses) const;

    /// What a contact without manifolds has found; returns the first. On any worker.
    ManifoldRecord& takeFirstManifolds(ContactRecord& contact, std::span<const Manifold> found, int worker) const;
    /// Writes what the narrow phase has found into the records, and the lanes of those in the graph; returns what that
    /// changes, of ContactChange.
    std::uint8_t takeManifolds(ContactRecord& contact, std::span<const Manifold> found) const;
    /// The same of meshes that move.
    std::uint8_t takeSurfaceManifolds(ContactRecord& contact, std::span<const Manifold> found) const;

private:
    void placePoints(const ContactRecord& contact, const Manifold& found, ManifoldRecord& manifold) const;
};

}  // namespace ragtop
