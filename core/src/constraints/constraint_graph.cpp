#include "constraints/constraint_graph.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include "base/prefetch.h"

namespace ragtop {

constexpr std::size_t kFewContacts = 64;  ///< room that a list begins with

/// How many a list grows by at least: by its own size while it is small, and by a share of it where the rest would
/// count.
static std::size_t growthOf(const ConstraintGraph::Color& c) {
    constexpr std::size_t kLargeGrowth = 64;  // shares of its own size
    return c.bundles.isLarge() ? c.manifolds.size() / kLargeGrowth : c.manifolds.size();
}

ConstraintGraph::ConstraintGraph(int lanes, std::pmr::memory_resource* memory)
    : lanes_(lanes), memory_(memory), bodies_(memory) {
    assert(std::has_single_bit(static_cast<unsigned>(lanes)));
    laneBits_ = std::countr_zero(static_cast<unsigned>(lanes));
    colors_.reserve(kLists);
    for (int i = 0; i < kLists; ++i) colors_.emplace_back(memory);
    used_.assign(1, 0);
}

void ConstraintGraph::resizeRegions(int regions) {
    const auto lists = static_cast<std::size_t>(firstList(regions + 1));
    colors_.reserve(lists);
    while (colors_.size() < lists) colors_.emplace_back(memory_);
    while (colors_.size() > lists) colors_.pop_back();
    used_.resize(static_cast<std::size_t>(regions) + 1, 0);
    for (int list = 0; list < listCount(); ++list) noteUse(list);
}

void ConstraintGraph::noteUse(int list) {
    const int region = list < kLists ? 0 : 1 + (list - kLists) / kRegionLists;
    const std::uint32_t bit = 1u << (list - firstList(region));
    std::uint32_t& used = used_[static_cast<std::size_t>(region)];
    used = color(list).empty() ? used & ~bit : used | bit;
}

ConstraintGraph::BodyPlace& ConstraintGraph::bodyPlace(std::uint32_t body) {
    if (body >= bodies_.size()) bodies_.resize(body + 1, {});
    return bodies_[body];
}

/// The list of their region, if they have one, and of the first colour that neither body has yet. What fits nowhere is in
/// no region: its order is that in which it came.
int ConstraintGraph::findPlace(std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB) {
    constexpr std::uint32_t kBoth = (1u << kFirstStaticColor) - 1, kOne = ((1u << kColors) - 1) & ~kBoth;  // colours
    bodyPlace(std::max(bodyA, bodyB));
    BodyPlace &a = bodyPlace(bodyA), &b = bodyPlace(bodyB);
    const std::uint32_t taken = (movesA ? a.colors : 0) | (movesB ? b.colors : 0);
    const std::uint32_t free = ~taken & (movesA && movesB ? kBoth : kOne);
    if (free == 0) return kOverflow;
    const std::uint32_t bit = free & (0u - free);
    if (movesA) a.colors |= bit;
    if (movesB) b.colors |= bit;
    const bool together = !movesA || !movesB || a.region == b.region;
    return firstList(static_cast<int>(together ? (movesA ? a : b).region : 0)) + std::countr_zero(bit);
}

void ConstraintGraph::clearBits(int index, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB) {
    if (isSerial(index) || !isIterated(index)) return;
    const std::uint32_t bit = 1u << colorOf(index);
    if (movesA) bodies_[bodyA].colors &= ~bit;
    if (movesB) bodies_[bodyB].colors &= ~bit;
}

int ConstraintGraph::bundleCount(int index) const {
    const std::size_t count = color(index).manifolds.size();
    const auto n = static_cast<std::size_t>(lanes_);
    return static_cast<int>(isSerial(index) ? count : (count + n - 1) / n);
}

int ConstraintGraph::usedColors() const {
    std::uint32_t used = 0;
    forUsedLists([&](int list) { used |= 1u << colorOf(list); });
    return std::popcount(used);
}

GraphPlace ConstraintGraph::insertContact(std::uint32_t manifold, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                          bool movesB, By by) {
    const int index = by == By::direct ? kDirect : by == By::none ? kFrozen : findPlace(bodyA, movesA, bodyB, movesB);
    return addContact(index, manifold);
}

GraphPlace ConstraintGraph::addContact(int index, std::uint32_t manifold) {
    Color& c = color(index);
    if (c.manifolds.size() == c.manifolds.capacity()) makeRoom(index);
    if (expected_ > 0 && isIterated(index)) --expected_;
    const GraphPlace place{static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(c.manifolds.size())};
    c.manifolds.push(manifold);
    noteUse(index);
    const std::size_t floats =
        static_cast<std::size_t>(bundleCount(index)) * contact::kFields * static_cast<std::size_t>(lanes_);
    if (c.bundles.size() < floats) c.bundles.resize(floats, 0.0f);
    return place;
}

/// Of everything that a contact has in its colour at once. The last colours that are iterated hold few contacts, whose
/// number comes and goes by more than its own size: they get room by that of all contacts. Where many are expected,
/// each list takes them to come as those before did, up to its own size at once.
void ConstraintGraph::makeRoom(int index) {
    constexpr std::size_t kShare = 64;  // shares of all
    Color& c = color(index);
    const std::size_t size = c.manifolds.size();
    std::size_t all = 0;
    const int first = isIterated(index) ? index - colorOf(index) : 0;
    for (int i = first; i < first + kRegionLists; ++i) all += color(i).manifolds.size();
    const std::size_t coming = all > 0 ? std::min(size, size * expected_ / all) : 0;
    std::size_t room = size + std::max(growthOf(c), coming);
    if (!isSerial(index)) room = std::max(room, kFewContacts);
    if (!isSerial(index) && isIterated(index)) room = std::max(room, all / kShare);
    reserve(c, isSerial(index), std::max(room, size + 1));
}

void ConstraintGraph::expectContacts(std::size_t iterated, std::size_t direct) {
    expected_ = iterated;
    Color& c = color(kDirect);
    const std::size_t size = c.manifolds.size();
    if (size + direct > c.manifolds.capacity())
        reserve(c, false, std::max(size + std::max(growthOf(c), direct), kFewContacts));
}

void ConstraintGraph::reserve(Color& c, bool serial, std::size_t room) {
    c.manifolds.reserve(room);
    c.points.reserve(room);
    const auto n = static_cast<std::size_t>(lanes_);
    c.bundles.reserve((serial ? room : (room + n - 1) / n) * contact::kFields * n);
}

std::uint32_t ConstraintGraph::removeContact(GraphPlace place, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                             bool movesB) {
    clearBits(static_cast<int>(place.color), bodyA, movesA, bodyB, movesB);
    return takeContact(place);
}

std::uint32_t ConstraintGraph::takeContact(GraphPlace place) {
    Color& c = colors_[place.color];
    assert(place.slot < c.manifolds.size());
    const GraphPlace last{place.color, static_cast<std::uint32_t>(c.manifolds.size() - 1)};
    const auto n = static_cast<std::size_t>(lanes_);
    float* to = lane(place);
    float* from = lane(last);
    std::uint32_t moved = kNone;
    if (place.slot != last.slot) {
        for (std::size_t f = 0; f < contact::kFields; ++f) std::memcpy(to + f * n, from + f * n, sizeof(float));
        moved = c.manifolds[last.slot];
        c.manifolds[place.slot] = moved;
    }
    // An empty lane joins the static body to itself without mass: the kernels pass over it without effect.
    for (std::size_t f = 0; f < contact::kFields; ++f) from[f * n] = 0.0f;
    c.manifolds.pop();
    noteUse(static_cast<int>(place.color));
    return moved;
}

void ConstraintGraph::copyLane(GraphPlace from, GraphPlace to) {
    const auto n = static_cast<std::size_t>(lanes_);
    const float* const old = lane(from);
    float* const now = lane(to);
    for (std::size_t f = 0; f < contact::kFields; ++f) now[f * n] = old[f * n];
}

/// The list of the same colour there.
int ConstraintGraph::inRegion(GraphPlace place, std::uint32_t region) {
    const auto list = static_cast<int>(place.color);
    return isSerial(list) || !isIterated(list) ? list : firstList(static_cast<int>(region)) + colorOf(list);
}

GraphPlace ConstraintGraph::moveContact(GraphPlace from, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                        bool movesB, By by, std::uint32_t& tookOver) {
    const std::uint32_t manifold = colors_[from.color].manifolds[from.slot];
    const GraphPlace place = insertContact(manifold, bodyA, movesA, bodyB, movesB, by);
    copyLane(from, place);
    tookOver = removeContact(from, bodyA, movesA, bodyB, movesB);
    return place;
}

GraphPlace ConstraintGraph::changeRegion(GraphPlace from, std::uint32_t region, std::uint32_t& tookOver) {
    const int list = inRegion(from, region);
    if (list == static_cast<int>(from.color)) return from;
    const GraphPlace place = addContact(list, colors_[from.color].manifolds[from.slot]);
    copyLane(from, place);
    tookOver = takeContact(from);
    return place;
}

GraphPlace ConstraintGraph::changeJointRegion(GraphPlace from, std::uint32_t region, std::uint32_t& tookOver) {
    const int list = inRegion(from, region);
    if (list == static_cast<int>(from.color)) return from;
    AlignedArray<std::uint32_t>&source = colors_[from.color].joints, &target = color(list).joints;
    target.push(source[from.slot]);
    if (from.slot + 1 != source.size()) tookOver = source[from.slot] = source.back();
    source.pop();
    noteUse(static_cast<int>(from.color));
    noteUse(list);
    return {static_cast<std::uint32_t>(list), static_cast<std::uint32_t>(target.size() - 1)};
}

void ConstraintGraph::reorderContacts(int index, StageArray<std::uint32_t>& from) {
    AlignedArray<std::uint32_t>& list = color(index).manifolds;
    const auto n = static_cast<std::size_t>(lanes_);
    const auto laneOf = [&](std::uint32_t slot) { return lane({static_cast<std::uint32_t>(index), slot}); };
    for (std::uint32_t start = 0; start < from.size(); ++start) {
        if (from[start] == start) continue;
        float first[contact::kFields];
        for (std::size_t f = 0; f < contact::kFields; ++f) first[f] = laneOf(start)[f * n];
        const std::uint32_t firstManifold = list[start];
        std::uint32_t place = start;
        while (from[place] != start) {
            const std::uint32_t next = from[place];
            for (std::size_t f = 0; f < contact::kFields; ++f) laneOf(place)[f * n] = laneOf(next)[f * n];
            list[place] = list[next];
            from[place] = place;
            place = next;
        }
        for (std::size_t f = 0; f < contact::kFields; ++f) laneOf(place)[f * n] = first[f];
        list[place] = firstManifold;
        from[place] = place;
    }
}

void ConstraintGraph::countPoints(int index) {
    Color& c = color(index);
    c.points.resizeForOverwrite(c.manifolds.size());
    const auto n = static_cast<std::size_t>(lanes_);
    constexpr std::size_t kAhead = 8;  // bundles: they are far from each other
    for (std::size_t first = 0; first < c.points.size(); first += n) {
        const float* counts = c.bundles.data() + first * contact::kFields + contact::kPointCount * n;
        prefetch(counts + kAhead * n * contact::kFields);
        for (std::size_t i = first; i < first + n && i < c.points.size(); ++i) {
            std::uint32_t count;
            std::memcpy(&count, counts + (i - first), sizeof count);
            c.points[i] = static_cast<std::uint8_t>(count);
        }
    }
}

void ConstraintGraph::exchangeContacts(GraphPlace a, GraphPlace b) {
    Color& c = colors_[a.color];
    const auto n = static_cast<std::size_t>(lanes_);
    float *laneA = lane(a), *laneB = lane(b);
    const auto exchange = [&](std::size_t first, std::size_t count) {
        for (std::size_t f = first; f < first + count; ++f) std::swap(laneA[f * n], laneB[f * n]);
    };
    exchange(contact::kBodyA, contact::kTraits - contact::kBodyA);
    exchange(contact::kFriction, contact::kShift - contact::kFriction);
    exchange(contact::kRecordA, contact::kApproach - contact::kRecordA);
    const std::size_t points = std::max(c.points[a.slot], c.points[b.slot]);
    for (std::size_t j = 0; j < points; ++j)
        for (const contact::PointField field : {contact::kImpulse, contact::kLoad})
            exchange(contact::kPoints + j * contact::kPointFields + static_cast<std::size_t>(field), 1);
    std::swap(c.manifolds[a.slot], c.manifolds[b.slot]);
    std::swap(c.points[a.slot], c.points[b.slot]);
}

GraphPlace ConstraintGraph::insertJoint(std::uint32_t joint, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                        bool movesB, bool direct) {
    const int index = direct ? kDirect : findPlace(bodyA, movesA, bodyB, movesB);
    Color& c = color(index);
    c.joints.push(joint);
    noteUse(index);
    return {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(c.joints.size() - 1)};
}

std::uint32_t ConstraintGraph::removeJoint(GraphPlace place, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                           bool movesB) {
    Color& c = colors_[place.color];
    clearBits(static_cast<int>(place.color), bodyA, movesA, bodyB, movesB);
    const std::uint32_t last = c.joints.back();
    const std::uint32_t removed = c.joints[place.slot];
    c.joints[place.slot] = last;
    c.joints.pop();
    noteUse(static_cast<int>(place.color));
    return last == removed ? kNone : last;
}

}  // namespace ragtop
