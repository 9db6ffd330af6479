// The order of a step of cloth:
//
//   look       bodies and shapes that are near, pairs of points and shapes, what the air does
//   small step predict:  v ← v + h (g + F/m),  x ← x + h v
//              held points go with their bodies; points that surfaces stop are tied to them
//              tethers, bends, then lengths, line by line:  (J W Jᵀ + α/h²) λ = −C,  Δx = W Jᵀ λ
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
    for (const HeldPoint& held : sim.state.held) {
        PointRow& point = sim.state.points[index(held.point)];
        point.inverseMass = 0;
        if (held.id.isNull()) {
            point.place = relative(held.fixed, sim.state.origin);
            continue;
        }
        NearBody& body = sim.around.bodies[held.body];
        ++body.held;
        const Vec3 place = transformPoint(body.pose, held.place), arm = place - body.center;
        const float speed = length(body.angular);
        const Vec3 turned = speed > 0 ? rotate(rotationAbout(body.angular, speed), arm) : arm;
        point.place = body.center + body.linear + turned;
    }
    // Each of them has its share of the body, and no more than that gives way in any direction.
    for (const HeldPoint& held : sim.state.held) {
        if (held.id.isNull()) continue;
        const NearBody& body = sim.around.bodies[held.body];
        if (body.inverseMass == 0) continue;
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
        const Vec3 to = relative(target, sim.state.origin), normal = sim.state.skinNormals[i];
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
        sim.state.points[i].place = relative(target, sim.state.origin);
    }
}

/// One of the small steps that a substep of the world is divided into, `share` of the step over when it ends.
void smallStep(ClothSim& sim, const ClothContext& context, float share) {
    const ClothKernels& kernels = *sim.fabric.kernels;
    kernels.predict(sim.arrays, context);
    carryHeld(sim);
    pinToSkin(sim, share);
    findContacts(sim);
    if (sim.arrays.tetherCount > 0) kernels.tether(sim.arrays, context);
    for (const auto& [begin, end] : sim.fabric.layers) kernels.bend(sim.arrays, begin, end, context);
    for (const auto& [begin, end] : sim.fabric.layers) kernels.solve(sim.arrays, begin, end, context);
    endContacts(sim, context.inverseH);
    limitToSkin(sim, share);
    kernels.finish(sim.arrays, context);
}

void beforeSubstep(ClothSim& sim, float substep) {
    const WorldSettings& settings = sim.world->settings();
    const int steps = sim.def.smallSteps;
    const float h = substep / static_cast<float>(steps), all = static_cast<float>(settings.substeps * steps);
    const ClothContext context{h, 1 / h, sim.def.gravityScale * settings.gravity, sim.def.damping};
    readBodies(sim, h);
    for (int i = 0; i < steps; ++i) {
        if (i > 0) advanceBodies(sim, h);
        ++sim.around.smallStep;
        smallStep(sim, context, static_cast<float>(sim.around.smallStep) / all);
    }
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
        MotionRow& motion = sim.state.motions[i];
        if (isFinite(point.place) && isFinite(motion.velocity)) continue;
        point.place = motion.velocity = {};
    }
}

void afterStep(ClothSim& sim, double dt) {
    if (!sim.state.awake) return;
    stopStrays(sim);
    moveHeld(sim);
    if (!sim.def.skin.empty() && sim.state.follows) sim.state.skinFrom = sim.state.skinTo;
    const WorldSettings& settings = sim.world->settings();
    findBlocks(sim);
    if (!sim.def.allowSleep || !settings.sleeping) return;
    sim.state.quiet = sim.around.fastest < kStill ? sim.state.quiet + static_cast<float>(dt) : 0;
    if (sim.state.quiet < settings.sleepTime) return;
    sim.state.awake = false;
    for (MotionRow& motion : sim.state.motions) motion.velocity = {};
}

}  // namespace

void moveHeld(ClothSim& sim) {
    for (const HeldPoint& held : sim.state.held) {
        const bool byBody = !held.id.isNull();
        if (byBody && !sim.world->isValid(held.id)) continue;
        const DVec3 place = byBody ? transformPoint(sim.world->pose(held.id), held.place) : held.fixed;
        sim.state.points[index(held.point)].place = relative(place, sim.state.origin);
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
