#include "constraints/constraint_graph.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include "base/prefetch.h"

namespace ragtop {

namespace {

bool hasBit(const AlignedArray<std::uint64_t>& bits, std::uint32_t i) {
    const std::size_t word = i / 64;
    return word < bits.size() && ((bits[word] >> (i % 64)) & 1) != 0;
}
void setBit(AlignedArray<std::uint64_t>& bits, std::uint32_t i) {
    if (i / 64 >= bits.size()) bits.resize(i / 64 + 1, 0);
    bits[i / 64] |= std::uint64_t{1} << (i % 64);
}
void clearBit(AlignedArray<std::uint64_t>& bits, std::uint32_t i) { bits[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

}  // namespace

ConstraintGraph::ConstraintGraph(int lanes, std::pmr::memory_resource* memory) : lanes_(lanes) {
    assert(std::has_single_bit(static_cast<unsigned>(lanes)));
    laneBits_ = std::countr_zero(static_cast<unsigned>(lanes));
    colors_.reserve(kLists);
    for (int i = 0; i < kLists; ++i) colors_.emplace_back(memory);
}

int ConstraintGraph::findColor(std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB) {
    const bool both = movesA && movesB;
    const int first = both ? 0 : kFirstStaticColor;
    const int last = both ? kFirstStaticColor : kColors;
    for (int i = first; i < last; ++i) {
        Color& c = color(i);
        if ((movesA && hasBit(c.bodies, bodyA)) || (movesB && hasBit(c.bodies, bodyB))) continue;
        if (movesA) setBit(c.bodies, bodyA);
        if (movesB) setBit(c.bodies, bodyB);
        return i;
    }
    return kOverflow;
}

void ConstraintGraph::clearBits(int index, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB) {
    if (index >= kOverflow) return;
    Color& c = color(index);
    if (movesA) clearBit(c.bodies, bodyA);
    if (movesB) clearBit(c.bodies, bodyB);
}

int ConstraintGraph::bundleCount(int index) const {
    const std::size_t count = color(index).manifolds.size();
    const auto n = static_cast<std::size_t>(lanes_);
    return static_cast<int>(index == kOverflow ? count : (count + n - 1) / n);
}

int ConstraintGraph::usedColors() const {
    int used = 0;
    for (const Color& c : colors_) used += !c.manifolds.empty() || !c.joints.empty();
    return used;
}

GraphPlace ConstraintGraph::insertContact(std::uint32_t manifold, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                          bool movesB, By by) {
    const int index = by == By::direct ? kDirect
                      : by == By::none ? kResting
                                       : findColor(bodyA, movesA, bodyB, movesB);
    Color& c = color(index);
    if (c.manifolds.size() == c.manifolds.capacity()) makeRoom(index);
    const GraphPlace place{static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(c.manifolds.size())};
    c.manifolds.push(manifold);
    const std::size_t floats =
        static_cast<std::size_t>(bundleCount(index)) * contact::kFields * static_cast<std::size_t>(lanes_);
    if (c.bundles.size() < floats) c.bundles.resize(floats, 0.0f);
    return place;
}

/// Of everything that a contact has in its colour at once. The last colours that are swept hold few contacts, whose number
/// comes and goes by more than its own size: they get room by that of all contacts.
void ConstraintGraph::makeRoom(int index) {
    constexpr std::size_t kFew = 64, kShare = 64, kLargeGrowth = 64;
    Color& c = color(index);
    const std::size_t size = c.manifolds.size();
    std::size_t all = 0, words = 0;
    for (const Color& other : colors_) {
        all += other.manifolds.size();
        words = std::max(words, other.bodies.size());
    }
    std::size_t room = size + (c.bundles.isLarge() ? size / kLargeGrowth : size);
    if (index != kOverflow) room = std::max(room, kFew);
    if (index < kOverflow) room = std::max(room, all / kShare);
    room = std::max(room, size + 1);
    c.manifolds.reserve(room);
    c.points.reserve(room);
    c.bodies.reserve(words);
    const auto n = static_cast<std::size_t>(lanes_);
    c.bundles.reserve((index == kOverflow ? room : (room + n - 1) / n) * contact::kFields * n);
}

std::uint32_t ConstraintGraph::removeContact(GraphPlace place, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                             bool movesB) {
    Color& c = colors_[place.color];
    assert(place.slot < c.manifolds.size());
    clearBits(static_cast<int>(place.color), bodyA, movesA, bodyB, movesB);
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
    return moved;
}

GraphPlace ConstraintGraph::moveContact(GraphPlace from, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB,
                                        bool movesB, By by, std::uint32_t& tookOver) {
    const std::uint32_t manifold = colors_[from.color].manifolds[from.slot];
    const GraphPlace place = insertContact(manifold, bodyA, movesA, bodyB, movesB, by);
    const auto n = static_cast<std::size_t>(lanes_);
    const float* const old = lane(from);
    float* const now = lane(place);
    for (std::size_t f = 0; f < contact::kFields; ++f) now[f * n] = old[f * n];
    tookOver = removeContact(from, bodyA, movesA, bodyB, movesB);
    return place;
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
    const int index = direct ? kDirect : findColor(bodyA, movesA, bodyB, movesB);
    Color& c = color(index);
    c.joints.push(joint);
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
    return last == removed ? kNone : last;
}

}  // namespace ragtop
