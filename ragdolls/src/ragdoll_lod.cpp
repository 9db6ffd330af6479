#include "ragtop/ragdoll_lod.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

#include "joint_bodies.h"
#include "ragtop/world.h"
#include "range_check.h"
#include "self_filter.h"

namespace ragtop {
namespace {

float trace(const Mat3& m) { return m.cx.x + m.cy.y + m.cz.z; }

/// x of M x = b for a symmetric M, by Cramer's rule.
Vec3 solve(const Mat3& m, const Vec3& b) {
    const Vec3 x = cross(m.cy, m.cz), y = cross(m.cz, m.cx), z = cross(m.cx, m.cy);
    return (1 / dot(m.cx, x)) * Vec3{dot(x, b), dot(y, b), dot(z, b)};
}

/// Mass properties of a part at rest, in model space.
MassProperties massAtRest(const RagdollPart& part) {
    MassProperties mass = massOf(part.shape, part.mass / massOf(part.shape, 1.0f).mass);
    return transformed(mass, part.bind * part.frame);
}

/// kg m², the mean of the moments about three axes through a point.
float inertiaAbout(const MassProperties& mass, const Vec3& point) {
    return (trace(mass.inertia) + 2 * mass.mass * lengthSquared(mass.center - point)) / 3;
}

bool isFree(const AxisDef& axis) {
    return !axis.limit && !axis.motor && !axis.spring && !axis.bearing && axis.friction == 0;
}

/// Does a joint only keep its bodies from meeting?
bool isFree(const JointDef& def) {
    const auto* six = std::get_if<SixDofDef>(&def);
    return six && isFree(six->x) && isFree(six->y) && isFree(six->z) && isFree(six->twist) && isFree(six->swingY) &&
           isFree(six->swingZ);
}

}  // namespace

/// Which body moves a part, and where it is in that.
struct RagdollLod::Part {
    std::size_t group = 0;
    bool merged = false;
    MassProperties mass{};  ///< in its bone
    Frame inGroup{};
};

/// Pose of a part, velocity of its centre of mass, m/s, and its angular velocity, rad/s.
struct RagdollLod::Motion {
    Pose pose{};
    DVec3 center{};
    Vec3 velocity{}, spin{};
};

std::string_view nameOf(RagdollLevel level) {
    constexpr std::array<std::string_view, 4> kNames{"full", "reduced", "single", "asleep"};
    return kNames[static_cast<std::size_t>(level)];
}

std::string whyInvalid(const RagdollLodOptions& options) {
    if (options.groups < 1 || options.groups > 128)
        return "groups is " + std::to_string(options.groups) + ", must be in [1, 128]";
    return whyOutside(options);
}

std::vector<int> stiffGroups(const RagdollDef& def, int most) {
    const std::size_t count = def.parts.size();
    std::vector<int> group(count);
    std::iota(group.begin(), group.end(), 0);
    std::vector<MassProperties> mass;
    for (const RagdollPart& part : def.parts) mass.push_back(massAtRest(part));
    const auto of = [&](int part) { return static_cast<std::size_t>(group[static_cast<std::size_t>(part)]); };
    std::size_t groups = count;
    while (groups > static_cast<std::size_t>(most)) {
        const RagdollJoint* stiff = nullptr;
        float least = 0;
        for (const RagdollJoint& joint : def.joints) {
            if (of(joint.parent) == of(joint.child)) continue;
            const Frame& bone = def.parts[static_cast<std::size_t>(joint.child)].bind;
            const Vec3 at = transformPoint(bone, bodiesOf(joint.joint).frameB.position);
            const float a = inertiaAbout(mass[of(joint.parent)], at), b = inertiaAbout(mass[of(joint.child)], at);
            const float moves = a * b / (a + b);
            if (!stiff || moves < least) stiff = &joint, least = moves;
        }
        if (!stiff) break;
        const int from = group[static_cast<std::size_t>(stiff->child)],
                  to = group[static_cast<std::size_t>(stiff->parent)];
        const std::array both{mass[static_cast<std::size_t>(to)], mass[static_cast<std::size_t>(from)]};
        mass[static_cast<std::size_t>(to)] = combined(both);
        for (int& each : group)
            if (each == from) each = to;
        --groups;
    }
    return group;
}

RagdollLod::RagdollLod(World& world, const Ragdoll& ragdoll, const RagdollLodOptions& options)
    : world_(&world), ragdoll_(&ragdoll), options_(options) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("ragdoll LOD: " + problem);
    reduced_ = stiffGroups(ragdoll.def(), options.groups);
    parts_.resize(ragdoll.def().parts.size());
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].group = i;
    bodies_.assign(ragdoll.bodies().begin(), ragdoll.bodies().end());
}

RagdollLod::~RagdollLod() {
    if (level_ != RagdollLevel::full) setLevel(RagdollLevel::full);
}

Pose RagdollLod::partPose(int part) const {
    const Part& each = parts_.at(static_cast<std::size_t>(part));
    const Pose pose = world_->pose(bodies_[each.group]);
    return each.merged ? pose * each.inGroup : pose;
}

void RagdollLod::pose(std::span<Pose> into) const {
    const std::vector<RagdollBone>& bones = ragdoll_->def().bones;
    for (std::size_t i = 0; i < bones.size() && i < into.size(); ++i)
        into[i] = partPose(bones[i].part) * bones[i].inPart;
}

RagdollLod::Motion RagdollLod::motionOf(std::size_t part) const {
    const BodyId body = bodies_[parts_[part].group];
    Motion motion{partPose(static_cast<int>(part)), {}, {}, world_->angularVelocity(body)};
    motion.pose.rotation = normalized(motion.pose.rotation);
    motion.center = transformPoint(motion.pose, parts_[part].mass.center);
    motion.velocity = world_->velocityAt(body, motion.center);
    return motion;
}

void RagdollLod::setLevel(RagdollLevel level) {
    if (level == level_) return;
    if (level_ == RagdollLevel::full)
        for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].mass = world_->mass(ragdoll_->bodies()[i]);
    const bool isOne = level == RagdollLevel::single || level == RagdollLevel::asleep,
               wasOne = level_ == RagdollLevel::single || level_ == RagdollLevel::asleep;
    // Out of the world a body tells no velocity: it is put back to be asked.
    if (level_ == RagdollLevel::asleep) world_->setEnabled(bodies_.front(), true);
    if (!(isOne && wasOne)) {
        std::vector<int> groups = reduced_;
        if (isOne) std::fill(groups.begin(), groups.end(), 0);
        if (level == RagdollLevel::full) std::iota(groups.begin(), groups.end(), 0);
        regroup(groups);
    }
    if (level == RagdollLevel::asleep) world_->setEnabled(bodies_.front(), false);
    level_ = level;
}

void RagdollLod::regroup(const std::vector<int>& groups) {
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < parts_.size(); ++i) motions.push_back(motionOf(i));
    dissolve();
    for (std::size_t first = 0; first < parts_.size(); ++first) {
        if (std::find(groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(first), groups[first]) !=
            groups.begin() + static_cast<std::ptrdiff_t>(first))
            continue;
        std::vector<std::size_t> members;
        for (std::size_t i = first; i < parts_.size(); ++i)
            if (groups[i] == groups[first]) members.push_back(i);
        makeGroup(members, motions);
    }
    joinGroups();
}

void RagdollLod::dissolve() {
    for (const JointId joint : joints_)
        if (world_->isValid(joint)) world_->destroy(joint);
    for (const BodyId body : merged_)
        if (world_->isValid(body)) world_->destroy(body);
    joints_.clear();
    merged_.clear();
    bodies_.clear();
}

/// One body that has the momentum P = Σ m v and the angular momentum L = Σ I ω + m r × (v − V) of its parts about their
/// centre of mass: V = P/M and Ω = I⁻¹ L, or the part itself where it is alone.
void RagdollLod::makeGroup(const std::vector<std::size_t>& members, const std::vector<Motion>& motions) {
    const std::size_t first = members.front();
    const BodyId own = ragdoll_->bodies()[first];
    const bool merged = members.size() > 1;
    for (const std::size_t i : members) {
        parts_[i].group = bodies_.size();
        parts_[i].merged = merged;
        parts_[i].inGroup = merged ? relative(motions[first].pose, motions[i].pose) : Frame{};
        const BodyId body = ragdoll_->bodies()[i];
        if (merged) {
            if (world_->isEnabled(body)) world_->setEnabled(body, false);
            continue;
        }
        if (world_->isEnabled(body)) continue;
        world_->setPose(body, motions[i].pose);
        world_->setEnabled(body, true);
        world_->setVelocity(body, motions[i].velocity, motions[i].spin);
    }
    if (!merged) {
        bodies_.push_back(own);
        return;
    }
    BodyDef def;
    def.pose = motions[first].pose;
    def.userData = world_->userData(own);
    Filter filter;
    filter.group = groupOfSelf(ragdoll_->bodies().front());
    std::vector<MassProperties> masses;
    for (const std::size_t i : members) {
        masses.push_back(transformed(parts_[i].mass, parts_[i].inGroup));
        for (const ShapeId shape : world_->shapes(ragdoll_->bodies()[i]))
            def.shapes.push_back({.geometry = world_->geometry(shape),
                                  .frame = parts_[i].inGroup * world_->frame(shape),
                                  .material = world_->material(shape),
                                  .filter = filter,
                                  .userData = world_->userData(shape)});
    }
    def.mass = combined(masses);
    const DVec3 center = transformPoint(def.pose, def.mass->center);
    Vec3 momentum, spin;
    for (const std::size_t i : members) momentum += parts_[i].mass.mass * motions[i].velocity;
    def.linearVelocity = (1 / def.mass->mass) * momentum;
    for (const std::size_t i : members) {
        const Quat& turn = motions[i].pose.rotation;
        const Vec3 arm = relative(motions[i].center, center), inBone = inverseRotate(turn, motions[i].spin);
        spin += rotate(turn, parts_[i].mass.inertia * inBone) +
                parts_[i].mass.mass * cross(arm, motions[i].velocity - def.linearVelocity);
    }
    const Quat& turn = def.pose.rotation;
    def.angularVelocity = rotate(turn, solve(def.mass->inertia, inverseRotate(turn, spin)));
    merged_.push_back(world_->create(def));
    bodies_.push_back(merged_.back());
}

/// Joints of parts that are in a group, but for those within it, in place of which the group has its own.
void RagdollLod::joinGroups() {
    const std::span<const BodyId> own = ragdoll_->bodies();
    const auto partOf = [&](BodyId body) {
        return static_cast<std::size_t>(std::find(own.begin(), own.end(), body) - own.begin());
    };
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        for (const JointId joint :
             std::vector<JointId>(world_->jointsOf(own[i]).begin(), world_->jointsOf(own[i]).end())) {
            JointDef def = world_->def(joint);
            const std::size_t a = partOf(bodiesOf(def).a), b = partOf(bodiesOf(def).b);
            const bool isOfA = a == i;
            if (isFree(def) || (!isOfA && a < own.size())) continue;  // met from its first body
            const bool mergedA = a < own.size() && parts_[a].merged, mergedB = b < own.size() && parts_[b].merged;
            if (!mergedA && !mergedB) continue;
            if (a < own.size() && b < own.size() && parts_[a].group == parts_[b].group) continue;
            const auto move = [&](BodyId& body, Frame& frame, std::size_t part) {
                body = bodies_[parts_[part].group];
                frame = parts_[part].inGroup * frame;
                frame.rotation = normalized(frame.rotation);
            };
            std::visit(
                [&](auto& kind) {
                    if (mergedA) move(kind.bodies.a, kind.bodies.frameA, a);
                    if (mergedB) move(kind.bodies.b, kind.bodies.frameB, b);
                },
                def);
            joints_.push_back(world_->create(def));
        }
    }
}

void RagdollLod::setHeightOnScreen(float share) {
    const auto levelOf = [&](float height) {
        if (height < options_.asleep) return RagdollLevel::asleep;
        if (height < options_.single) return RagdollLevel::single;
        return height < options_.reduced ? RagdollLevel::reduced : RagdollLevel::full;
    };
    const RagdollLevel less = levelOf(share), more = levelOf(share / options_.slack);
    if (less > level_) setLevel(less);
    if (more < level_) setLevel(more);
}

}  // namespace ragtop
