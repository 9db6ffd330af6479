#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <span>
#include <type_traits>
#include <vector>

#include "base/aligned_array.h"
#include "base/paged_array.h"
#include "base/pair_set.h"
#include "broadphase/bounds_tree.h"
#include "constraints/constraint_graph.h"
#include "ragtop/events.h"

/// Visitors of a world's state: one counts its bytes, one writes, one reads them.
namespace ragtop {

/// What outlives a step of a bundle's fields: the impulses, and what is written when a contact gets its lane. All else
/// is written anew in each step before it is read.
struct Strip {
    int field, count;
};
constexpr int impulseField(int point) { return contact::kPoints + point * contact::kPointFields + contact::kImpulse; }
constexpr int loadField(int point) { return contact::kPoints + point * contact::kPointFields + contact::kLoad; }
inline constexpr Strip kStrips[] = {
    {contact::kBodyA, 1},        {contact::kBodyB, 1},       {contact::kRecordA, 1},
    {contact::kRecordB, 1},      {contact::kSize, 1},        {contact::kFrictionImpulse, 3},
    {contact::kTwistImpulse, 1}, {contact::kRollImpulse, 3}, {contact::kSliding, 1},
    {contact::kStick, 3},        {impulseField(0), 1},       {impulseField(1), 1},
    {impulseField(2), 1},        {impulseField(3), 1},       {loadField(0), 1},
    {loadField(1), 1},           {loadField(2), 1},          {loadField(3), 1},
    {contact::kShifted, 1},      {contact::kStruck, 1},
};
static_assert(contact::kMaxPoints == 4);
inline constexpr int kFieldsSaved = 26;  ///< the sum of kStrips' counts

/// Calls visit(first float, number of floats) for what is saved of a bundle.
template <class Visit>
void forEachStrip(float* bundle, int lanes, Visit&& visit) {
    for (const Strip& strip : kStrips)
        visit(bundle + static_cast<std::size_t>(strip.field * lanes), static_cast<std::size_t>(strip.count * lanes));
}
inline float* bundleOf(ConstraintGraph& graph, int color, int index) {
    return graph.color(color).bundles.data() +
           static_cast<std::size_t>(index) * contact::kFields * static_cast<std::size_t>(graph.lanes());
}
inline std::size_t bundleBytes(const ConstraintGraph& graph) {
    return kFieldsSaved * sizeof(float) * static_cast<std::size_t>(graph.lanes());
}

/// Makes the bundles of a colour as many as its contacts need, lanes without a contact zero.
inline void fitBundles(ConstraintGraph& graph, int color) {
    const int lanes = graph.lanes(), bundles = graph.bundleCount(color);
    ConstraintGraph::Color& c = graph.color(color);
    c.bundles.resize(static_cast<std::size_t>(bundles) * contact::kFields * static_cast<std::size_t>(lanes), 0.0f);
    for (int i = 0; i < bundles; ++i) {
        const int used = ConstraintGraph::isSerial(color) ? 1 : static_cast<int>(c.manifolds.size()) - i * lanes;
        float* bundle = bundleOf(graph, color, i);
        for (int lane = used; lane < lanes; ++lane)
            for (int field = 0; field < contact::kFields; ++field) bundle[field * lanes + lane] = 0.0f;
    }
}

class StateCounter {
public:
    std::size_t bytes = 0;
    template <class T>
    void operator()(AlignedArray<T>& array) {
        bytes += sizeof(std::uint64_t) + array.size() * sizeof(T);
    }
    template <class T>
    void operator()(PagedArray<T>& array) {
        bytes += sizeof(std::uint64_t) + array.size() * sizeof(T);
    }
    template <class T>
    void value(T&) {
        bytes += sizeof(T);
    }
    void tree(BoundsTree& tree) {
        bytes += sizeof(BoundsTree::Header) + 8 + tree.nodes().size() * sizeof(BoundsTree::Node);
    }
    void pairs(PairSet& pairs) { bytes += 8 + pairs.entries().size() * sizeof(PairSet::Entry); }
    void events(std::pmr::vector<ContactEvent>& events) { bytes += 8 + events.size() * sizeof(ContactEvent); }
    int lists(ConstraintGraph& graph) {
        bytes += sizeof(int);
        return graph.listCount();
    }
    void bundles(ConstraintGraph& graph, int color) {
        bytes += 8 + static_cast<std::size_t>(graph.bundleCount(color)) * bundleBytes(graph);
    }
};

class StateWriter {
public:
    explicit StateWriter(std::byte* to) : to_(to) {}
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
    void operator()(AlignedArray<T>& array) {
        list(array.data(), array.size());
    }
    template <class T>
    void operator()(PagedArray<T>& array) {
        std::uint64_t count = array.size();
        value(count);
        array.forEachPart([&](const void* part, std::size_t bytes) { raw(part, bytes); });
    }
    void tree(BoundsTree& tree) {
        BoundsTree::Header header = tree.header();
        value(header);
        list(tree.nodes().data(), tree.nodes().size());
    }
    void pairs(PairSet& pairs) { list(pairs.entries().data(), pairs.entries().size()); }
    void events(std::pmr::vector<ContactEvent>& events) { list(events.data(), events.size()); }
    int lists(ConstraintGraph& graph) {
        int regions = graph.regionCount();
        value(regions);
        return graph.listCount();
    }
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
class StateReader {
public:
    StateReader(std::span<const std::byte> from, bool apply) : from_(from), apply_(apply) {}
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
    template <class T>
    void operator()(PagedArray<T>& array) {
        const auto bytes = list(sizeof(T));
        if (apply_ && !failed_) array.restore(bytes.data(), bytes.size() / sizeof(T));
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
    /// As many as the state has, which the graph gets.
    int lists(ConstraintGraph& graph) {
        int regions = 0;
        const auto bytes = take(sizeof regions);
        if (!failed_) std::memcpy(&regions, bytes.data(), sizeof regions);
        failed_ |= regions < 0 || regions > ConstraintGraph::kMostRegions;
        if (failed_) return 0;
        if (apply_) graph.resizeRegions(regions);
        return ConstraintGraph::firstList(regions + 1);
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

}  // namespace ragtop
