// What systems are handed.

#include "world/world_impl.h"

namespace ragtop {

GhostView WorldImpl::ghostView(std::span<const StartPose> starts) const {
    return {tables, starts, clock.dt, solving.context.h};
}

ShapeBounds WorldImpl::shapeBounds() { return {tables.bodies, tables.shapes, collision.broadphase, clock.dt}; }

ContactWriter WorldImpl::contactWriter() {
    return {tables.bodies,
            tables.shapes,
            tables.contacts,
            tables.manifolds,
            tables.graph,
            callbacks,
            collision.finds.surfacesForgotten,
            solving.context.h,
            clock.lastSubstep};
}

NarrowPhase WorldImpl::narrowPhase() {
    return {tables.bodies,   tables.shapes,   tables.contacts, tables.manifolds, collision.broadphase,
            collision.finds, contactWriter(), ghostView(),     clock.dt};
}

Activity WorldImpl::activity() {
    return {tables.bodies,
            tables.shapes,
            tables.contacts,
            tables.manifolds,
            tables.joints,
            tables.couplings,
            tables.graph,
            collision.broadphase,
            partition.islands,
            partition.articulations,
            partition.direct,
            collision.finds,
            events,
            contactWriter()};
}

Scene WorldImpl::scene() {
    return {tables.bodies,           tables.shapes,    tables.contacts,      tables.manifolds,
            tables.joints,           tables.couplings, collision.broadphase, partition.islands,
            partition.articulations, partition.direct, collision.finds,      events,
            tables.versions,         settings.gravity, shapeBounds(),        activity()};
}

DirectView WorldImpl::directView() {
    return {tables.bodies,     tables.joints,    tables.contacts, tables.manifolds, tables.graph,
            partition.islands, partition.direct, moduleWork,      solving.context,  solving.jointContext,
            *machine.kernels,  machine.runner,   machine.memory,  settings.substeps};
}

Iteration WorldImpl::iteration() {
    return {tables,
            tables.bodies,
            tables.manifolds,
            tables.joints,
            tables.couplings,
            tables.graph,
            solving.regions,
            partition.articulations,
            partition.direct,
            *machine.kernels,
            *machine.jointKernels,
            solving.context,
            solving.jointContext,
            machine.runner};
}

ContactEvents WorldImpl::contactEvents() {
    return {tables.bodies,
            tables.shapes,
            tables.contacts,
            tables.manifolds,
            tables.graph,
            collision.swept,
            *machine.kernels,
            collision.finds,
            events,
            length(settings.gravity),
            solving.context.restitutionSpeed};
}

BodyStage WorldImpl::bodyStage() {
    return {tables.bodies, tables.shapes, collision.broadphase, collision.swept, solving.freezing, solving.context,
            settings,      clock.dt};
}

GuardView WorldImpl::guardView() {
    return {tables.bodies,     tables.shapes,
            tables.contacts,   tables.manifolds,
            tables.joints,     tables.graph,
            partition.islands, partition.articulations,
            partition.direct,  guards.energy,
            solving.context,   settings.gravity,
            clock.dt,          static_cast<std::uint32_t>(clock.stepCount),
            scene(),           machine.runner};
}

ClosingView WorldImpl::closingView() {
    return {tables.bodies,        tables.shapes, tables.contacts, tables.manifolds, tables.joints,
            tables.graph,         guards.energy, collision.swept, guards.closing,   solving.context,
            solving.jointContext, clock.dt,      machine.runner,  machine.memory};
}

MultirateView WorldImpl::multirateView() {
    return {tables.bodies,    tables.joints, tables.contacts, tables.manifolds, collision.finds,      partition.direct,
            solving.freezing, moduleWork,    solving.context, settings,         tables.graph.lanes(), machine.runner};
}

RegionView WorldImpl::regionView() {
    return {tables,
            tables.bodies,
            tables.contacts,
            tables.manifolds,
            tables.joints,
            tables.couplings,
            tables.graph,
            partition.islands,
            partition.articulations,
            partition.direct,
            moduleWork,
            solving.freezing,
            collision.finds,
            solving.regions,
            settings,
            solving.bouncy,
            machine.runner.workers()};
}

}  // namespace ragtop
