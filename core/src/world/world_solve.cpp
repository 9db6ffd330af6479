// The substeps of a step.

#include "model/spring_leads.h"
#include "world/multirate.h"
#include "world/world_impl.h"
#include "world/world_modules.h"

namespace ragtop {

SolverContext Solving::ofSubstep(int number, bool moved, int substeps) const {
    SolverContext own = context;
    own.elapsed = context.h * static_cast<float>(moved ? number + 1 : number);
    own.substep = number;
    own.firstSubstep = number == 0;
    own.lastSubstep = number + 1 == substeps;
    return own;
}

static void moveArticulations(WorldImpl& world) {
    world.machine.runner.parallelFor(
        static_cast<int>(world.partition.articulations.count()), 16, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i)
                world.partition.articulations.move(static_cast<std::uint32_t>(i), world.solving.context.h,
                                                   world.tables.bodies);
        });
}

/// All substeps of what shares no body with anything else.
static void solveRegion(WorldImpl& world, World& face, int region) {
    const BodyArrays arrays = world.tables.bodies.arrays();
    const std::span<const std::uint32_t> list = world.solving.regions.bodies.of(region);
    const auto count = static_cast<int>(list.size());
    const Iteration iteration = world.iteration();
    for (int i = 0; i < world.settings.substeps; ++i) {
        const SolverContext before = world.solving.ofSubstep(i, false, world.settings.substeps),
                            after = world.solving.ofSubstep(i, true, world.settings.substeps);
        for (const std::uint32_t group : world.solving.regions.modules.of(region))
            actAsGroup(world.moduleWork, world.tables.bodies, face, group, world.solving.context.h);
        world.machine.kernels->integrateVelocities(arrays, list.data(), 0, count, before);
        for (const std::uint32_t group : world.solving.regions.modules.of(region))
            bearPushesOf(world.moduleWork, iteration, before, group);
        iteration.passOverRegion(region, SolvePass::warmStart, before);
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
    world.solving.context = world.solving.ofSubstep(world.settings.substeps - 1, true, world.settings.substeps);
}

/// Velocities or positions, by their kernel, of those that begin a substep of their own now.
static void integrate(WorldImpl& world, decltype(KernelTable::integrateVelocities) kernel) {
    const BodyArrays arrays = world.tables.bodies.arrays();
    const SolverContext& context = world.solving.context;
    forSharedBodies(world.partition.direct.multirate, world.solving.freezing.solved,
                    [&](int k, std::span<const std::uint32_t> list) {
                        if (context.substep % (1 << k) != 0) return;
                        SolverContext own = context;
                        own.h *= static_cast<float>(1 << k);
                        world.machine.runner.parallelFor(
                            static_cast<int>(list.size()), 64,
                            [&](int begin, int end, int) { kernel(arrays, list.data(), begin, end, own); });
                    });
}

/// Passes of all bodies, one after the other.
static void solveTogether(WorldImpl& world, World& face) {
    const Iteration iteration = world.iteration();
    const bool sequential = world.settings.sequentialFriction;
    for (int number = 0; number < world.settings.substeps; ++number) {
        world.solving.context = world.solving.ofSubstep(number, false, world.settings.substeps);
        actBetweenSubsteps(world.moduleWork, world.tables.bodies, world.machine.runner, face, world.solving.context.h);
        readMechanisms(world.directView());
        integrate(world, world.machine.kernels->integrateVelocities);
        bearPushes(world.moduleWork, iteration, world.solving.context);
        if (world.solving.bouncy) iteration.bounce();
        solveDirect(world.directView(), DirectPass::positions);
        iteration.warmStart();
        if (number == 0) iteration.settleNewContacts(world.collision.finds.fresh, world.settings.gravity, sequential);
        iteration.solve(true, sequential);
        moveArticulations(world);
        integrate(world, world.machine.kernels->integratePositions);
        world.solving.context = world.solving.ofSubstep(number, true, world.settings.substeps);
        solveDirect(world.directView(), DirectPass::velocities);
        iteration.solve(false, sequential);
    }
}

void WorldImpl::solveSubsteps(World& world) {
    leadSprings(tables.joints, tables.bodies, solving.context.h, Lead::begin, machine.runner);
    moduleWork.inSubsteps = moduleWork.acts();
    if (solving.regions.independent)
        solveRegions(*this, world);
    else
        solveTogether(*this, world);
    moduleWork.inSubsteps = false;
}

}  // namespace ragtop
