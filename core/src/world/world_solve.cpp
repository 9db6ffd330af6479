// The substeps of a step.

#include "model/spring_leads.h"
#include "world/multirate.h"
#include "world/world_modules.h"

namespace ragtop {

static SolverContext contextOf(const WorldImpl& world, int number, bool moved) {
    SolverContext own = world.context;
    own.elapsed = world.context.h * static_cast<float>(moved ? number + 1 : number);
    own.substep = number;
    own.firstSubstep = number == 0;
    own.lastSubstep = number + 1 == world.settings.substeps;
    return own;
}

static void moveArticulations(WorldImpl& world) {
    world.runner.parallelFor(static_cast<int>(world.articulations.count()), 16, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i)
            world.articulations.move(static_cast<std::uint32_t>(i), world.context.h, world.bodies);
    });
}

/// All substeps of what shares no body with anything else.
static void solveRegion(WorldImpl& world, World& face, int region) {
    const BodyArrays arrays = world.bodies.arrays();
    const std::span<const std::uint32_t> list = world.regions.bodies.of(region);
    const auto count = static_cast<int>(list.size());
    const Iteration iteration = world.iteration();
    for (int i = 0; i < world.settings.substeps; ++i) {
        const SolverContext before = contextOf(world, i, false), after = contextOf(world, i, true);
        for (const std::uint32_t group : world.regions.modules.of(region)) actAsGroup(world, face, group);
        world.kernels->integrateVelocities(arrays, list.data(), 0, count, before);
        iteration.passOverRegion(region, SolvePass::warmStart, before);
        iteration.passOverRegion(region, SolvePass::solve, before);
        for (const std::uint32_t articulation : world.regions.articulations.of(region))
            world.articulations.move(articulation, world.context.h, world.bodies);
        world.kernels->integratePositions(arrays, list.data(), 0, count, before);
        iteration.passOverRegion(region, SolvePass::relax, after);
    }
}

/// Region 0 are bodies of none, that touch nothing and nothing moves.
static void solveRegions(WorldImpl& world, World& face) {
    world.runner.parallelFor(world.graph.regionCount() + 1, 1, [&](int begin, int end, int) {
        for (int r = begin; r < end; ++r) solveRegion(world, face, r);
    });
    world.context = contextOf(world, world.settings.substeps - 1, true);
}

/// Velocities or positions, by their kernel.
static void integrate(WorldImpl& world, decltype(KernelTable::integrateVelocities) kernel) {
    const BodyArrays arrays = world.bodies.arrays();
    forBodiesInTurn(world, [&](const std::uint32_t* list, int begin, int end, const SolverContext& own) {
        kernel(arrays, list, begin, end, own);
    });
}

/// Passes of all bodies, one after the other.
static void solveTogether(WorldImpl& world, World& face) {
    const Iteration iteration = world.iteration();
    const bool sequential = world.settings.sequentialFriction;
    for (int number = 0; number < world.settings.substeps; ++number) {
        world.context = contextOf(world, number, false);
        actBetweenSubsteps(world, face);
        readMechanisms(world.directView());
        integrate(world, world.kernels->integrateVelocities);
        if (world.bouncy) iteration.bounce();
        solveDirect(world.directView(), DirectPass::positions);
        iteration.warmStart();
        if (number == 0) iteration.settleNewContacts(world.contactFinds.fresh, world.settings.gravity, sequential);
        iteration.solve(true, sequential);
        moveArticulations(world);
        integrate(world, world.kernels->integratePositions);
        world.context = contextOf(world, number, true);
        solveDirect(world.directView(), DirectPass::velocities);
        iteration.solve(false, sequential);
    }
}

void WorldImpl::solveSubsteps(World& world) {
    leadSprings(joints, bodies, context.h, Lead::begin, runner);
    moduleWork.inSubsteps = moduleWork.acts();
    if (regions.independent)
        solveRegions(*this, world);
    else
        solveTogether(*this, world);
    moduleWork.inSubsteps = false;
}

}  // namespace ragtop
