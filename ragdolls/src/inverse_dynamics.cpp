#include "ragtop/inverse_dynamics.h"

#include <algorithm>

#include "inertia.h"
#include "joint_bodies.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Upper bound of the inertia about a point, of what has `inertia` about a centre that is `arm` away.
float inertiaAbout(const Mat3& inertia, float mass, const Vec3& arm) {
    return std::max({inertia.cx.x, inertia.cy.y, inertia.cz.z}) + mass * lengthSquared(arm);
}

Mat3 turned(const Mat3& inertia, const Quat& rotation) {
    const Mat3 r = toMat3(rotation);
    return r * (inertia * transpose(r));
}

}  // namespace

InverseDynamics::InverseDynamics(const World& world, const Ragdoll& ragdoll) : world_(&world), ragdoll_(&ragdoll) {
    const RagdollDef& def = ragdoll.def();
    parts_.resize(def.parts.size());
    load_.resize(def.parts.size());
    beyond_.resize(def.joints.size());
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        Part& part = parts_[static_cast<std::size_t>(def.joints[i].child)];
        part.parent = def.joints[i].parent;
        part.joint = static_cast<int>(i);
    }
    look();
}

/// Adds what hangs on a part by joints of its own.
void InverseDynamics::carry(std::size_t index) {
    Part& part = parts_[index];
    const BodyId body = ragdoll_->bodies()[index];
    const std::span<const BodyId> own = ragdoll_->bodies();
    for (const JointId joint : world_->jointsOf(body)) {
        const JointBodies& joined = bodiesOf(world_->def(joint));
        const BodyId other = joined.a == body ? joined.b : joined.a;
        if (other.isNull() || world_->type(other) != BodyType::dynamic) continue;
        if (std::find(own.begin(), own.end(), other) != own.end()) continue;
        const MassProperties load = world_->mass(other);
        const DVec3 center = world_->centerOfMass(other);
        const float sum = part.mass + load.mass, share = load.mass / sum;
        const Vec3 apart = relative(center, part.center);
        part.inertia =
            part.inertia + turned(load.inertia, world_->pose(other).rotation) + steiner(part.mass * share, apart);
        part.center = part.center + share * apart;
        part.velocity += share * (world_->linearVelocity(other) - part.velocity);
        part.mass = sum;
    }
}

void InverseDynamics::look() {
    const RagdollDef& def = ragdoll_->def();
    mass_ = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        Part& part = parts_[i];
        const BodyId body = ragdoll_->bodies()[i];
        part.exists = world_->isValid(body) &&
                      (part.parent < 0 || (world_->isValid(ragdoll_->joints()[static_cast<std::size_t>(part.joint)]) &&
                                           parts_[static_cast<std::size_t>(part.parent)].exists));
        if (!part.exists) continue;
        const MassProperties mass = world_->mass(body);
        const Pose pose = world_->pose(body);
        part.mass = mass.mass;
        part.inertia = turned(mass.inertia, pose.rotation);
        part.center = world_->centerOfMass(body);
        part.rotation = pose.rotation;
        part.velocity = world_->linearVelocity(body);
        part.spin = world_->angularVelocity(body);
        if (part.joint >= 0)
            part.anchor =
                transformPoint(pose, bodiesOf(def.joints[static_cast<std::size_t>(part.joint)].joint).frameB.position);
        if (world_->jointsOf(body).size() > 0) carry(i);
        mass_ += part.mass;
    }
    const DVec3 origin = parts_[0].center;
    Vec3 moment, momentum;
    std::fill(beyond_.begin(), beyond_.end(), 0.0f);
    for (const Part& part : parts_) {
        if (!part.exists) continue;
        moment += part.mass * relative(part.center, origin);
        momentum += part.mass * part.velocity;
        for (const Part* at = &part; at->parent >= 0; at = &parts_[static_cast<std::size_t>(at->parent)])
            beyond_[static_cast<std::size_t>(at->joint)] +=
                inertiaAbout(part.inertia, part.mass, relative(part.center, at->anchor));
    }
    center_ = origin + (1 / mass_) * moment;
    velocity_ = (1 / mass_) * momentum;
}

void InverseDynamics::look(const InverseDynamics& seen) {
    std::copy(seen.parts_.begin(), seen.parts_.end(), parts_.begin());
    std::copy(seen.beyond_.begin(), seen.beyond_.end(), beyond_.begin());
    mass_ = seen.mass_;
    center_ = seen.center_;
    velocity_ = seen.velocity_;
}

Vec3 InverseDynamics::angularMomentum() const {
    Vec3 sum;
    for (const Part& part : parts_)
        if (part.exists)
            sum +=
                part.inertia * part.spin + part.mass * cross(relative(part.center, center_), part.velocity - velocity_);
    return sum;
}

float InverseDynamics::inertiaOfRest(int joint) const {
    const auto child = static_cast<std::size_t>(ragdoll_->def().joints[static_cast<std::size_t>(joint)].child);
    const DVec3& anchor = parts_[child].anchor;
    float all = 0;
    for (const Part& part : parts_)
        if (part.exists) all += inertiaAbout(part.inertia, part.mass, relative(part.center, anchor));
    return std::max(all - inertiaBeyond(joint), 0.0f);
}

/// a_c = a_p + α_p × r + ω_p × (ω_p × r) up to the joint, likewise down to the centre of the child.
void InverseDynamics::accelerate(const PartMotion& root, std::span<const Vec3> joints,
                                 std::span<PartMotion> accelerations) const {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        PartMotion& mine = accelerations[i];
        mine = {};
        if (!part.exists) continue;
        if (part.parent < 0) {
            mine = i == 0 ? root : PartMotion{};
            continue;
        }
        const auto above = static_cast<std::size_t>(part.parent);
        const Part& carrier = parts_[above];
        const PartMotion& its = accelerations[above];
        mine.angular =
            its.angular + joints[static_cast<std::size_t>(part.joint)] + cross(carrier.spin, part.spin - carrier.spin);
        const auto bent = [](const Vec3& alpha, const Vec3& omega, const Vec3& r) {
            return cross(alpha, r) + cross(omega, cross(omega, r));
        };
        mine.linear = its.linear + bent(its.angular, carrier.spin, relative(part.anchor, carrier.center)) +
                      bent(mine.angular, part.spin, relative(part.center, part.anchor));
    }
}

/// F = m (a − g) − F_out,  N = I α + ω × I ω − N_out of each part, carried on to its parent at the joint.
PartMotion InverseDynamics::torques(std::span<const PartMotion> accelerations, std::span<const PartMotion> outside,
                                    std::span<Vec3> torques) const {
    const Vec3 gravity = world_->settings().gravity;
    std::fill(torques.begin(), torques.end(), Vec3{});
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        const PartMotion a = accelerations.empty() ? PartMotion{} : accelerations[i];
        const PartMotion w = outside.empty() ? PartMotion{} : outside[i];
        load_[i] = {};
        if (!part.exists) continue;
        const Vec3 weight = world_->gravityScale(ragdoll_->bodies()[i]) * gravity;
        load_[i] = {part.mass * (a.linear - weight) - w.linear,
                    part.inertia * a.angular + cross(part.spin, part.inertia * part.spin) - w.angular};
    }
    for (std::size_t i = parts_.size(); i-- > 0;) {
        const Part& part = parts_[i];
        if (!part.exists || part.parent < 0) continue;
        const auto above = static_cast<std::size_t>(part.parent);
        const Vec3 torque = load_[i].angular + cross(relative(part.center, part.anchor), load_[i].linear);
        torques[static_cast<std::size_t>(part.joint)] = torque;
        load_[above].linear += load_[i].linear;
        load_[above].angular += torque + cross(relative(part.anchor, parts_[above].center), load_[i].linear);
    }
    return load_[0];
}

}  // namespace ragtop
