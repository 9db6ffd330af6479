#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>

#include "base/check_tunables.h"
#include "base/union_find.h"
#include "contacts/meets_nothing.h"
#include "world/group_motion.h"
#include "world/world_impl.h"
#include "world/world_modules.h"

/// Reading and changing single bodies, shapes and joints.
namespace ragtop {

namespace {

void requireFinite(bool finite, const char* what) {
    if (!finite) throw std::invalid_argument(std::string(what) + " is not finite");
}

void requireRotation(const Quat& rotation, const char* what) {
    if (const std::string wrong = whyNoRotation(what, rotation); !wrong.empty()) throw std::invalid_argument(wrong);
}

void rebuild(IdLists& to, const ConstTables& tables, std::uint64_t version) {
    const Bodies& bodies = tables.bodies;
    const Joints& joints = tables.joints;
    to.version = version;
    to.bodies.clear();
    to.joints.clear();
    to.couplings.clear();
    to.bodyShapes.resize(bodies.slots.count());
    to.bodyJoints.resize(bodies.slots.count());
    for (std::uint32_t i = 1; i < bodies.slots.count(); ++i) {
        to.bodyShapes[i].clear();
        to.bodyJoints[i].clear();
        if (!bodies.slots.isUsed(i)) continue;
        to.bodies.push_back(bodies.id(i));
        for (std::uint32_t s = bodies[i].firstShape; s != kNone; s = tables.shapes[s].next)
            to.bodyShapes[i].push_back(tables.shapes.id(s));
    }
    for (std::uint32_t j = 0; j < joints.slots.count(); ++j) {
        if (!joints.slots.isUsed(j)) continue;
        to.joints.push_back(joints.id(j));
        for (const std::uint32_t body : {joints[j].bodyA, joints[j].bodyB})
            if (body != 0) to.bodyJoints[body].push_back(joints.id(j));
    }
    for (std::uint32_t c = 0; c < tables.couplings.slots.count(); ++c)
        if (tables.couplings.slots.isUsed(c)) to.couplings.push_back(tables.couplings.id(c));
}

/// Concurrent readers may all find them out of date.
const IdLists& listsOf(WorldImpl& world) {
    const std::lock_guard<std::mutex> lock(world.reports.idLists.mutex);
    if (world.reports.idLists.version != world.tables.versions.structure)
        rebuild(world.reports.idLists, world.tables, world.tables.versions.structure);
    return world.reports.idLists;
}

void visitContact(const WorldImpl& world, std::uint32_t index, const std::function<void(const Contact&)>& visit) {
    const ContactRecord& record = world.tables.contacts[index];
    if (!record.touching || record.sensor) return;
    for (const ManifoldRecord& manifold : world.tables.manifolds.of(record))
        if (manifold.pointCount > 0) visit(describe(world.tables, world.clock.lastSubstep, record, manifold));
}

void requireBetweenSteps(const WorldImpl& world, const char* what) {
    if (world.clock.inStep || world.clock.stepping)
        throw std::logic_error(std::string(what) + " was called within a step, must be called between two");
}

}  // namespace

std::span<const BodyId> World::bodies() const { return listsOf(*impl_).bodies; }
std::span<const JointId> World::joints() const { return listsOf(*impl_).joints; }
std::span<const CouplingId> World::couplings() const { return listsOf(*impl_).couplings; }
std::span<const ShapeId> World::shapes(BodyId body) const {
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    return listsOf(*impl_).bodyShapes[i];
}
std::span<const JointId> World::jointsOf(BodyId body) const {
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    return listsOf(*impl_).bodyJoints[i];
}

/// Between substeps a body is where its displacement has brought it.
Pose World::pose(BodyId id) const {
    const std::uint32_t i = indexOf(impl_->tables.bodies, id);
    const BodyRecord& body = impl_->tables.bodies[i];
    if (!impl_->clock.stepping || body.type == BodyType::fixed) return poseOf(body);
    const BodyState& state = impl_->tables.bodies.states[i];
    return Pose{body.center + state.dp, normalized(state.dq * body.rotation)} * inverse(body.local);
}
DVec3 World::centerOfMass(BodyId id) const {
    const std::uint32_t i = indexOf(impl_->tables.bodies, id);
    return impl_->tables.bodies[i].center + impl_->tables.bodies.states[i].dp;
}
Vec3 World::linearVelocity(BodyId body) const {
    return impl_->tables.bodies.states[indexOf(impl_->tables.bodies, body)].v;
}
Vec3 World::angularVelocity(BodyId body) const {
    return impl_->tables.bodies.states[indexOf(impl_->tables.bodies, body)].w;
}
Vec3 World::velocityAt(BodyId body, const DVec3& point) const {
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    return impl_->tables.bodies.states[i].v +
           cross(impl_->tables.bodies.states[i].w,
                 relative(point, impl_->tables.bodies[i].center + impl_->tables.bodies.states[i].dp));
}
BodyType World::type(BodyId body) const { return impl_->tables.bodies.typeOf(indexOf(impl_->tables.bodies, body)); }
bool World::isEnabled(BodyId body) const { return impl_->tables.bodies.isEnabled(indexOf(impl_->tables.bodies, body)); }
bool World::isAwake(BodyId body) const { return impl_->tables.bodies.isAwake(indexOf(impl_->tables.bodies, body)); }
std::uint64_t World::userData(BodyId body) const {
    return impl_->tables.bodies.userData[indexOf(impl_->tables.bodies, body)];
}

MassProperties World::mass(BodyId body) const {
    return massOf(impl_->tables.bodies[indexOf(impl_->tables.bodies, body)]);
}

void World::setType(BodyId body, BodyType type) {
    const std::uint32_t index = indexOf(impl_->tables.bodies, body);
    if (type != BodyType::fixed && type != BodyType::kinematic && type != BodyType::dynamic)
        throw std::invalid_argument("type is " + std::to_string(static_cast<int>(type)) +
                                    ", must be fixed, kinematic or dynamic");
    requireBetweenSteps(*impl_, "setType");
    impl_->scene().setType(index, type);
}

void World::setEnabled(BodyId body, bool enabled) {
    const std::uint32_t index = indexOf(impl_->tables.bodies, body);
    requireBetweenSteps(*impl_, "setEnabled");
    impl_->scene().setEnabled(index, enabled);
}

void World::setPose(BodyId body, const Pose& pose) {
    requireFinite(isFinite(pose.position), "pose.position");
    requireRotation(pose.rotation, "pose.rotation");
    impl_->scene().setPose(indexOf(impl_->tables.bodies, body), pose);
}

void World::setVelocity(BodyId body, const Vec3& linear, const Vec3& angular) {
    if (!impl_->takes(isFinite(linear) && isFinite(angular), "velocity")) return;
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    if (impl_->tables.bodies.typeOf(i) == BodyType::fixed) throw std::invalid_argument("a fixed body has no velocity");
    impl_->setVelocity(i, linear, angular);
    impl_->activity().wakeBody(i);
}

void World::setGravityScale(BodyId body, float scale) {
    requireFinite(std::isfinite(scale), "gravityScale");
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    impl_->tables.bodies[i].motion.gravityScale = scale;
    impl_->activity().wakeBody(i);
}

float World::gravityScale(BodyId body) const {
    return impl_->tables.bodies[indexOf(impl_->tables.bodies, body)].motion.gravityScale;
}

void World::setMass(BodyId id, const MassProperties& mass) {
    const std::uint32_t i = indexOf(impl_->tables.bodies, id);
    const BodyRecord& body = impl_->tables.bodies[i];
    if (impl_->tables.bodies.typeOf(i) == BodyType::fixed) throw std::invalid_argument("a fixed body has no mass");
    BodyDef def;
    def.locks = body.locks;
    def.mass = mass;
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    impl_->scene().changeMass(i, mass);
}

void World::moveTo(BodyId body, const Pose& target, double dt) {
    requireFinite(isFinite(target.position) && std::isfinite(dt), "target");
    requireRotation(target.rotation, "target.rotation");
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    if (!(dt > 0)) throw std::invalid_argument("dt must be above zero");
    const BodyRecord& record = impl_->tables.bodies[i];
    const Pose internal = Pose{target.position, normalized(target.rotation)} * record.local;
    const float rate = static_cast<float>(1 / dt);
    const Vec3 turn = rotationVector(internal.rotation * conjugate(record.rotation));
    setVelocity(body, rate * relative(internal.position, record.center), rate * turn);
}

void World::applyImpulse(BodyId body, const Vec3& impulse, const DVec3& point) {
    if (!impl_->takes(isFinite(impulse) && isFinite(point), "impulse")) return;
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    if (!impl_->tables.bodies.moves(i) || !mayPush(impl_->moduleWork, i)) return;
    const BodyState& state = impl_->tables.bodies.states[i];
    const Vec3 arm = relative(point, impl_->tables.bodies[i].center + state.dp);
    impl_->setVelocity(i, state.v + state.invMass * impulse,
                       state.w + impl_->tables.bodies.inertias[i] * cross(arm, impulse));
    if (!impl_->clock.stepping) impl_->activity().wakeBody(i);
}

void World::applyAngularImpulse(BodyId body, const Vec3& impulse) {
    if (!impl_->takes(isFinite(impulse), "impulse")) return;
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    if (!impl_->tables.bodies.moves(i) || !mayPush(impl_->moduleWork, i)) return;
    const BodyState& state = impl_->tables.bodies.states[i];
    impl_->setVelocity(i, state.v, state.w + impl_->tables.bodies.inertias[i] * impulse);
    if (!impl_->clock.stepping) impl_->activity().wakeBody(i);
}

void World::applyForce(BodyId body, const Vec3& force, const DVec3& point) {
    if (!impl_->takes(isFinite(force) && isFinite(point), "force")) return;
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    if (!impl_->tables.bodies.moves(i)) return;
    impl_->tables.bodies[i].force += force;
    // Forces beyond a few weights change what bears on what, as new support edges do.
    constexpr float kPressed = 4;  // weights
    if (length(impl_->tables.bodies[i].force) >
        kPressed * impl_->tables.bodies[i].mass * length(impl_->settings.gravity))
        impl_->partition.islands.structureChangedAt();
    impl_->tables.bodies[i].torque += cross(relative(point, impl_->tables.bodies[i].center), force);
    impl_->activity().wakeBody(i);
}

void World::applyTorque(BodyId body, const Vec3& torque) {
    if (!impl_->takes(isFinite(torque), "torque")) return;
    const std::uint32_t i = indexOf(impl_->tables.bodies, body);
    if (!impl_->tables.bodies.moves(i)) return;
    impl_->tables.bodies[i].torque += torque;
    impl_->activity().wakeBody(i);
}

std::vector<BodyId> World::islands() const {
    const WorldImpl& w = *impl_;
    std::vector<std::uint32_t> parent(w.tables.bodies.slots.count());
    for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
        if (w.tables.bodies.moves(a) && w.tables.bodies.moves(b)) unite(parent, a, b);
    };
    for (int c = 0; c < w.tables.graph.listCount(); ++c) {
        for (const std::uint32_t m : w.tables.graph.color(c).manifolds)
            if (const ContactRecord& contact = w.tables.contacts[w.tables.manifolds[m].contact]; contact.touching)
                join(contact.bodyA, contact.bodyB);
        for (const std::uint32_t j : w.tables.graph.color(c).joints)
            join(w.tables.joints[j].bodyA, w.tables.joints[j].bodyB);
    }
    forEachCoupledPair(w.tables, join);
    std::vector<BodyId> islands;
    for (const BodyId body : bodies())
        islands.push_back(w.tables.bodies.moves(body.index) && w.tables.bodies.isAwake(body.index)
                              ? w.tables.bodies.id(rootOf(parent, body.index))
                              : BodyId{});
    return islands;
}

int World::countIslands() const {
    const std::vector<BodyId> first = islands();
    const auto all = bodies();
    int count = 0;
    for (std::size_t i = 0; i < all.size(); ++i) count += first[i] == all[i];
    return count;
}

void World::wake(BodyId body) { impl_->activity().wakeBody(indexOf(impl_->tables.bodies, body)); }
void World::sleep(BodyId body) {
    const std::uint32_t first = indexOf(impl_->tables.bodies, body);
    if (!impl_->tables.bodies.isAwake(first)) return;
    impl_->partition.islands.findQuiet(impl_->tables);
    const std::uint32_t root = impl_->tables.bodies.moves(first) ? impl_->partition.islands.root(first) : first;
    std::vector<std::uint32_t> island;
    for (const std::uint32_t i : impl_->tables.bodies.awake)
        if (i == first || (impl_->tables.bodies.moves(i) && impl_->partition.islands.root(i) == root))
            island.push_back(i);
    for (const std::uint32_t i : island) impl_->activity().sleepBody(i);
}

BodyId World::bodyOf(ShapeId shape) const {
    return impl_->tables.bodies.id(impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)].body);
}
const Shape& World::geometry(ShapeId shape) const {
    return impl_->tables.shapes.geometries[impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)].geometry].shape;
}
Frame World::frame(ShapeId shape) const {
    const ShapeRecord& record = impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)];
    return impl_->tables.bodies[record.body].local * record.frame;
}
void World::setFrame(ShapeId id, const Frame& frame) {
    requireFinite(isFinite(frame.position), "frame.position");
    requireRotation(frame.rotation, "frame.rotation");
    const std::uint32_t i = indexOf(impl_->tables.shapes, id);
    Frame next = inverse(impl_->tables.bodies[impl_->tables.shapes[i].body].local) * frame;
    next.rotation = normalized(next.rotation);
    impl_->scene().moveShape(i, next);
}
bool World::givesWay(ShapeId shape) const {
    return impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)].givesWay;
}
Material World::material(ShapeId shape) const {
    return impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)].material;
}
void World::setMaterial(ShapeId shape, const Material& material) {
    if (const std::string wrong = whyInvalid(material); !wrong.empty()) throw std::invalid_argument(wrong);
    const std::uint32_t index = indexOf(impl_->tables.shapes, shape);
    const ShapeRecord& record = impl_->tables.shapes[index];
    impl_->tables.shapes.setMaterial(index, material);
    for (std::uint32_t key = impl_->tables.bodies[record.body].firstContact; key != kNone;
         key = impl_->tables.contacts.next(key))
        impl_->tables.contacts[key >> 1].surfaceOpen = true;
    impl_->activity().wakeTouching(record.body);
}
void World::setFilter(ShapeId shape, const Filter& filter) {
    const std::uint32_t i = indexOf(impl_->tables.shapes, shape);
    ShapeRecord& record = impl_->tables.shapes[i];
    impl_->activity().wakeTouching(record.body);
    record.filter = filter;
    for (std::uint32_t key = impl_->tables.bodies[record.body].firstContact; key != kNone;) {
        const ContactRecord& contact = impl_->tables.contacts[key >> 1];
        const std::uint32_t next = impl_->tables.contacts.next(key);
        if (contact.shapeA == i || contact.shapeB == i) impl_->activity().destroyContact(key >> 1);
        key = next;
    }
    const ShapeBounds bounds = impl_->shapeBounds();
    if (record.proxy != kNone && meetsNothing(filter)) bounds.removeProxy(i);
    if (record.proxy == kNone && !meetsNothing(filter) && impl_->tables.bodies.isEnabled(record.body)) {
        bounds.giveRoom(record.body);
        bounds.insertProxy(i);
    }
    if (record.proxy != kNone)
        impl_->collision.broadphase.tree(record.isStaticTree).setCategory(record.proxy, filter.category);
    bounds.markMoved(i);
}
std::uint64_t World::userData(ShapeId shape) const {
    return impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)].userData;
}
Bounds World::bounds(ShapeId shape) const {
    const ShapeRecord& record = impl_->tables.shapes[indexOf(impl_->tables.shapes, shape)];
    return boundsOf(impl_->tables.shapes.geometries[record.geometry].shape,
                    shapePose(impl_->tables.bodies[record.body], record));
}

const JointDef& World::def(JointId joint) const {
    return impl_->tables.joints[indexOf(impl_->tables.joints, joint)].def;
}
void World::setDef(JointId id, const JointDef& def) {
    const std::uint32_t i = indexOf(impl_->tables.joints, id);
    const JointRecord& joint = impl_->tables.joints[i];
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    const auto bodiesOf = [](const JointDef& d) -> const JointBodies& {
        return std::visit([](const auto& j) -> const JointBodies& { return j.bodies; }, d);
    };
    const JointBodies &before = bodiesOf(joint.def), &after = bodiesOf(def);
    if (def.index() != joint.def.index() || before.a != after.a || before.b != after.b)
        throw std::invalid_argument("setDef keeps the type and the bodies of a joint");
    impl_->scene().redefineJoint(i, def);
}
JointState World::state(JointId id) const {
    const std::uint32_t i = indexOf(impl_->tables.joints, id);
    const float rate = impl_->clock.lastSubstep > 0 ? 1 / impl_->clock.lastSubstep : 0;
    return jointState(impl_->tables.joints.sims[i], jointBodies(impl_->tables.bodies, impl_->tables.joints[i]),
                      impl_->tables.bodies.states.data(), rate);
}
std::uint64_t World::userData(JointId joint) const {
    return std::visit([](const auto& d) { return d.bodies.userData; },
                      impl_->tables.joints[indexOf(impl_->tables.joints, joint)].def);
}

std::span<const ContactEvent> World::contactBegins() const { return impl_->events.begins(); }
std::span<const ContactEvent> World::contactEnds() const { return impl_->events.ends(); }
std::span<const ContactEvent> World::sensorBegins() const { return impl_->events.sensorBegins(); }
std::span<const ContactEvent> World::sensorEnds() const { return impl_->events.sensorEnds(); }
std::span<const SurfaceEvent> World::surfaceEvents() const { return impl_->events.surfaces(); }
std::span<const SleepEvent> World::sleepEvents() const { return impl_->events.sleeps(); }
std::span<const JointBreak> World::jointBreaks() const { return impl_->events.breaks(); }

void World::forEachContact(const std::function<void(const Contact&)>& visit) const {
    for (std::uint32_t c = 0; c < impl_->tables.contacts.slots.count(); ++c)
        if (impl_->tables.contacts.slots.isUsed(c)) visitContact(*impl_, c, visit);
}
void World::forEachContact(BodyId body, const std::function<void(const Contact&)>& visit) const {
    std::uint32_t key = impl_->tables.bodies[indexOf(impl_->tables.bodies, body)].firstContact;
    for (; key != kNone; key = impl_->tables.contacts.next(key)) visitContact(*impl_, key >> 1, visit);
}
/// A velocity given between steps is no acceleration that the position map could take for a smooth one.
void WorldImpl::setVelocity(std::uint32_t index, const Vec3& linear, const Vec3& angular) {
    BodyState& state = tables.bodies.states[index];
    const Vec3 before = state.v;
    const bool isWatched = clock.stepping && guards.energy.groupCount() > 0 && tables.bodies.moves(index);
    const auto kinetic = [&] { return kineticEnergy(tables.bodies, index, rotationNow(tables.bodies, index)); };
    const double had = isWatched ? kinetic() : 0;
    if (tables.bodies[index].type == BodyType::kinematic && (linear != state.v || angular != state.w)) {
        if (clock.stepping)
            tables.slopes.replace(tables.bodies, index, linear, angular);
        else
            tables.slopes.record(tables.bodies, index, clock.dt);
    }
    state.v = linear;
    state.w = angular;
    if (tables.bodies[index].type == BodyType::dynamic) tables.bodies.obeyLocks(index);
    if (!clock.stepping) tables.bodies.histories[index].velocityBefore += state.v - before;
    if (isWatched) recordDriven(guards.energy, index, kinetic() - had);
    // Bounds that are made when the step ends count what modules did within it.
    if (!moduleWork.inSubsteps) shapeBounds().recordNewVelocity(index);
}

double World::energy() const {
    double total = 0;
    const Vec3 gravity = impl_->settings.gravity;
    for (std::uint32_t i = 1; i < impl_->tables.bodies.slots.count(); ++i) {
        if (!impl_->tables.bodies.slots.isUsed(i) || !impl_->tables.bodies.moves(i)) continue;
        const BodyRecord& body = impl_->tables.bodies[i];
        const Vec3 v = impl_->tables.bodies.states[i].v,
                   w = inverseRotate(body.rotation, impl_->tables.bodies.states[i].w);
        const double m = body.mass;
        total += 0.5 * m * static_cast<double>(dot(v, v));
        total +=
            0.5 * (static_cast<double>(body.inertia.x * w.x * w.x) + static_cast<double>(body.inertia.y * w.y * w.y) +
                   static_cast<double>(body.inertia.z * w.z * w.z));
        const double g = static_cast<double>(body.motion.gravityScale) * m;
        total -= g * (gravity.x * body.center.x + gravity.y * body.center.y + gravity.z * body.center.z);
    }
    return total;
}

}  // namespace ragtop
