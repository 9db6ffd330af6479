#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ragdoll_levels.h"
#include "ragdoll_watch.h"
#include "ragtop/ragdoll_lod.h"

namespace ragtop::demos {
namespace {

constexpr float kLevelSpin = 5;  ///< rad/s, of each part, at most
constexpr int kBetween = 12;     ///< steps between changes
constexpr double kMomentumChange = 1e-5, kEnergyGain = 1e-6, kBoneJump = 1e-3;
constexpr RagdollLevel kLevels[] = {RagdollLevel::reduced, RagdollLevel::single,  RagdollLevel::asleep,
                                    RagdollLevel::single,  RagdollLevel::reduced, RagdollLevel::full,
                                    RagdollLevel::asleep,  RagdollLevel::full,    RagdollLevel::single,
                                    RagdollLevel::reduced, RagdollLevel::asleep,  RagdollLevel::full};

double sizeOf(const DVec3& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }
DVec3 momentOf(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Of some bodies together.
struct GroupMotion {
    DVec3 momentum, spin;            ///< kg m/s, and kg m²/s about their centre of mass
    double moving = 0, turning = 0;  ///< sums of the sizes of what each body has of them
    double kinetic = 0;              ///< J

    GroupMotion(const World& world, std::span<const BodyId> bodies) {
        DVec3 center;
        double mass = 0;
        for (const BodyId body : bodies) {
            const double own = static_cast<double>(world.mass(body).mass);
            mass += own;
            center = center + own * world.centerOfMass(body);
        }
        center = (1 / mass) * center;
        for (const BodyId body : bodies) {
            const MassProperties own = world.mass(body);
            const Quat turn = world.pose(body).rotation;
            const Vec3 v = world.linearVelocity(body), w = world.angularVelocity(body);
            const Vec3 about = rotate(turn, own.inertia * inverseRotate(turn, w));
            const DVec3 along = static_cast<double>(own.mass) * DVec3(v);
            const DVec3 around = momentOf(world.centerOfMass(body) - center, along);
            momentum = momentum + along;
            moving += sizeOf(along);
            turning += sizeOf(DVec3(about)) + sizeOf(around);
            spin = spin + DVec3(about) + around;
            kinetic += 0.5 * static_cast<double>(own.mass * dot(v, v) + dot(w, about));
        }
    }
};

}  // namespace

std::vector<RagdollFigure> levels(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    if (!std::holds_alternative<RagdollDef>(subject.def)) return {};
    Worst momentum, energy, jump;
    for (int seed = 1; seed <= options.seeds; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        RagdollStage stage(subject, {{}, anyRotation(random)});
        for (const BodyId body : stage.bodies) {
            const float x = anyNumber(random), y = anyNumber(random), z = anyNumber(random);
            stage.world.setVelocity(body, {1, 5, 0}, kLevelSpin * Vec3{x, y, z});
        }
        RagdollLod lod(stage.world, *stage.ragdoll);
        std::vector<Pose> drawn(stage.ragdoll->def().bones.size()), after(drawn.size());
        for (const RagdollLevel level : kLevels) {
            for (int i = 0; i < kBetween; ++i) stage.world.step(1 / options.hz);
            const bool slept = !stage.world.isEnabled(lod.bodies().front());
            const GroupMotion before(stage.world, lod.bodies());
            lod.pose(drawn);
            lod.setLevel(level);
            lod.pose(after);
            const std::string run = fmt::format("seed {}, to {}", seed, nameOf(level));
            for (std::size_t i = 0; i < drawn.size(); ++i) jump.add(sizeOf(after[i].position - drawn[i].position), run);
            if (slept || level == RagdollLevel::asleep) continue;  // what is out of the world tells no velocity
            const GroupMotion now(stage.world, lod.bodies());
            momentum.add(sizeOf(now.momentum - before.momentum) / std::max(before.moving, now.moving), run);
            momentum.add(sizeOf(now.spin - before.spin) / std::max(before.turning, now.turning), run);
            energy.add(now.kinetic / before.kinetic - 1, run);
        }
    }
    return {{"lod", "momentum_change_max_ratio", momentum.value(), kMomentumChange, false, momentum.where()},
            {"lod", "energy_gain_max_ratio", std::max(energy.value(), 0.0), kEnergyGain, false, energy.where()},
            {"lod", "bone_jump_max_m", jump.value(), kBoneJump, false, jump.where()}};
}

}  // namespace ragtop::demos
