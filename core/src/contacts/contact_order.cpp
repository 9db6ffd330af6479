// Contacts in the order of space. They come and go in the order in which pairs meet, so their records and lanes end up
// scattered over memory, of which a pile of many thousands has more than a cache. Now and then, when as many were made
// as there are, everything that belongs to a contact is put beside what belongs to its neighbours.

#include "contacts/contact_order.h"

#include <algorithm>
#include <utility>

namespace ragtop {

namespace {

/// The lowest ten bits, each followed by two zeros.
std::uint32_t spread(std::uint32_t v) {
    v = (v | v << 16) & 0x030000ffu;
    v = (v | v << 8) & 0x0300f00fu;
    v = (v | v << 4) & 0x030c30c3u;
    return (v | v << 2) & 0x09249249u;
}

/// Puts what was at from[place] to each place; `from` is a permutation, which this uses up.
template <class... T>
void permute(StageArray<std::uint32_t>& from, PagedArray<T>&... items) {
    for (std::uint32_t start = 0; start < from.size(); ++start) {
        if (from[start] == start) continue;
        std::uint32_t place = start;
        // Exchanges carry what was at the start along to the end of the cycle.
        while (from[place] != start) {
            const std::uint32_t next = from[place];
            (std::swap(items[place], items[next]), ...);
            from[place] = place;
            place = next;
        }
        from[place] = place;
    }
}

/// What is put in order, and the scratch of doing it.
class Reordering {
public:
    Reordering(const ContactTables& tables, StageMemory& memory) : t_(tables) {
        const std::size_t most = std::max<std::size_t>(t_.contacts.slots.count(), t_.manifolds.size());
        memory.begin(StageMemory::bytesOf<std::uint64_t>(most) + 2 * StageMemory::bytesOf<std::uint32_t>(most));
        order_ = memory.take<std::uint64_t>(most);
        from_ = memory.take<std::uint32_t>(most);
        to_ = memory.take<std::uint32_t>(most);
    }
    void run() {
        sortContactsBySpace();
        moveContacts();
        moveManifolds();
        moveLanes();
    }

private:
    void sortContactsBySpace();
    void moveContacts();
    void moveManifolds();
    void moveLanes();

    ContactTables t_;
    StageArray<std::uint64_t> order_;
    StageArray<std::uint32_t> from_, to_;  ///< of records, at each new place and of each old one
};

/// Contacts in use along a curve that fills space [Morton, 1966], ten bits per axis.
void Reordering::sortContactsBySpace() {
    const auto centerOf = [&](const ContactRecord& record) {
        return t_.bodies[t_.bodies.moves(record.bodyA) ? record.bodyA : record.bodyB].center;
    };
    DVec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
    order_.clear();
    for (std::uint32_t i = 0; i < t_.contacts.slots.count(); ++i) {
        if (!t_.contacts.slots.isUsed(i)) continue;
        const DVec3 p = centerOf(t_.contacts[i]);
        lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
        upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
        order_.push(i);
    }
    const double extent = std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z});
    const double scale = extent > 0 ? 1023 / extent : 0;
    const auto cell = [&](double way) { return spread(static_cast<std::uint32_t>(scale * way)); };
    for (std::uint64_t& entry : order_) {
        const DVec3 p = centerOf(t_.contacts[static_cast<std::size_t>(entry)]) - lower;
        entry |= std::uint64_t{cell(p.x) | cell(p.y) << 1 | cell(p.z) << 2} << 32;
    }
    std::sort(order_.begin(), order_.end());
}

/// Moves the records of contacts to the front, in their new order, and tells all that knows their numbers.
void Reordering::moveContacts() {
    const std::uint32_t count = t_.contacts.slots.count();
    from_.clear();
    to_.resizeForOverwrite(count);
    for (const std::uint64_t entry : order_) from_.push(static_cast<std::uint32_t>(entry));
    for (std::uint32_t i = 0; i < count; ++i)
        if (!t_.contacts.slots.isUsed(i)) from_.push(i);
    for (std::uint32_t i = 0; i < count; ++i) to_[from_[i]] = i;
    permute(from_, t_.contacts.records(), t_.contacts.links);
    t_.contacts.slots.compact(static_cast<std::uint32_t>(order_.size()));

    const auto follow = [&](std::uint32_t& key) {
        if (key != kNone) key = 2 * to_[key >> 1] + (key & 1);
    };
    t_.contacts.awake.clear();
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
        ContactRecord& record = t_.contacts[i];
        for (Edge& edge : t_.contacts.links[i].edges) follow(edge.previous), follow(edge.next);
        *t_.pairs.find(pairKey(record.shapeA, record.shapeB)) = i;
        if (record.awakeIndex == kNone) continue;
        record.awakeIndex = static_cast<std::uint32_t>(t_.contacts.awake.size());
        t_.contacts.awake.push(i);
    }
    for (BodyRecord& body : t_.bodies) follow(body.firstContact);
}

/// The same for manifolds, in the order of their contacts, those of meshes first and free ones last.
void Reordering::moveManifolds() {
    from_.clear();
    const auto take = [&](std::uint32_t& first, std::uint32_t count) {
        const auto place = static_cast<std::uint32_t>(from_.size());
        for (std::uint32_t k = 0; k < count; ++k) from_.push(first + k);
        first = place;
    };
    const auto takeAll = [&](std::uint32_t count) {
        for (std::uint32_t i = 0; i < order_.size(); ++i)
            if (ContactRecord& record = t_.contacts[i];
                record.manifoldCapacity == count && record.firstManifold != kNone)
                take(record.firstManifold, count);
        t_.manifolds.moveFree(count, take);
    };
    // Those that have several stay within pages.
    takeAll(kMaxManifolds);
    takeAll(1);
    to_.resizeForOverwrite(t_.manifolds.size());
    for (std::uint32_t i = 0; i < from_.size(); ++i) to_[from_[i]] = i;
    permute(from_, t_.manifolds.records());
    for (std::uint32_t i = 0; i < order_.size(); ++i)
        for (ManifoldRecord& manifold : t_.manifolds.of(t_.contacts[i])) manifold.contact = i;
    for (int c = 0; c < t_.graph.listCount(); ++c)
        for (std::uint32_t& manifold : t_.graph.color(c).manifolds) manifold = to_[manifold];
}

/// Lanes in the order of their t_.manifolds, those with equally many points together (ConstraintGraph::groupByPoints).
/// Lists that are solved serially keep theirs.
void Reordering::moveLanes() {
    for (int c = 0; c < t_.graph.listCount(); ++c) {
        if (ConstraintGraph::isSerial(c) || !ConstraintGraph::isIterated(c)) continue;
        const AlignedArray<std::uint32_t>& list = t_.graph.color(c).manifolds;
        order_.clear();
        for (std::uint32_t slot = 0; slot < list.size(); ++slot) {
            const auto missing = static_cast<std::uint64_t>(kMaxManifoldPoints - t_.manifolds[list[slot]].pointCount);
            order_.push(missing << 61 | std::uint64_t{list[slot]} << 32 | slot);
        }
        std::sort(order_.begin(), order_.end());
        from_.clear();
        for (const std::uint64_t entry : order_) from_.push(static_cast<std::uint32_t>(entry));
        t_.graph.reorderContacts(c, from_);
        for (std::uint32_t slot = 0; slot < list.size(); ++slot) t_.manifolds[list[slot]].place.slot = slot;
    }
}

}  // namespace

bool orderContacts(const ContactTables& tables, StageMemory& memory) {
    constexpr std::uint32_t kFew = 4096;  // whose memory is near anyway
    if (tables.contacts.made < kFew || tables.contacts.made < tables.contacts.slots.used()) return false;
    tables.contacts.made = 0;
    Reordering(tables, memory).run();
    return true;
}

}  // namespace ragtop
