// The substeps of a step.

#include "model/spring_leads.h"
#include "world/multirate.h"
#include "world/world_impl.h"
#include "world/world_modules.h"

namespace ragtop {

/// A substep before its bodies have moved, or after.
static void setSubstep(SolverContext& context, int number, bool moved, int substeps) {
    context.elapsed = context.h * static_cast<float>(moved ? number + 1 : number);
    context.substep = number;
    context.firstSubstep = number == 0;
    context.lastSubstep = number + 1 == substeps;
}

static void moveArticulations(WorldImpl& world) {
    world.machine.runner.parallelFor(
        static_cast<int>(world.partition.articulations.count()), 16, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) {
                const auto articulation = static_cast<std::uint32_t>(i);
                const std::uint32_t first = world.partition.articulations.firstBody(articulation);
                const int factor = world.tables.bodies[first].direct.pace.stepFactor;
                if (world.solving.context.substep % factor == 0)
                    world.partition.articulations.move(
                        articulation, static_cast<float>(factor) * world.solving.context.h, world.tables.bodies);
            }
        });
}

/// All substeps of what shares no body with anything else.
static void solveRegion(WorldImpl& world, World& face, int region) {
    const BodyArrays arrays = world.tables.bodies.arrays();
    const std::span<const std::uint32_t> list = world.solving.regions.bodies.of(region);
    const auto count = static_cast<int>(list.size());
    const Iteration iteration = world.iteration();
    SolverContext before = world.solving.context, after = before;
    for (int i = 0; i < world.settings.substeps; ++i) {
        setSubstep(before, i, false, world.settings.substeps);
        setSubstep(after, i, true, world.settings.substeps);
        for (const std::uint32_t group : world.solving.regions.modules.of(region))
            actAsGroup(world.moduleWork, world.tables.bodies, face, group, world.solving.context.h);
        world.machine.kernels->integrateVelocities(arrays, list.data(), 0, count, before);
        for (const std::uint32_t group : world.solving.regions.modules.of(region))
            bearPushesOf(world.moduleWork, iteration, before, group);
        iteration.passOverRegion(region, SolvePass::warmStart, before);
        iteration.shrinkStruckLoads(region, before);
        iteration.passOverRegion(region, SolvePass::solve, before);
        for (const std::uint32_t articulation : world.solving.regions.articulations.of(region))
            world.partition.articulations.move(articulation, world.solving.context.h, world.tables.bodies);
        world.machine.kernels->integratePositions(arrays, list.data(), 0, count, before);
        iteration.passOverRegion(region, SolvePass::relax, after);
    }
}

/// Region 0 are bodies of none, that touch nothing and nothing moves.
static void solveRegions(WorldImpl& world, World& face) {
    world.machine.runner.parallelFor(world.tables.graph.regionCount() + 1, 1, [&](int begin, int end, int) {
        for (int r = begin; r < end; ++r) solveRegion(world, face, r);
    });
    setSubstep(world.solving.context, world.settings.substeps - 1, true, world.settings.substeps);
}

/// Velocities or positions, by their kernel, of those that begin a substep of their own now.
static void integrate(WorldImpl& world, decltype(KernelTable::integrateVelocities) kernel) {
    const BodyArrays arrays = world.tables.bodies.arrays();
    const SolverContext& context = world.solving.context;
    forSharedBodies(world.partition.direct.multirate, world.solving.freezing.solved,
                    [&](int k, std::span<const std::uint32_t> list) {
                        if (context.substep % (1 << k) != 0) return;
                        SolverContext several;
                        if (k > 0) several = context, several.h *= static_cast<float>(1 << k);
                        const SolverContext& own = k > 0 ? several : context;
                        world.machine.runner.parallelFor(
                            static_cast<int>(list.size()), 64,
                            [&](int begin, int end, int) { kernel(arrays, list.data(), begin, end, own); });
                    });
}

/// Passes of all bodies, one after the other.
static void solveTogether(WorldImpl& world, World& face, const DirectView& direct, const Iteration& iteration) {
    const bool sequential = world.settings.sequentialFriction;
    for (int number = 0; number < world.settings.substeps; ++number) {
        setSubstep(world.solving.context, number, false, world.settings.substeps);
        actBetweenSubsteps(world.moduleWork, world.tables.bodies, world.machine.runner, face, world.solving.context.h);
        readMechanisms(direct);
        integrate(world, world.machine.kernels->integrateVelocities);
        bearPushes(world.moduleWork, iteration, world.solving.context);
        if (world.solving.bouncy) iteration.bounce();
        solveDirect(direct, DirectPass::positions);
        iteration.warmStart();
        iteration.shrinkStruckLoads();
        if (number == 0) iteration.settleNewContacts(world.collision.finds.fresh, world.settings.gravity, sequential);
        iteration.solve(true, sequential);
        moveArticulations(world);
        integrate(world, world.machine.kernels->integratePositions);
        setSubstep(world.solving.context, number, true, world.settings.substeps);
        solveDirect(direct, DirectPass::velocities);
        iteration.solve(false, sequential);
    }
}

void WorldImpl::solveSubsteps(World& world, const DirectView& direct, const Iteration& iterate) {
    leadSprings(tables.joints, tables.bodies, solving.context.h, Lead::begin, machine.runner);
    moduleWork.inSubsteps = moduleWork.acts();
    if (solving.regions.independent)
        solveRegions(*this, world);
    else
        solveTogether(*this, world, direct, iterate);
    moduleWork.inSubsteps = false;
}

}  // namespace ragtop
