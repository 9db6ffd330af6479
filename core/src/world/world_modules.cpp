// Modules: what they look at before a step, and what they do between its substeps, on workers where they say to whom
// (docs/adr/0048).

#include <atomic>
#include <chrono>

#include "base/union_find.h"
#include "world/world_modules.h"

namespace ragtop {

namespace {

constexpr int kModulesAtOnce = 4;  ///< modules that look one after the other: those that sleep are done at once

void forget(ModuleWork& work) {
    for (const std::uint32_t body : work.named) work.namer[body] = 0;
    for (auto* list : {&work.named, &work.acting, &work.parent, &work.groupOf, &work.starts, &work.members})
        list->clear();
    work.onAll = false;
    work.ms = 0;
}

/// All that do something between substeps, on workers.
void look(ModuleWork& work, StageRunner& runner, const World& face, double dt) {
    work.spans.resizeForOverwrite(work.modules.size());
    std::atomic<bool> onAll{false};
    runner.parallelFor(static_cast<int>(work.modules.size()), kModulesAtOnce, [&](int begin, int end, int) {
        for (auto m = static_cast<std::size_t>(begin); m < static_cast<std::size_t>(end); ++m) {
            const StepModule& module = *work.modules[m];
            work.spans[m] = module.look ? module.look(module.user, face, dt) : std::span<const BodyId>{};
            if (!module.beforeSubstep) work.spans[m] = {};
            if (module.beforeSubstep && !module.look) onAll.store(true, std::memory_order_relaxed);
        }
    });
    work.onAll = onAll.load(std::memory_order_relaxed);
}

/// Wakes what a module named and notes it; what does not move is shared by any number of modules.
void takeNames(ModuleWork& work, const Activity& activity, std::uint32_t place) {
    const Bodies& bodies = activity.bodies;
    for (const BodyId id : work.spans[work.acting[place]]) {
        if (!bodies.slots.isValid(id.index, id.generation) || id.index == 0) continue;
        if (bodies[id.index].type == BodyType::fixed) continue;
        if (bodies.moves(id.index) && !bodies.isAwake(id.index)) activity.wakeBody(id.index);
        std::uint32_t& namer = work.namer[id.index];
        if (namer == 0) {
            namer = 1 + place;
            work.named.push(id.index);
        } else if (bodies.moves(id.index)) {
            unite(work.parent, namer - 1, place);
        }
    }
}

/// Groups are in the order of the first module of each.
void listGroups(ModuleWork& work) {
    const auto count = static_cast<std::uint32_t>(work.acting.size());
    std::uint32_t groups = 0;
    for (std::uint32_t place = 0; place < count; ++place) {
        const std::uint32_t root = rootOf(work.parent, place);
        work.groupOf.push(root == place ? groups++ : work.groupOf[root]);
    }
    if (groups == 0) return;
    work.starts.resize(groups + 2, 0);
    for (const std::uint32_t group : work.groupOf) ++work.starts[group + 2];
    for (std::uint32_t g = 2; g < groups + 2; ++g) work.starts[g] += work.starts[g - 1];
    work.members.resizeForOverwrite(count);
    for (std::uint32_t place = 0; place < count; ++place) work.members[work.starts[work.groupOf[place] + 1]++] = place;
    work.starts.pop();
}

/// Each by the first that named it.
template <class Visit>
void forMovingBodiesOf(const ModuleWork& work, const Bodies& bodies, std::size_t group, Visit&& visit) {
    for (std::uint32_t i = work.starts[group]; i < work.starts[group + 1]; ++i) {
        const std::uint32_t place = work.members[i];
        for (const BodyId id : work.spans[work.acting[place]])
            if (bodies.slots.isValid(id.index, id.generation) && bodies.moves(id.index) &&
                work.namer[id.index] == 1 + place)
                visit(id.index);
    }
}

/// Of modules that may act on any body.
template <class Visit>
void forAllMoving(const Bodies& bodies, Visit&& visit) {
    for (const std::uint32_t body : bodies.awake)
        if (bodies.moves(body)) visit(body);
}

}  // namespace

void askModules(ModuleWork& work, const Activity& activity, StageRunner& runner, const World& face, double dt) {
    forget(work);
    if (work.modules.empty()) return;
    look(work, runner, face, dt);
    work.namer.resize(activity.bodies.size(), 0);
    work.velocityBefore.resizeForOverwrite(activity.bodies.size());
    for (std::uint32_t m = 0; m < work.spans.size(); ++m) {
        if (work.spans[m].empty()) continue;
        const auto place = static_cast<std::uint32_t>(work.acting.size());
        work.acting.push(m);
        work.parent.push(place);
        takeNames(work, activity, place);
    }
    listGroups(work);
}

/// Before modules push it.
static void noteVelocity(ModuleWork& work, const Bodies& bodies, std::uint32_t body) {
    work.velocityBefore[body] = bodies.states[bodies[body].state].v;
}

void actAsGroup(ModuleWork& work, const Bodies& bodies, World& face, std::size_t group, float h) {
    forMovingBodiesOf(work, bodies, group, [&](std::uint32_t body) { noteVelocity(work, bodies, body); });
    for (std::uint32_t i = work.starts[group]; i < work.starts[group + 1]; ++i) {
        const StepModule& module = *work.modules[work.acting[work.members[i]]];
        module.beforeSubstep(module.user, face, h);
    }
}

/// Those that may act on any body, and all that named some.
static void actInOrder(ModuleWork& work, const Bodies& bodies, World& face, float h) {
    forAllMoving(bodies, [&](std::uint32_t body) { noteVelocity(work, bodies, body); });
    for (std::size_t m = 0; m < work.modules.size(); ++m) {
        const StepModule& module = *work.modules[m];
        if (module.beforeSubstep && (!module.look || !work.spans[m].empty()))
            module.beforeSubstep(module.user, face, h);
    }
}

void actBetweenSubsteps(ModuleWork& work, const Bodies& bodies, StageRunner& runner, World& face, float h) {
    if (!work.acts()) return;
    const auto begin = std::chrono::steady_clock::now();
    if (work.onAll)
        actInOrder(work, bodies, face, h);
    else
        runner.parallelFor(static_cast<int>(work.groupCount()), 1, [&](int first, int end, int) {
            for (int g = first; g < end; ++g) actAsGroup(work, bodies, face, static_cast<std::size_t>(g), h);
        });
    work.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

static void countPush(const ModuleWork& work, Bodies& bodies, std::uint32_t body) {
    BodyHistory& history = bodies.histories[bodies[body].state];
    history.lastChange -= history.velocityBefore - work.velocityBefore[body];
    history.velocityBefore = work.velocityBefore[body];
}

void bearPushesOf(const ModuleWork& work, const Iteration& iteration, const SolverContext& own, std::size_t group) {
    forMovingBodiesOf(work, iteration.bodies, group, [&](std::uint32_t body) {
        if (!work.onAll) countPush(work, iteration.bodies, body);
        iteration.bearPush(body, own);
    });
}

/// One after the other: contacts of two such bodies are of both.
void bearPushes(const ModuleWork& work, const Iteration& iteration, const SolverContext& own) {
    if (work.onAll)
        forAllMoving(iteration.bodies, [&](std::uint32_t body) { countPush(work, iteration.bodies, body); });
    for (std::size_t group = 0; group < work.groupCount(); ++group) bearPushesOf(work, iteration, own, group);
}

bool mayPush(ModuleWork& work, std::uint32_t body) {
    if (!work.inSubsteps || work.actsOn(body)) return true;
    std::atomic_ref(work.strays).fetch_add(1, std::memory_order_relaxed);
    return false;
}

std::uint32_t regionOfGroup(const ModuleWork& work, const Bodies& bodies, const ConstraintGraph& graph,
                            std::size_t group) {
    std::uint32_t region = 0;
    bool one = true;
    forMovingBodiesOf(work, bodies, group, [&](std::uint32_t body) {
        const std::uint32_t own = graph.regionOf(bodies[body].state);
        one &= own != 0 && (region == 0 || region == own);
        region = own;
    });
    return one ? region : kNone;
}

void uniteNamed(const ModuleWork& work, const Bodies& bodies, Islands& islands) {
    for (std::size_t group = 0; group < work.groupCount(); ++group) {
        std::uint32_t first = kNone;
        forMovingBodiesOf(work, bodies, group, [&](std::uint32_t body) {
            if (first == kNone) first = body;
            islands.unite(bodies, first, body);
        });
    }
}

}  // namespace ragtop
