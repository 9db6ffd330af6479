#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "scenes.h"
#include "world_support.h"

/// Chains with a load at their end.
namespace ragtop::test {

/// Links of 1 kg and 0.5 m let go horizontally, a ball of `ratio` kg at their end, all on one kind of joint.
struct Chain {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;

    Chain(World& world, int links, float ratio, double z = 0, bool hinges = false,
          float breakForce = std::numeric_limits<float>::infinity()) {
        constexpr float kLength = 0.5f;
        const Quat along = rotationBetween({0, 1, 0}, {1, 0, 0});
        for (int i = 0; i <= links; ++i) {
            const bool last = i == links;
            BodyDef def = last ? bodyDef(Sphere{0.25f}, {i * 0.5 + 0.25, 0, z})
                               : bodyDef(Capsule{0.05f, 0.2f}, {i * 0.5 + 0.25, 0, z});
            if (!last) def.pose.rotation = along;
            for (ShapeDef& shape : def.shapes) shape.filter.mask = 0;
            const BodyId body = world.create(def);
            MassProperties mass = world.mass(body);
            const float scale = (last ? ratio : 1) / mass.mass;
            mass.mass *= scale;
            for (Vec3* column : {&mass.inertia.cx, &mass.inertia.cy, &mass.inertia.cz}) *column *= scale;
            world.setMass(body, mass);
            // Frames whose x axes lie along z.
            const Quat aboutZ = rotationBetween({1, 0, 0}, {0, 0, 1});
            JointBodies joined{.b = body};
            joined.breakForce = breakForce;
            if (bodies.empty()) {
                joined.frameA = {{0, 0, static_cast<float>(z)}, aboutZ};
            } else {
                joined.a = bodies.back();
                joined.frameA = {{0, 0.5f * kLength, 0}, conjugate(along) * aboutZ};
            }
            const Vec3 arm = last ? Vec3{-0.25f, 0, 0} : Vec3{0, -0.5f * kLength, 0};
            joined.frameB = {arm, last ? aboutZ : conjugate(along) * aboutZ};
            joints.push_back(hinges ? world.create(HingeDef{.bodies = joined})
                                    : world.create(BallDef{.bodies = joined}));
            bodies.push_back(body);
        }
    }
    float largestGap(const World& world) const {
        float gap = 0;
        for (const JointId joint : joints)
            if (world.isValid(joint)) gap = std::max(gap, world.state(joint).gap);
        return gap;
    }
};

/// Who looks at bodies between two substeps, and does nothing to them.
struct Watcher {
    StepModule module;
    Watcher() { module.beforeSubstep = [](void*, World&, double) {}; }
};

inline double energyOf(const World& world, const Chain& chain) {
    double energy = 0;
    for (const BodyId body : chain.bodies) energy += energyOf(world, body);
    return energy;
}

}  // namespace ragtop::test
