#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "base/checksum.h"
#include "base/hash.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

struct StateHeader {
    char magic[8] = {'R', 'A', 'G', 'T', 'O', 'P', 'S', '1'};
    std::uint32_t lanes = 0, geometries = 0, modules = 0;
    std::uint32_t layout = sizeof(BodyRecord) + 7 * sizeof(ContactRecord) + 31 * sizeof(ManifoldRecord) +
                           127 * sizeof(JointSim) + 8191 * sizeof(ShapeRecord);
    std::uint64_t shapes = 0;    ///< digest of the geometries, which are not saved
    std::uint64_t bytes = 0;     ///< of header and payload
    std::uint64_t checksum = 0;  ///< of the payload
};

/// What outlives a step of a bundle's fields: the impulses. All else is written anew before it is read.
struct Strip {
    int field, count;
};
constexpr int impulseField(int point) { return contact::kPoints + point * contact::kPointFields + contact::kImpulse; }
constexpr int loadField(int point) { return contact::kPoints + point * contact::kPointFields + contact::kLoad; }
constexpr Strip kStrips[] = {
    {contact::kFrictionImpulse, 3}, {contact::kTwistImpulse, 1}, {contact::kRollImpulse, 3},
    {impulseField(0), 1}, {impulseField(1), 1}, {impulseField(2), 1}, {impulseField(3), 1},
    {loadField(0), 1},    {loadField(1), 1},    {loadField(2), 1},    {loadField(3), 1},
};
static_assert(contact::kMaxPoints == 4);
constexpr int kFieldsSaved = 15;

/// Calls visit(first float, number of floats) for what is saved of a bundle.
template <class Visit>
void forEachStrip(float* bundle, int lanes, Visit&& visit) {
    for (const Strip& strip : kStrips)
        visit(bundle + static_cast<std::size_t>(strip.field * lanes), static_cast<std::size_t>(strip.count * lanes));
}
float* bundleOf(ConstraintGraph& graph, int color, int index) {
    return graph.color(color).bundles.data() + static_cast<std::size_t>(index) * contact::kFields *
                                                   static_cast<std::size_t>(graph.lanes());
}
std::size_t bundleBytes(const ConstraintGraph& graph) {
    return kFieldsSaved * sizeof(float) * static_cast<std::size_t>(graph.lanes());
}

/// Makes the bundles of a colour as many as its contacts need, lanes without a contact zero.
void fitBundles(ConstraintGraph& graph, int color) {
    const int lanes = graph.lanes(), bundles = graph.bundleCount(color);
    ConstraintGraph::Color& c = graph.color(color);
    c.bundles.resize(static_cast<std::size_t>(bundles) * contact::kFields * static_cast<std::size_t>(lanes), 0.0f);
    for (int i = 0; i < bundles; ++i) {
        const int used = color == ConstraintGraph::kOverflow ? 1 : static_cast<int>(c.manifolds.size()) - i * lanes;
        float* bundle = bundleOf(graph, color, i);
        for (int lane = used; lane < lanes; ++lane)
            for (int field = 0; field < contact::kFields; ++field) bundle[field * lanes + lane] = 0.0f;
    }
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

class Counter {
public:
    std::size_t bytes = 0;
    template <class T>
    void operator()(AlignedArray<T>& array) { bytes += sizeof(std::uint64_t) + array.size() * sizeof(T); }
    template <class T>
    void value(T&) { bytes += sizeof(T); }
    void tree(BoundsTree& tree) { bytes += sizeof(BoundsTree::Header) + 8 + tree.nodes().size() * sizeof(BoundsTree::Node); }
    void pairs(PairSet& pairs) { bytes += 8 + pairs.entries().size() * sizeof(PairSet::Entry); }
    void events(std::pmr::vector<ContactEvent>& events) { bytes += 8 + events.size() * sizeof(ContactEvent); }
    void bundles(ConstraintGraph& graph, int color) {
        bytes += 8 + static_cast<std::size_t>(graph.bundleCount(color)) * bundleBytes(graph);
    }
};

class Writer {
public:
    explicit Writer(std::byte* to) : to_(to) {}
    void raw(const void* from, std::size_t size) {
        if (size > 0) std::memcpy(to_, from, size);
        to_ += size;
    }
    template <class T>
    void value(T& v) {
        static_assert(std::is_trivially_copyable_v<T>);
        raw(&v, sizeof v);
    }
    template <class T>
    void operator()(AlignedArray<T>& array) { list(array.data(), array.size()); }
    void tree(BoundsTree& tree) {
        BoundsTree::Header header = tree.header();
        value(header);
        list(tree.nodes().data(), tree.nodes().size());
    }
    void pairs(PairSet& pairs) { list(pairs.entries().data(), pairs.entries().size()); }
    void events(std::pmr::vector<ContactEvent>& events) { list(events.data(), events.size()); }
    void bundles(ConstraintGraph& graph, int color) {
        std::uint64_t count = static_cast<std::uint64_t>(graph.bundleCount(color));
        value(count);
        for (int i = 0; i < graph.bundleCount(color); ++i)
            forEachStrip(bundleOf(graph, color, i), graph.lanes(),
                         [&](const float* from, std::size_t floats) { raw(from, floats * sizeof(float)); });
    }
    std::byte* end() const { return to_; }

private:
    template <class T>
    void list(const T* data, std::size_t size) {
        std::uint64_t count = size;
        value(count);
        raw(data, size * sizeof(T));
    }
    std::byte* to_;
};

/// Reads a state; `apply` false only checks that every length fits.
class Reader {
public:
    Reader(std::span<const std::byte> from, bool apply) : from_(from), apply_(apply) {}
    bool failed() const { return failed_; }
    bool apply() const { return apply_; }
    std::size_t left() const { return from_.size(); }
    std::span<const std::byte> take(std::size_t size) {
        if (failed_ || size > from_.size()) {
            failed_ = true;
            return {};
        }
        const auto taken = from_.first(size);
        from_ = from_.subspan(size);
        return taken;
    }
    template <class T>
    void value(T& v) {
        const auto bytes = take(sizeof(T));
        if (apply_ && !failed_) std::memcpy(static_cast<void*>(&v), bytes.data(), sizeof(T));
    }
    template <class T>
    void operator()(AlignedArray<T>& array) {
        const auto bytes = list(sizeof(T));
        if (!apply_ || failed_) return;
        array.resizeForOverwrite(bytes.size() / sizeof(T));
        if (!bytes.empty()) std::memcpy(static_cast<void*>(array.data()), bytes.data(), bytes.size());
    }
    void tree(BoundsTree& tree) {
        BoundsTree::Header header;
        const auto bytes = take(sizeof header);
        if (!failed_) std::memcpy(&header, bytes.data(), sizeof header);
        const auto nodes = list(sizeof(BoundsTree::Node));
        if (!apply_ || failed_) return;
        tree.restore(header, nodes.data(), nodes.size() / sizeof(BoundsTree::Node));
    }
    void pairs(PairSet& pairs) {
        const auto entries = list(sizeof(PairSet::Entry));
        if (!apply_ || failed_) return;
        pairs.restore(entries.data(), entries.size() / sizeof(PairSet::Entry));
    }
    void events(std::pmr::vector<ContactEvent>& events) {
        const auto bytes = list(sizeof(ContactEvent));
        if (!apply_ || failed_) return;
        events.resize(bytes.size() / sizeof(ContactEvent));
        if (!bytes.empty()) std::memcpy(static_cast<void*>(events.data()), bytes.data(), bytes.size());
    }
    void bundles(ConstraintGraph& graph, int color) {
        const auto bytes = list(bundleBytes(graph));
        if (!apply_ || failed_) return;
        fitBundles(graph, color);
        const std::byte* from = bytes.data();
        for (int i = 0; i < graph.bundleCount(color); ++i)
            forEachStrip(bundleOf(graph, color, i), graph.lanes(), [&](float* to, std::size_t floats) {
                std::memcpy(to, from, floats * sizeof(float));
                from += floats * sizeof(float);
            });
    }

private:
    std::span<const std::byte> list(std::size_t elementSize) {
        std::uint64_t count = 0;
        const auto bytes = take(sizeof count);
        if (failed_) return {};
        std::memcpy(&count, bytes.data(), sizeof count);
        if (count > from_.size() / elementSize) {
            failed_ = true;
            return {};
        }
        return take(static_cast<std::size_t>(count) * elementSize);
    }
    std::span<const std::byte> from_;
    bool apply_ = false;
    bool failed_ = false;
};

}  // namespace

/// Everything that a step reads and that outlives it, in one place for counting, saving and restoring.
template <class Archive>
void WorldImpl::archive(Archive& archive) {
    bodySlots.archive(archive);
    shapeSlots.archive(archive);
    contactSlots.archive(archive);
    jointSlots.archive(archive);
    archive(bodies);
    archive(states);
    archive(inertias);
    archive(dynamics);
    archive(histories);
    archive(shapes);
    archive(contacts);
    archive(manifolds);
    archive(freeManifolds);
    archive(freeMeshManifolds);
    archive(joints);
    archive(jointSims);
    archive(awakeBodies);
    archive(awakeContacts);
    archive(moveBuffer);
    for (int c = 0; c <= ConstraintGraph::kOverflow; ++c) {
        ConstraintGraph::Color& color = graph.color(c);
        archive(color.manifolds);
        archive(color.joints);
        archive(color.bodies);
        archive.bundles(graph, c);
    }
    archive.tree(staticTree);
    archive.tree(movingTree);
    archive.pairs(pairs);
    archive.events(endsBetweenSteps);
    archive.events(sensorEndsBetweenSteps);
    archive.value(settings);
    archive.value(stepCount);
    archive.value(time);
    archive.value(lastSubstep);
    archive.value(dt);
}

namespace {

/// What a state saved now would say of its world, which may have got more geometries since.
StateHeader headerOf(const WorldImpl& world, std::size_t geometries) {
    StateHeader header;
    header.lanes = static_cast<std::uint32_t>(world.graph.lanes());
    header.geometries = static_cast<std::uint32_t>(geometries);
    header.modules = static_cast<std::uint32_t>(world.modules.size());
    header.shapes = digestOf(world.geometries, geometries);
    return header;
}

}  // namespace

std::size_t World::saveSize() const {
    Counter counter;
    impl_->archive(counter);
    for (const StepModule* module : impl_->modules)
        counter.bytes += sizeof(std::uint64_t) + (module->saveSize ? module->saveSize(module->user) : 0);
    return sizeof(StateHeader) + counter.bytes;
}

std::size_t World::save(std::span<std::byte> into) const {
    const std::size_t size = saveSize();
    if (into.size() < size)
        throw std::length_error("saving needs " + std::to_string(size) + " bytes, the memory has " +
                                std::to_string(into.size()));
    StateHeader header = headerOf(*impl_, impl_->geometries.size());
    header.bytes = size;
    Writer writer(into.data() + sizeof header);
    impl_->archive(writer);
    for (const StepModule* module : impl_->modules) {
        std::uint64_t bytes = module->saveSize ? module->saveSize(module->user) : 0;
        writer.value(bytes);
        if (bytes > 0 && module->save) module->save(module->user, {writer.end(), static_cast<std::size_t>(bytes)});
        writer = Writer(writer.end() + bytes);
    }
    header.checksum = checksum(into.first(size).subspan(sizeof header));
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

}  // namespace

void World::restore(std::span<const std::byte> from) {
    StateHeader header;
    if (from.size() < sizeof header) throw std::invalid_argument("the bytes are no state: too few");
    std::memcpy(&header, from.data(), sizeof header);
    // Shapes that came after the state was saved do no harm.
    const std::size_t known = impl_->geometries.size();
    const StateHeader own = headerOf(*impl_, header.geometries < known ? header.geometries : known);
    if (const std::string why = whyForeign(header, own, from.size()); !why.empty()) throw std::invalid_argument(why);
    const auto payload = from.subspan(sizeof header, static_cast<std::size_t>(header.bytes) - sizeof header);
    if (checksum(payload) != header.checksum) throw std::invalid_argument("the state is cut short or damaged");
    for (const bool apply : {false, true}) {
        Reader reader(payload, apply);
        impl_->archive(reader);
        for (StepModule* module : impl_->modules) {
            std::uint64_t bytes = 0;
            const auto length = reader.take(sizeof bytes);
            if (!length.empty()) std::memcpy(&bytes, length.data(), sizeof bytes);
            const auto state = reader.take(static_cast<std::size_t>(bytes));
            if (!apply && !reader.failed() && bytes != (module->saveSize ? module->saveSize(module->user) : 0))
                throw std::invalid_argument(std::string("the state of module '") + module->name + "' has another size");
            if (apply && bytes > 0 && module->restore) module->restore(module->user, state);
        }
        if (reader.failed() || reader.left() > 0) throw std::invalid_argument("the state is cut short or damaged");
    }
    impl_->forgetDerived();
}

/// What is derived from the state or tells of the last step, after the state has changed as a whole.
void WorldImpl::forgetDerived() {
    context.h = lastSubstep;
    ++structureVersion;
    begins.clear();
    ends.clear();
    sensorBegins.clear();
    sensorEnds.clear();
    surfaceEvents.clear();
    sleepEvents.clear();
    stages.clear();
}

namespace {

void addJoint(StateHash& digest, const JointSim& joint) {
    digest.add(joint.block.impulseFirst);
    digest.add(joint.block.impulseSecond);
    const AxisRows& axis = joint.axis;
    for (const float impulse : {axis.springImpulse, axis.frictionImpulse, axis.motorImpulse, axis.lowerImpulse,
                                axis.upperImpulse})
        digest.add(impulse);
    const BallRows& ball = joint.ball;
    digest.add(ball.springImpulse);
    digest.add(ball.frictionImpulse);
    for (const float impulse : {ball.swingImpulse, ball.twistLowerImpulse, ball.twistUpperImpulse}) digest.add(impulse);
}

/// Impulses of a manifold, which are in its lane while it is in the graph.
void addManifold(StateHash& digest, const ConstraintGraph& graph, const ManifoldRecord& manifold) {
    if (manifold.place.color == kNone) {
        for (int j = 0; j < manifold.pointCount; ++j) {
            digest.add(manifold.impulse[j]);
            digest.add(manifold.load[j]);
        }
        digest.add(manifold.frictionImpulse);
        digest.add(manifold.rollImpulse);
        digest.add(manifold.twistImpulse);
        return;
    }
    const float* lane = graph.lane(manifold.place);
    const auto at = [&](int field) { return lane[static_cast<std::size_t>(field * graph.lanes())]; };
    for (int j = 0; j < manifold.pointCount; ++j) {
        digest.add(at(contact::kPoints + j * contact::kPointFields + contact::kImpulse));
        digest.add(at(contact::kPoints + j * contact::kPointFields + contact::kLoad));
    }
    for (const int field : {contact::kFrictionImpulse, contact::kRollImpulse})
        digest.add(Vec3{at(field), at(field + 1), at(field + 2)});
    digest.add(at(contact::kTwistImpulse));
}

}  // namespace

std::uint64_t WorldImpl::hash() const {
    StateHash digest;
    digest.add(stepCount);
    digest.add(time);
    for (std::uint32_t i = 1; i < bodySlots.count(); ++i) {
        if (!bodySlots.isUsed(i)) continue;
        const BodyRecord& body = bodies[i];
        digest.add(id(i));
        digest.add(body.center);
        digest.add(body.rotation);
        digest.add(states[i].v);
        digest.add(states[i].w);
        digest.add(body.force);
        digest.add(body.torque);
        digest.add(body.sleepTimer);
        digest.add(body.awakeIndex != kNone);
    }
    for (std::uint32_t i = 0; i < contactSlots.count(); ++i) {
        if (!contactSlots.isUsed(i)) continue;
        for (std::uint32_t k = 0; k < contacts[i].manifoldCapacity; ++k)
            if (const ManifoldRecord& manifold = manifolds[contacts[i].firstManifold + k]; manifold.pointCount > 0)
                addManifold(digest, graph, manifold);
    }
    for (std::uint32_t j = 0; j < jointSlots.count(); ++j)
        if (jointSlots.isUsed(j)) addJoint(digest, jointSims[j]);
    for (const StepModule* module : modules)
        if (module->hash) digest.add(module->hash(module->user));
    return digest.value();
}

std::uint64_t World::hash() const { return impl_->hash(); }

}  // namespace ragtop
