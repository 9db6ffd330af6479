#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "base/hash.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

struct StateHeader {
    char magic[8] = {'R', 'A', 'G', 'T', 'O', 'P', 'S', '1'};
    std::uint32_t lanes = 0, geometries = 0, modules = 0;
    std::uint32_t layout = sizeof(BodyRecord) + 7 * sizeof(ContactRecord) + 31 * sizeof(ManifoldRecord) +
                           127 * sizeof(JointSim) + 8191 * sizeof(ShapeRecord);
    std::uint64_t bytes = 0;
};

class Counter {
public:
    std::size_t bytes = 0;
    template <class T>
    void operator()(AlignedArray<T>& array) { bytes += sizeof(std::uint64_t) + array.size() * sizeof(T); }
    void raw(const void*, std::size_t size) { bytes += size; }
    template <class T>
    void value(T&) { bytes += sizeof(T); }
    void tree(BoundsTree& tree) { bytes += sizeof(BoundsTree::Header) + 8 + tree.nodes().size() * sizeof(BoundsTree::Node); }
    void pairs(PairSet& pairs) { bytes += 8 + pairs.entries().size() * sizeof(PairSet::Entry); }
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
    graph.archive(archive);
    archive.tree(staticTree);
    archive.tree(movingTree);
    archive.pairs(pairs);
    archive.value(settings);
    archive.value(stepCount);
    archive.value(structureVersion);
    archive.value(time);
    archive.value(lastSubstep);
    archive.value(dt);
}

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
    StateHeader header;
    header.lanes = static_cast<std::uint32_t>(impl_->graph.lanes());
    header.geometries = static_cast<std::uint32_t>(impl_->geometries.size());
    header.modules = static_cast<std::uint32_t>(impl_->modules.size());
    header.bytes = size;
    Writer writer(into.data());
    writer.value(header);
    impl_->archive(writer);
    for (const StepModule* module : impl_->modules) {
        std::uint64_t bytes = module->saveSize ? module->saveSize(module->user) : 0;
        writer.value(bytes);
        if (bytes > 0) module->save(module->user, {writer.end(), static_cast<std::size_t>(bytes)});
        writer = Writer(writer.end() + bytes);
    }
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
    if (header.geometries > own.geometries || header.modules != own.modules)
        return "the state is of a world with " + std::to_string(header.geometries) + " geometries and " +
               std::to_string(header.modules) + " modules, this one has " + std::to_string(own.geometries) + " and " +
               std::to_string(own.modules);
    return {};
}

}  // namespace

void World::restore(std::span<const std::byte> from) {
    StateHeader header, own;
    own.lanes = static_cast<std::uint32_t>(impl_->graph.lanes());
    own.geometries = static_cast<std::uint32_t>(impl_->geometries.size());
    own.modules = static_cast<std::uint32_t>(impl_->modules.size());
    if (from.size() < sizeof header) throw std::invalid_argument("the bytes are no state: too few");
    std::memcpy(&header, from.data(), sizeof header);
    if (const std::string why = whyForeign(header, own, from.size()); !why.empty()) throw std::invalid_argument(why);
    const auto payload = from.subspan(sizeof header, static_cast<std::size_t>(header.bytes) - sizeof header);
    for (const bool apply : {false, true}) {
        Reader reader(payload, apply);
        impl_->archive(reader);
        for (StepModule* module : impl_->modules) {
            std::uint64_t bytes = 0;
            const auto length = reader.take(sizeof bytes);
            if (!length.empty()) std::memcpy(&bytes, length.data(), sizeof bytes);
            const auto state = reader.take(static_cast<std::size_t>(bytes));
            if (!apply && module->saveSize && !reader.failed() && bytes != module->saveSize(module->user))
                throw std::invalid_argument(std::string("the state of module '") + module->name + "' has another size");
            if (apply && bytes > 0 && module->restore) module->restore(module->user, state);
        }
        if (reader.failed()) throw std::invalid_argument("the state is cut short or damaged");
    }
    impl_->endsBetweenSteps.clear();
    impl_->sensorEndsBetweenSteps.clear();
}

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
        digest.add(body.sleepTimer);
        digest.add(body.awakeIndex != kNone);
    }
    for (std::uint32_t i = 0; i < contactSlots.count(); ++i) {
        if (!contactSlots.isUsed(i)) continue;
        for (std::uint32_t k = 0; k < contacts[i].manifoldCapacity; ++k) {
            const ManifoldRecord& manifold = manifolds[contacts[i].firstManifold + k];
            const Contact contact = describe(contacts[i], manifold);
            for (int j = 0; j < contact.pointCount; ++j) digest.add(contact.points[j].impulse);
            digest.add(contact.frictionForce);
        }
    }
    for (const StepModule* module : modules)
        if (module->hash) digest.add(module->hash(module->user));
    return digest.value();
}

std::uint64_t World::hash() const { return impl_->hash(); }

}  // namespace ragtop
