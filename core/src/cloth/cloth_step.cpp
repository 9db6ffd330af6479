// The order of a step of cloth:
//
//   look       bodies and shapes that are near, pairs of points and shapes, what the air does
//   small step predict:  v ← v + h (g + F/m),  x ← x + h v
//              held points go with their bodies; points that surfaces stop are tied to them
//              tethers, shear, then bends and lengths, line by line:  (J W Jᵀ + α/h²) λ = −C,  Δx = W Jᵀ λ
//              contacts let go or rub, and hand to bodies what they bear
//              v ← (x − before)/h
//
// [Macklin et al. 2019]: one pass in each of many small steps.

#include <algorithm>
#include <cmath>

#include "cloth/cloth_sim.h"
#include "cloth/cloth_state.h"

namespace ragtop::cloth {
namespace {

constexpr float kStill = 0.02f;  ///< m/s of the fastest point of a cloth at rest

/// Where what holds points will be at the end of the small step.
void carryHeld(ClothSim& sim) {
    if (sim.state.held.empty()) return;
    for (NearBody& body : sim.around.bodies) {
        const float angle = length(body.angular);
        body.next = toMat3(angle > 0 ? rotationAbout(body.angular, angle) * body.pose.rotation : body.pose.rotation);
    }
    sim.arrays.yields = false;
    for (const HeldPoint& held : sim.state.held) {
        PointRow& point = sim.state.points[index(held.point)];
        point.inverseMass = 0;
        if (held.id.isNull()) {
            point.place = placeFrom(held.fixed, sim.state.origin);
            continue;
        }
        NearBody& body = sim.around.bodies[held.body];
        ++body.held;
        point.place = body.center + body.linear + body.next * (held.place - body.centerBody) + Vec3{0, 0, 0};
    }
    // Each of them has its share of the body, and no more than that gives way in any direction.
    for (const HeldPoint& held : sim.state.held) {
        if (held.id.isNull()) continue;
        const NearBody& body = sim.around.bodies[held.body];
        if (body.inverseMass == 0) continue;
        sim.arrays.yields = true;
        const Mat3& turning = body.inverseInertia;
        const float arm = lengthSquared(transformPoint(body.pose, held.place) - body.center);
        sim.state.points[index(held.point)].inverseMass =
            static_cast<float>(body.held) * (body.inverseMass + arm * (turning.cx.x + turning.cy.y + turning.cz.z));
    }
}

/// Between where the animation had a point and where it has it, at the end of this substep.
void limitToSkin(ClothSim& sim, float share) {
    if (!sim.state.follows) return;
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        const ClothSkin& skin = sim.def.skin[i];
        const DVec3 target = sim.state.skinFrom[i] + static_cast<double>(share) * (sim.state.skinTo[i] - sim.state.skinFrom[i]);
        Vec3& place = sim.state.points[i].place;
        const Vec3 to = placeFrom(target, sim.state.origin), normal = sim.state.skinNormals[i];
        const Vec3 away = place - to;
        const float behind = -dot(away, normal) - skin.backstop;
        if (behind > 0) place += behind * normal;
        const Vec3 rest = place - to;
        const float distance = length(rest);
        if (distance > skin.maxDistance) place = to + (skin.maxDistance / distance) * rest;
    }
}

/// Points that the animation leaves no room.
void pinToSkin(ClothSim& sim, float share) {
    if (!sim.state.follows) return;
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        if (sim.def.skin[i].maxDistance > 0) continue;
        const DVec3 target = sim.state.skinFrom[i] + static_cast<double>(share) * (sim.state.skinTo[i] - sim.state.skinFrom[i]);
        sim.state.points[i].inverseMass = 0;
        sim.state.points[i].place = placeFrom(target, sim.state.origin);
    }
}

/// One of the small steps that a substep of the world is divided into, `share` of the step over when it ends.
void smallStep(ClothSim& sim, const ClothContext& context, float share) {
    const ClothKernels& kernels = *sim.fabric.kernels;
    if (sim.around.preparedFor != context.h) kernels.prepare(sim.arrays, context);
    sim.around.preparedFor = context.h;
    kernels.predict(sim.arrays, context);
    carryHeld(sim);
    pinToSkin(sim, share);
    findContacts(sim);
    if (sim.arrays.tethers.anchors) kernels.tether(sim.arrays, context);
    for (const auto& [begin, end] : sim.fabric.stripLayers) kernels.shear(sim.arrays, begin, end, context);
    for (const auto& [begin, end] : sim.fabric.chainLayers) kernels.solve(sim.arrays, begin, end, context);
    endContacts(sim, context.inverseH);
    limitToSkin(sim, share);
    kernels.finish(sim.arrays, context);
}

/// How many small steps go by from one visit of bends to the next, which then act for all of them: as many as they
/// hardly turn in.
int bendSteps(const ClothSim& sim, int all, float h) {
    constexpr float kTurn = 0.2f;  // rad of the fastest bend
    if (!sim.arrays.links.bendStiffness) return 0;
    const float turn = std::sqrt(sim.fabric.links.bendRate) * h;
    int steps = all;
    while (steps > 1 && (all % steps != 0 || turn * static_cast<float>(steps) > kTurn)) --steps;
    return steps;
}

/// In a substep of the world: those of the definition for each 1/240 s, as lines that pull at each other across stay
/// apart by what gravity does in one of them. Their number never depends on the state: to go on from longer ones with
/// shorter ones would turn what lengths are off into speed.
int smallStepsOf(const ClothSim& sim, float substep) {
    constexpr float kLongest = 1.0f / 240;  // s
    constexpr float kRounding = 1e-3f;      // of a substep that is as long
    return sim.def.smallSteps * std::max(1, static_cast<int>(std::ceil(substep / kLongest - kRounding)));
}

void beforeSubstep(ClothSim& sim, float substep) {
    const WorldSettings& settings = sim.world->settings();
    const int steps = smallStepsOf(sim, substep);
    const float h = substep / static_cast<float>(steps);
    ClothContext context{h, 1 / h, sim.def.gravityScale * settings.gravity, sim.def.damping, 0};
    const int bends = bendSteps(sim, steps, h);
    readBodies(sim, h);
    for (int i = 0; i < steps; ++i) {
        if (i > 0) advanceBodies(sim, h);
        context.bendSteps = bends > 0 && i % bends == 0 ? bends : 0;
        const float over =
            static_cast<float>(sim.around.substep) + static_cast<float>(i + 1) / static_cast<float>(steps);
        smallStep(sim, context, over / static_cast<float>(settings.substeps));
    }
    ++sim.around.substep;
    pushBodies(sim);
}

std::span<const BodyId> look(ClothSim& sim, double dt) {
    if (!sim.state.awake && mustWake(sim)) {
        sim.state.awake = true;
        sim.state.quiet = 0;
    }
    if (!sim.state.awake) return {};
    lookAround(sim, static_cast<float>(dt));
    return sim.around.named;
}

/// What is no number any more is put to the origin, at rest.
void stopStrays(ClothSim& sim) {
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        PointRow& point = sim.state.points[i];
        VectorRow& velocity = sim.state.velocities[i];
        if (isFinite(point.place) && isFinite(velocity.v)) continue;
        point.place = velocity.v = {};
    }
}

void afterStep(ClothSim& sim, double dt) {
    if (!sim.state.awake) return;
    moveHeld(sim);
    if (!sim.def.skin.empty() && sim.state.follows) sim.state.skinFrom = sim.state.skinTo;
    const WorldSettings& settings = sim.world->settings();
    if (!findBlocks(sim)) {
        stopStrays(sim);
        findBlocks(sim);
    }
    if (!sim.def.allowSleep || !settings.sleeping) return;
    sim.state.quiet = sim.around.fastest < kStill ? sim.state.quiet + static_cast<float>(dt) : 0;
    if (sim.state.quiet < settings.sleepTime) return;
    sim.state.awake = false;
    for (VectorRow& velocity : sim.state.velocities) velocity = {};
    sim.around.fastest = 0;
}

}  // namespace

void moveHeld(ClothSim& sim) {
    for (const HeldPoint& held : sim.state.held) {
        const bool byBody = !held.id.isNull();
        if (byBody && !sim.world->isValid(held.id)) continue;
        const DVec3 place = byBody ? transformPoint(sim.world->pose(held.id), held.place) : held.fixed;
        sim.state.points[index(held.point)].place = placeFrom(place, sim.state.origin);
    }
}

StepModule moduleOf(ClothSim& sim) {
    StepModule module;
    module.user = &sim;
    module.name = "cloth";
    module.beforeStep = [](void* user, World& world, double) { static_cast<ClothSim*>(user)->world = &world; };
    module.look = [](void* user, const World&, double dt) { return look(*static_cast<ClothSim*>(user), dt); };
    module.beforeSubstep = [](void* user, World&, double h) {
        beforeSubstep(*static_cast<ClothSim*>(user), static_cast<float>(h));
    };
    module.afterStep = [](void* user, World&, double dt) { afterStep(*static_cast<ClothSim*>(user), dt); };
    module.saveSize = [](const void* user) { return saveSize(*static_cast<const ClothSim*>(user)); };
    module.save = [](const void* user, std::span<std::byte> into) { save(*static_cast<const ClothSim*>(user), into); };
    module.fits = [](const void* user, std::span<const std::byte> from) {
        return fits(*static_cast<const ClothSim*>(user), from);
    };
    module.restore = [](void* user, std::span<const std::byte> from) { restore(*static_cast<ClothSim*>(user), from); };
    module.hash = [](const void* user) { return hashOf(*static_cast<const ClothSim*>(user)); };
    return module;
}

}  // namespace ragtop::cloth
