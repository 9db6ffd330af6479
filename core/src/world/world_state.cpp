#include <algorithm>
#include <atomic>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/checksum.h"
#include "base/hash.h"
#include "world/state_archive.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

struct StateHeader {
    char magic[8] = {'R', 'A', 'G', 'T', 'O', 'P', 'S', '3'};
    std::uint32_t lanes = 0, geometries = 0, modules = 0;
    std::uint32_t layout = sizeof(BodyRecord) + 7 * sizeof(ContactRecord) + 31 * sizeof(ManifoldRecord) +
                           127 * (sizeof(JointSim) + sizeof(AxesJointSim)) + 511 * sizeof(CouplingSim) +
                           8191 * sizeof(ShapeRecord) + 32767 * sizeof(NearTriangles);
    std::uint64_t shapes = 0;    ///< digest of the geometries, which are not saved
    std::uint64_t bytes = 0;     ///< of header and payload
    std::uint64_t checksum = 0;  ///< of the payload
};

/// Of parts, on all threads; a sum, so that their order does not matter.
std::uint64_t checksumOf(StageRunner& runner, std::span<const std::byte> bytes) {
    constexpr std::size_t kPart = 1 << 16;  // bytes of a task
    std::atomic<std::uint64_t> total{0};
    runner.parallelFor(static_cast<int>((bytes.size() + kPart - 1) / kPart), 4, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            const std::size_t start = static_cast<std::size_t>(i) * kPart;
            StateHash part;
            part.add(static_cast<std::uint64_t>(i));
            part.add(checksum(bytes.subspan(start, std::min(kPart, bytes.size() - start))));
            total.fetch_add(part.value(), std::memory_order_relaxed);
        }
    });
    return total.load(std::memory_order_relaxed);
}

/// Kinds and sizes of the first `count` geometries.
std::uint64_t digestOf(const std::pmr::vector<GeometryEntry>& geometries, std::size_t count) {
    StateHash digest;
    for (std::size_t i = 0; i < count; ++i) {
        digest.add(static_cast<std::uint64_t>(geometries[i].shape.index()));
        digest.add(geometries[i].size);
        digest.add(geometries[i].convex.radius);
        digest.add(geometries[i].convex.halfExtents);
        if (!geometries[i].isMesh()) continue;
        const Bounds bounds = boundsOf(geometries[i].shape, Pose{});
        digest.add(bounds.lower);
        digest.add(bounds.upper);
    }
    return digest.value();
}

}  // namespace

/// Everything that a step reads and that outlives it, in one place for counting, saving and restoring.
template <class Archive>
void WorldImpl::archive(Archive& archive) {
    tables.bodies.archive(archive);
    tables.shapes.archive(archive);
    tables.contacts.archive(archive);
    tables.manifolds.archive(archive);
    tables.joints.archive(archive);
    tables.couplings.archive(archive);
    tables.slopes.archive(archive);
    collision.broadphase.archive(archive);
    partition.islands.archive(archive);
    events.archive(archive);
    archive(guards.energy.room);
    archive(guards.energy.owed);
    archive(guards.energy.undone);
    archive(tables.graph.bodies());
    const int lists = archive.lists(tables.graph);
    for (int c = 0; c < lists; ++c) {
        // A state that is only checked may have more of them.
        ConstraintGraph::Color& color = tables.graph.color(c < tables.graph.listCount() ? c : 0);
        archive(color.manifolds);
        archive(color.joints);
        archive.bundles(tables.graph, c);
    }
    archive.value(settings);
    archive.value(clock.stepCount);
    archive.value(clock.time);
    archive.value(clock.lastSubstep);
    archive.value(clock.dt);
}

namespace {

/// What a state saved now would say of its world, which may have got more geometries since.
StateHeader headerOf(const WorldImpl& world, std::size_t geometries) {
    StateHeader header;
    header.lanes = static_cast<std::uint32_t>(world.tables.graph.lanes());
    header.geometries = static_cast<std::uint32_t>(geometries);
    header.modules = static_cast<std::uint32_t>(world.moduleWork.modules.size());
    header.shapes = digestOf(world.tables.shapes.geometries, geometries);
    return header;
}

}  // namespace

std::size_t World::saveSize() const {
    StateCounter counter;
    impl_->archive(counter);
    for (const StepModule* module : impl_->moduleWork.modules)
        counter.bytes += sizeof(std::uint64_t) + (module->saveSize ? module->saveSize(module->user) : 0);
    return sizeof(StateHeader) + counter.bytes;
}

std::size_t World::save(std::span<std::byte> into) const {
    const std::size_t size = saveSize();
    if (into.size() < size)
        throw std::length_error("saving needs " + std::to_string(size) + " bytes, the memory has " +
                                std::to_string(into.size()));
    StateHeader header = headerOf(*impl_, impl_->tables.shapes.geometries.size());
    header.bytes = size;
    StateWriter writer(into.data() + sizeof header);
    impl_->archive(writer);
    for (const StepModule* module : impl_->moduleWork.modules) {
        std::uint64_t bytes = module->saveSize ? module->saveSize(module->user) : 0;
        writer.value(bytes);
        if (bytes > 0 && module->save) module->save(module->user, {writer.end(), static_cast<std::size_t>(bytes)});
        writer = StateWriter(writer.end() + bytes);
    }
    header.checksum = checksumOf(impl_->machine.runner, into.first(size).subspan(sizeof header));
    std::memcpy(into.data(), &header, sizeof header);
    return size;
}

namespace {

/// Empty when the header fits the world.
std::string whyForeign(const StateHeader& header, const StateHeader& own, std::size_t size) {
    if (std::memcmp(header.magic, own.magic, sizeof own.magic) != 0 || header.layout != own.layout)
        return "the bytes are no state of this version of the library";
    if (header.bytes > size)
        return "the state has " + std::to_string(header.bytes) + " bytes, only " + std::to_string(size) + " are there";
    if (header.lanes != own.lanes)
        return "the state is of a world with " + std::to_string(header.lanes) + " lanes, this one has " +
               std::to_string(own.lanes);
    if (header.geometries != own.geometries || header.modules != own.modules)
        return "the state is of a world with " + std::to_string(header.geometries) + " geometries and " +
               std::to_string(header.modules) + " modules, this one has " + std::to_string(own.geometries) + " and " +
               std::to_string(own.modules);
    if (header.shapes != own.shapes) return "the state is of a world with other shapes";
    if (header.bytes < sizeof header) return "the state is damaged";
    return {};
}

void requireFitting(const StepModule& module, std::span<const std::byte> state) {
    const std::string begin = std::string("the state of module '") + module.name + "' ";
    if (state.size() != (module.saveSize ? module.saveSize(module.user) : 0))
        throw std::invalid_argument(begin + "has another size");
    if (module.fits && !module.fits(module.user, state))
        throw std::invalid_argument(begin + "was saved under another definition, must be that of now");
}

}  // namespace

void World::restore(std::span<const std::byte> from) {
    StateHeader header;
    if (from.size() < sizeof header) throw std::invalid_argument("the bytes are no state: too few");
    std::memcpy(&header, from.data(), sizeof header);
    // Shapes that came after the state was saved do no harm.
    const std::size_t known = impl_->tables.shapes.geometries.size();
    const StateHeader own = headerOf(*impl_, header.geometries < known ? header.geometries : known);
    if (const std::string why = whyForeign(header, own, from.size()); !why.empty()) throw std::invalid_argument(why);
    const auto payload = from.subspan(sizeof header, static_cast<std::size_t>(header.bytes) - sizeof header);
    if (checksumOf(impl_->machine.runner, payload) != header.checksum)
        throw std::invalid_argument("the state is cut short or damaged");
    for (const bool apply : {false, true}) {
        StateReader reader(payload, apply);
        impl_->archive(reader);
        for (StepModule* module : impl_->moduleWork.modules) {
            std::uint64_t bytes = 0;
            const auto length = reader.take(sizeof bytes);
            if (!length.empty()) std::memcpy(&bytes, length.data(), sizeof bytes);
            const auto state = reader.take(static_cast<std::size_t>(bytes));
            if (!apply && !reader.failed()) requireFitting(*module, state);
            if (apply && bytes > 0 && module->restore) module->restore(module->user, state);
        }
        if (reader.failed() || reader.left() > 0) throw std::invalid_argument("the state is cut short or damaged");
    }
    impl_->forgetDerived();
}

/// What is derived from the state or tells of the last step, after the state has changed as a whole.
void WorldImpl::forgetDerived() {
    solving.context.h = clock.lastSubstep;
    partition.direct.grouped = false;
    tables.joints.bundlesChanged = partition.direct.treesChanged = partition.direct.multirate.any = true;
    collision.broadphase.left.rooms.clear();
    guards.energy.looseAsked.clear();  // numbers of steps that come again
    // No such field of a lane is saved.
    collision.finds.surfacesForgotten = true;
    collision.finds.dirty.clear();
    forgetTouches(tables.manifolds, collision.finds);
    tables.graph.resizeRegions(tables.graph.regionCount());
    ++tables.versions.structure;
    ++tables.versions.fixed;
    for (const ShapeRecord& shape : tables.shapes) {
        collision.finds.motionReported |= shape.reportsMotion;
        tables.shapes.noteMaterial(shape.material);
        if (!tables.shapes.meshesMove() && tables.shapes.geometries[shape.geometry].mesh &&
            tables.bodies[shape.body].type == BodyType::dynamic)
            tables.shapes.letMeshesMove();
    }
    events.forget();
    reports.profile.forget();
}

namespace {

void addJoint(StateHash& digest, const JointSim& joint) {
    digest.add(joint.block.impulseFirst);
    digest.add(joint.block.impulseSecond);
    const AxisRows& axis = joint.axis;
    for (int slot = 0; slot < kAxisSlots; ++slot) digest.add(axis.impulse(static_cast<AxisSlot>(slot)));
    const AxesBlock* axes = hasAxes(joint.kind) ? &withAxes(joint).axes : nullptr;
    for (int i = 0; i < AxesBlock::kMostRigid; ++i) digest.add(axes ? axes->impulse[i] : 0.0f);
    for (std::uint32_t f = 0; axes && f < axes->freeRows; ++f) digest.add(axisImpulse(axes->axis[f]));
    const BallRows& ball = joint.ball;
    for (const Vec3& impulse : {ball.springImpulse, ball.viscousImpulse, ball.frictionImpulse}) digest.add(impulse);
    for (const StopSide* side : {&ball.swing[0], &ball.swing[1], &ball.twistLower, &ball.twistUpper})
        digest.add(side->impulse);
}

void addManifold(StateHash& digest, const WorldImpl& world, const ManifoldRecord& manifold) {
    const ManifoldImpulses impulses =
        world.tables.manifolds.impulsesOf(manifold, world.tables.graph, world.clock.lastSubstep);
    for (int j = 0; j < manifold.pointCount; ++j) {
        digest.add(impulses.impulse[j]);
        digest.add(impulses.load[j]);
    }
    digest.add(impulses.frictionImpulse);
    digest.add(impulses.rollImpulse);
    if (manifold.place.color != kNone) digest.add(impulses.stick);
    digest.add(impulses.twistImpulse);
    if (manifold.place.color == kNone) digest.add(impulses.stick);
    digest.add(impulses.sliding);
}

}  // namespace

std::uint64_t WorldImpl::hash() const {
    StateHash digest;
    digest.add(clock.stepCount);
    digest.add(clock.time);
    for (std::uint32_t i = 1; i < tables.bodies.slots.count(); ++i) {
        if (!tables.bodies.slots.isUsed(i)) continue;
        const BodyRecord& body = tables.bodies[i];
        digest.add(tables.bodies.id(i));
        digest.add(body.center);
        digest.add(body.rotation);
        digest.add(tables.bodies.states[i].v);
        digest.add(tables.bodies.states[i].w);
        digest.add(tables.bodies.histories[i].momentum);
        digest.add(body.force);
        digest.add(body.torque);
        digest.add(body.sleepTimer);
        digest.add(body.awakeIndex != kNone);
        const bool wasMadeSo = body.type == BodyType::dynamic || (body.type == BodyType::fixed && !(body.mass > 0));
        if (!tables.bodies.isEnabled(i) || !wasMadeSo) {
            digest.add(static_cast<std::uint32_t>(tables.bodies.typeOf(i)));
            digest.add(tables.bodies.isEnabled(i));
        }
    }
    for (std::uint32_t i = 0; i < tables.contacts.slots.count(); ++i) {
        if (!tables.contacts.slots.isUsed(i)) continue;
        for (const ManifoldRecord& manifold : tables.manifolds.of(tables.contacts[i]))
            if (manifold.pointCount > 0) addManifold(digest, *this, manifold);
    }
    for (std::uint32_t j = 0; j < tables.joints.slots.count(); ++j)
        if (tables.joints.slots.isUsed(j)) addJoint(digest, tables.joints.sims[j]);
    for (std::uint32_t c = 0; c < tables.couplings.slots.count(); ++c)
        if (tables.couplings.slots.isUsed(c)) digest.add(axisImpulse(tables.couplings.sims[c].axis));
    for (const StepModule* module : moduleWork.modules)
        if (module->hash) digest.add(module->hash(module->user));
    return digest.value();
}

std::uint64_t World::hash() const { return impl_->hash(); }

}  // namespace ragtop
