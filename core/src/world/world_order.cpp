// Contacts in the order of space. They come and go in the order in which pairs meet, so their records and lanes end up
// scattered over memory, of which a pile of many thousands has more than a cache. Now and then, when as many were made as
// there are, everything that belongs to a contact is put beside what belongs to its neighbours.

#include <algorithm>

#include "world/world_impl.h"

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

}  // namespace

/// Contacts in use along a curve that fills space [Morton, 1966], ten bits per axis.
void WorldImpl::sortContactsBySpace() {
    const auto centerOf = [&](const ContactRecord& record) {
        return bodies[moves(record.bodyA) ? record.bodyA : record.bodyB].center;
    };
    DVec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
    contactOrder.clear();
    for (std::uint32_t i = 0; i < contactSlots.count(); ++i) {
        if (!contactSlots.isUsed(i)) continue;
        const DVec3 p = centerOf(contacts[i]);
        lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
        upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
        contactOrder.push(i);
    }
    const double extent = std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z});
    const double scale = extent > 0 ? 1023 / extent : 0;
    const auto cell = [&](double way) { return spread(static_cast<std::uint32_t>(scale * way)); };
    for (std::uint64_t& entry : contactOrder) {
        const DVec3 p = centerOf(contacts[static_cast<std::size_t>(entry)]) - lower;
        entry |= std::uint64_t{cell(p.x) | cell(p.y) << 1 | cell(p.z) << 2} << 32;
    }
    std::sort(contactOrder.begin(), contactOrder.end());
}

/// Moves the records of contacts to the front, in their new order, and tells all that knows their numbers.
void WorldImpl::moveContacts() {
    const std::uint32_t count = contactSlots.count();
    movedFrom.clear();
    movedTo.resizeForOverwrite(count);
    for (const std::uint64_t entry : contactOrder) movedFrom.push(static_cast<std::uint32_t>(entry));
    for (std::uint32_t i = 0; i < count; ++i)
        if (!contactSlots.isUsed(i)) movedFrom.push(i);
    for (std::uint32_t i = 0; i < count; ++i) movedTo[movedFrom[i]] = i;
    permute(movedFrom, contacts, contactLinks);
    contactSlots.compact(static_cast<std::uint32_t>(contactOrder.size()));

    const auto follow = [&](std::uint32_t& key) {
        if (key != kNone) key = 2 * movedTo[key >> 1] + (key & 1);
    };
    awakeContacts.clear();
    for (std::uint32_t i = 0; i < contactOrder.size(); ++i) {
        ContactRecord& record = contacts[i];
        for (Edge& edge : contactLinks[i].edges) follow(edge.previous), follow(edge.next);
        *pairs.find(pairKey(record.shapeA, record.shapeB)) = i;
        if (record.awakeIndex == kNone) continue;
        record.awakeIndex = static_cast<std::uint32_t>(awakeContacts.size());
        awakeContacts.push(i);
    }
    for (BodyRecord& body : bodies) follow(body.firstContact);
}

/// The same for manifolds, in the order of their contacts, those of meshes first and free ones last.
void WorldImpl::moveManifolds() {
    movedFrom.clear();
    const auto take = [&](std::uint32_t& first, std::uint32_t count) {
        const auto place = static_cast<std::uint32_t>(movedFrom.size());
        for (std::uint32_t k = 0; k < count; ++k) movedFrom.push(first + k);
        first = place;
    };
    const auto takeAll = [&](std::uint32_t count, AlignedArray<std::uint32_t>& free) {
        for (std::uint32_t i = 0; i < contactOrder.size(); ++i)
            if (ContactRecord& record = contacts[i]; record.manifoldCapacity == count && record.firstManifold != kNone)
                take(record.firstManifold, count);
        for (std::uint32_t& first : free) take(first, count);
    };
    // Those that have several stay within pages.
    takeAll(kMaxManifolds, freeMeshManifolds);
    takeAll(1, freeManifolds);
    movedTo.resizeForOverwrite(manifolds.size());
    for (std::uint32_t i = 0; i < movedFrom.size(); ++i) movedTo[movedFrom[i]] = i;
    permute(movedFrom, manifolds);
    for (std::uint32_t i = 0; i < contactOrder.size(); ++i)
        for (ManifoldRecord& manifold : manifoldsOf(contacts[i])) manifold.contact = i;
    for (int c = 0; c < graph.listCount(); ++c)
        for (std::uint32_t& manifold : graph.color(c).manifolds) manifold = movedTo[manifold];
    forgetTouches();
}

/// Lanes in the order of their manifolds, those with equally many points together (ConstraintGraph::groupByPoints). Lists
/// that are solved serially keep theirs.
void WorldImpl::moveLanes() {
    for (int c = 0; c < graph.listCount(); ++c) {
        if (ConstraintGraph::isSerial(c) || !ConstraintGraph::isIterated(c)) continue;
        const AlignedArray<std::uint32_t>& list = graph.color(c).manifolds;
        contactOrder.clear();
        for (std::uint32_t slot = 0; slot < list.size(); ++slot) {
            const auto missing = static_cast<std::uint64_t>(kMaxManifoldPoints - manifolds[list[slot]].pointCount);
            contactOrder.push(missing << 61 | std::uint64_t{list[slot]} << 32 | slot);
        }
        std::sort(contactOrder.begin(), contactOrder.end());
        movedFrom.clear();
        for (const std::uint64_t entry : contactOrder) movedFrom.push(static_cast<std::uint32_t>(entry));
        graph.reorderContacts(c, movedFrom);
        for (std::uint32_t slot = 0; slot < list.size(); ++slot) manifolds[list[slot]].place.slot = slot;
    }
}

void WorldImpl::orderContacts() {
    constexpr std::uint32_t kFew = 4096;  // whose memory is near anyway
    if (contactsMade < kFew || contactsMade < contactSlots.used()) return;
    contactsMade = 0;
    const std::size_t most = std::max<std::size_t>(contactSlots.count(), manifolds.size());
    stageMemory.begin(StageMemory::bytesOf<std::uint64_t>(most) + 2 * StageMemory::bytesOf<std::uint32_t>(most));
    contactOrder = stageMemory.take<std::uint64_t>(most);
    movedFrom = stageMemory.take<std::uint32_t>(most);
    movedTo = stageMemory.take<std::uint32_t>(most);
    sortContactsBySpace();
    moveContacts();
    moveManifolds();
    moveLanes();
    directGrouped = false;
}

}  // namespace ragtop
