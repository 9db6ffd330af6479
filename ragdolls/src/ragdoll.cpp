#include "ragtop/ragdoll.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "point_joint.h"
#include "ragtop/world.h"
#include "self_filter.h"

namespace ragtop {
namespace {

float densityOf(const RagdollPart& part) { return part.mass / massOf(part.shape, 1.0f).mass; }

MassProperties massOf(const RagdollPart& part) {
    MassProperties mass = transformed(massOf(part.shape, densityOf(part)), part.frame);
    mass.mass = part.mass;
    return mass;
}

BodyDef bodyOf(const RagdollPart& part, const Pose& pose, const Vec3& velocity, const Vec3& spin) {
    ShapeDef shape{.geometry = part.shape, .frame = part.frame, .material = part.material};
    shape.density = densityOf(part);
    BodyDef body;
    body.mass = massOf(part);
    body.shapes.push_back(std::move(shape));
    body.pose = pose;
    body.linearVelocity = velocity;
    body.angularVelocity = spin;
    return body;
}

void validate(const RagdollDef& def) {
    if (const std::string problem = whyInvalid(def); !problem.empty())
        throw std::invalid_argument("ragdoll: " + problem);
}

}  // namespace

/// Pose of a part, velocity of its centre of mass, m/s, and its angular velocity, rad/s.
struct Ragdoll::PartMotion {
    Pose pose{};
    Vec3 velocity{}, spin{};
};

Ragdoll::Ragdoll(World& world, const RagdollDef& def, const Pose& placement, const Vec3& velocity)
    : world_(&world), def_(def) {
    validate(def_);
    std::vector<PartMotion> parts;
    for (const RagdollPart& part : def_.parts) parts.push_back({placement * part.bind, velocity, {}});
    spawn(parts);
}

Ragdoll::Ragdoll(World& world, const RagdollDef& def, std::span<const Pose> bones, const Vec3& velocity)
    : world_(&world), def_(def) {
    validate(def_);
    std::vector<PartMotion> parts;
    for (const Pose& pose : partsOf(bones)) parts.push_back({pose, velocity, {}});
    spawn(parts);
}

Ragdoll::Ragdoll(World& world, const RagdollDef& def, std::span<const Pose> before, std::span<const Pose> now,
                 double dt)
    : world_(&world), def_(def) {
    validate(def_);
    if (!(dt > 0) || !std::isfinite(dt))
        throw std::invalid_argument("ragdoll: dt is " + std::to_string(dt) + " s, must be above zero and finite");
    const std::vector<Pose> from = partsOf(before), to = partsOf(now);
    const auto rate = static_cast<float>(1 / dt);
    std::vector<PartMotion> parts;
    for (std::size_t i = 0; i < to.size(); ++i) {
        const Vec3 center = massOf(def_.parts[i]).center;
        parts.push_back({to[i], rate * relative(transformPoint(to[i], center), transformPoint(from[i], center)),
                         rate * rotationVector(to[i].rotation * conjugate(from[i].rotation))});
    }
    spawn(parts);
}

std::vector<Pose> Ragdoll::partsOf(std::span<const Pose> bones) const {
    if (bones.size() != def_.bones.size())
        throw std::invalid_argument("ragdoll: got " + std::to_string(bones.size()) + " poses of bones, must be " +
                                    std::to_string(def_.bones.size()));
    std::vector<Pose> parts;
    for (const RagdollPart& part : def_.parts) parts.push_back(bones[static_cast<std::size_t>(part.bone)]);
    closeJoints(def_, parts);
    return parts;
}

void Ragdoll::spawn(std::span<const PartMotion> parts) {
    try {
        for (std::size_t i = 0; i < def_.parts.size(); ++i)
            bodies_.push_back(world_->create(bodyOf(def_.parts[i], parts[i].pose, parts[i].velocity, parts[i].spin)));
        for (const RagdollJoint& joint : def_.joints) joints_.push_back(world_->create(placed(joint)));
        ignore();
    } catch (...) {
        release();
        throw;
    }
}

/// A joint that leaves all directions free holds nothing, and keeps its bodies from meeting for as long as they are.
void Ragdoll::ignore() {
    if (!def_.selfCollision) {
        Filter filter;
        filter.group = groupOfSelf(bodies_.front());
        for (const BodyId body : bodies_)
            for (const ShapeId shape : world_->shapes(body)) world_->setFilter(shape, filter);
        return;
    }
    for (const RagdollPair& pair : def_.ignored) {
        SixDofDef apart;
        apart.bodies.a = bodies_[static_cast<std::size_t>(pair.first)];
        apart.bodies.b = bodies_[static_cast<std::size_t>(pair.second)];
        world_->create(apart);
    }
}

JointDef Ragdoll::placed(const RagdollJoint& joint) const {
    JointDef complete = joint.joint;
    std::visit(
        [&](auto& each) {
            each.bodies.a = bodies_[static_cast<std::size_t>(joint.parent)];
            each.bodies.b = bodies_[static_cast<std::size_t>(joint.child)];
        },
        complete);
    return complete;
}

void Ragdoll::release() {
    if (!world_) return;
    for (const JointId joint : joints_)
        if (world_->isValid(joint)) world_->destroy(joint);
    for (const BodyId body : bodies_)
        if (world_->isValid(body)) world_->destroy(body);
    joints_.clear();
    bodies_.clear();
}

void Ragdoll::setDef(const RagdollDef& next) {
    validate(next);
    if (next.parts.size() != def_.parts.size() || next.joints.size() != def_.joints.size())
        throw std::invalid_argument("ragdoll: has " + std::to_string(next.parts.size()) + " parts and " +
                                    std::to_string(next.joints.size()) + " joints, must keep " +
                                    std::to_string(def_.parts.size()) + " and " + std::to_string(def_.joints.size()));
    for (std::size_t i = 0; i < next.joints.size(); ++i)
        if (next.joints[i].joint.index() != def_.joints[i].joint.index())
            throw std::invalid_argument("ragdoll: joints[" + std::to_string(i) + "] must keep its kind");
    for (std::size_t i = 0; i < next.parts.size(); ++i) {
        // What the world has, which a restored state may have changed.
        if (world_->mass(bodies_[i]).mass != next.parts[i].mass) world_->setMass(bodies_[i], massOf(next.parts[i]));
        for (const ShapeId shape : world_->shapes(bodies_[i]))
            if (world_->material(shape) != next.parts[i].material) world_->setMaterial(shape, next.parts[i].material);
    }
    for (std::size_t i = 0; i < next.joints.size(); ++i) world_->setDef(joints_[i], placed(next.joints[i]));
    def_ = next;
}

Ragdoll::~Ragdoll() { release(); }

Ragdoll::Ragdoll(Ragdoll&& other) noexcept
    : world_(std::exchange(other.world_, nullptr)),
      def_(std::move(other.def_)),
      bodies_(std::move(other.bodies_)),
      joints_(std::move(other.joints_)) {}

Ragdoll& Ragdoll::operator=(Ragdoll&& other) noexcept {
    if (this != &other) {
        release();
        world_ = std::exchange(other.world_, nullptr);
        def_ = std::move(other.def_);
        bodies_ = std::exchange(other.bodies_, {});
        joints_ = std::exchange(other.joints_, {});
    }
    return *this;
}

BodyId Ragdoll::body(std::string_view bone) const {
    for (const RagdollBone& each : def_.bones)
        if (each.name == bone) return bodies_[static_cast<std::size_t>(each.part)];
    return {};
}

std::vector<BeyondLimit> Ragdoll::beyondLimits(float tolerance) const {
    std::vector<BeyondLimit> result;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        if (!world_->isValid(joints_[i])) continue;
        const float margin = world_->state(joints_[i]).limitMargin;
        if (margin < -tolerance) result.push_back({static_cast<int>(i), -margin});
    }
    return result;
}

void Ragdoll::partPoses(std::span<Pose> into) const {
    for (std::size_t i = 0; i < bodies_.size() && i < into.size(); ++i) into[i] = world_->pose(bodies_[i]);
}

Pose Ragdoll::pose(int bone) const {
    const RagdollBone& each = def_.bones.at(static_cast<std::size_t>(bone));
    return world_->pose(bodies_[static_cast<std::size_t>(each.part)]) * each.inPart;
}

void Ragdoll::pose(std::span<Pose> into) const {
    const std::size_t count = def_.bones.size() < into.size() ? def_.bones.size() : into.size();
    for (std::size_t i = 0; i < count; ++i) into[i] = pose(static_cast<int>(i));
}

std::vector<Pose> Ragdoll::pose() const {
    std::vector<Pose> poses(def_.bones.size());
    pose(poses);
    return poses;
}

}  // namespace ragtop
