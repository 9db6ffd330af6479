#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "base/set_bits.h"
#include "base/stage_memory.h"
#include "constraints/contact_layout.h"

namespace ragtop {

inline constexpr std::uint32_t kNone = 0xffffffffu;  ///< no index

/// A constraint's place: its colour, and its slot in that colour's list.
struct GraphPlace {
    std::uint32_t color = kNone;
    std::uint32_t slot = 0;
};

/// Constraints in colours. Bodies are nodes, constraints are edges, and a colour is a set of edges that share no
/// moving body:
///   colour(c) = min { k : k ∉ used(a) ∪ used(b) },
/// used(x) being the colours that the constraints of body x have. Constraints of one colour may be solved in any
/// order, in lanes and on threads, with the same result; a pass of Gauss–Seidel goes through the colours in turn. A
/// constraint keeps its colour and lane as long as it lives [Catto, Box2D v3, 2024], so that impulses stay where they
/// are from step to step.
///
///   colours 0–11    constraints of two moving bodies
///   colours 12–23   contacts with bodies that no impulse moves; solved last
///   kOverflow       what fits no colour: one constraint per bundle, solved serially before the others
///   kDirect         constraints of islands that are solved directly; no pass visits them
///   kFrozen         contacts of frozen bodies (activity/freezing.cpp); nothing visits them until they are put back
///
/// A bundle is an array of structures of arrays: field f of lane i is at f · lanes + i. Beside the lists for the whole
/// world there are those of each region, an island batch that one worker takes through all substeps.
class ConstraintGraph {
public:
    static constexpr int kColors = 24;  ///< bits of a word; as many as Box3D has
    static constexpr int kFirstStaticColor = 12;  ///< half of them
    static constexpr int kOverflow = kColors;
    static constexpr int kDirect = kColors + 1;
    static constexpr int kFrozen = kColors + 2;
    static constexpr int kLists = kColors + 3;
    static constexpr int kRegionLists = kColors + 1;
    static constexpr int kMostRegions = 64;  ///< a bound on tasks
    /// Who looks after a contact.
    enum class By { iteration, direct, none };

    struct Color {
        explicit Color(std::pmr::memory_resource* memory)
            : bundles(memory), manifolds(memory), points(memory), joints(memory) {}
        AlignedArray<float> bundles;            ///< contact::kFields · lanes floats per bundle
        AlignedArray<std::uint32_t> manifolds;  ///< of each slot
        AlignedArray<std::uint8_t> points;      ///< of each slot, while slots are grouped by them
        AlignedArray<std::uint32_t> joints;     ///< of each joint slot

        bool empty() const { return manifolds.empty() && joints.empty(); }
    };
    /// Of a body's state: where its constraints are.
    struct BodyPlace {
        std::uint32_t region = 0;  ///< from 1; 0: none
        std::uint32_t colors = 0;  ///< a bit for each that it has a constraint of
    };

    ConstraintGraph(int lanes, std::pmr::memory_resource* memory);

    int lanes() const { return lanes_; }
    /// Bodies are state indices; `moves` tells whether impulses move them.
    GraphPlace insertContact(std::uint32_t manifold, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB,
                             By by);
    /// At most so many more contacts are about to come, and so many that are solved directly: their lists grow by few
    /// and large steps. None when they have come.
    void expectContacts(std::size_t iterated, std::size_t direct = 0);
    /// The manifold that took over the slot, or kNone.
    std::uint32_t removeContact(GraphPlace place, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB);
    /// Puts a contact with all that its lane holds into another list. `tookOver`: what removeContact returns.
    GraphPlace moveContact(GraphPlace from, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB, By by,
                           std::uint32_t& tookOver);
    /// Puts what is in slot from[slot] of a colour into each slot; `from` is a permutation, which this uses up.
    void reorderContacts(int color, StageArray<std::uint32_t>& from);
    /// Puts contacts of a colour in the order of how many points they have, most first, by as few exchanges as it takes:
    /// what outlives a step moves, what prepare writes does not. moved(manifold, slot) is told of each.
    template <class Moved>
    void groupByPoints(int color, Moved&& moved);
    GraphPlace insertJoint(std::uint32_t joint, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB,
                           bool direct);
    std::uint32_t removeJoint(GraphPlace place, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB);

    /// First field of a contact's lane; field f is at lane[f · lanes()].
    float* lane(GraphPlace place) {
        const auto n = static_cast<std::size_t>(lanes_);
        const bool single = isSerial(static_cast<int>(place.color));
        const std::size_t bundle = single ? place.slot : place.slot >> laneBits_;
        const std::size_t lane = single ? 0 : place.slot & (n - 1);
        return colors_[place.color].bundles.data() + bundle * contact::kFields * n + lane;
    }
    const float* lane(GraphPlace place) const { return const_cast<ConstraintGraph*>(this)->lane(place); }
    int bundleCount(int color) const;
    Color& color(int index) { return colors_[static_cast<std::size_t>(index)]; }
    const Color& color(int index) const { return colors_[static_cast<std::size_t>(index)]; }
    int usedColors() const;

    int listCount() const { return static_cast<int>(colors_.size()); }
    /// The lists of a region, or 0 of none, that passes visit: a bit for each that holds something, from
    /// firstList(region).
    std::uint32_t iteratedLists(int region) const {
        return used_[static_cast<std::size_t>(region)] & ((1u << kRegionLists) - 1);
    }
    /// Calls visit(list) for all that hold something, in their order: of a small world few do.
    template <class Visit>
    void forUsedLists(Visit&& visit) const {
        for (std::size_t r = 0; r < used_.size(); ++r)
            forEachBit(used_[r], [&](int bit) { visit(firstList(static_cast<int>(r)) + bit); });
    }
    int regionCount() const { return (listCount() - kLists) / kRegionLists; }
    /// Of region r, from 1; 0: of constraints that lie in none.
    static int firstList(int region) { return region == 0 ? 0 : kLists + (region - 1) * kRegionLists; }
    /// The colour that a list is of.
    static int colorOf(int list) { return list < kLists ? list : (list - kLists) % kRegionLists; }
    /// One constraint per bundle, which may share bodies.
    static bool isSerial(int list) { return colorOf(list) == kOverflow; }
    static bool isIterated(int list) { return list != kDirect && list != kFrozen; }
    std::uint32_t regionOf(std::uint32_t body) const { return body < bodies_.size() ? bodies_[body].region : 0; }
    AlignedArray<BodyPlace>& bodies() { return bodies_; }
    void setRegion(std::uint32_t body, std::uint32_t region) { bodyPlace(body).region = region; }
    /// Puts a contact with all that its lane holds into the list of its colour in a region. `tookOver`: as moveContact.
    GraphPlace changeRegion(GraphPlace from, std::uint32_t region, std::uint32_t& tookOver);
    GraphPlace changeJointRegion(GraphPlace from, std::uint32_t region, std::uint32_t& tookOver);
    /// So many lists; those that go are empty. Also looks which hold something, after they were written from outside.
    void resizeRegions(int regions);

private:
    GraphPlace addContact(int list, std::uint32_t manifold);
    std::uint32_t takeContact(GraphPlace place);
    void copyLane(GraphPlace from, GraphPlace to);
    static int inRegion(GraphPlace place, std::uint32_t region);
    BodyPlace& bodyPlace(std::uint32_t body);
    int findPlace(std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB);
    void makeRoom(int color);
    void reserve(Color& color, bool serial, std::size_t room);
    void countPoints(int color);
    void exchangeContacts(GraphPlace a, GraphPlace b);
    void noteUse(int list);
    void clearBits(int color, std::uint32_t bodyA, bool movesA, std::uint32_t bodyB, bool movesB);

    std::size_t expected_ = 0;  ///< contacts that are about to come
    int lanes_;     ///< a power of two
    int laneBits_;  ///< its logarithm
    std::pmr::memory_resource* memory_;
    std::vector<Color> colors_;  ///< those of no region, then those of each
    std::vector<std::uint32_t> used_;  ///< of no region, then of each: a bit for each list that holds something
    AlignedArray<BodyPlace> bodies_;
};

template <class Moved>
void ConstraintGraph::groupByPoints(int index, Moved&& moved) {
    constexpr std::size_t kClasses = contact::kMaxPoints + 1;
    Color& c = color(index);
    if (c.manifolds.size() <= static_cast<std::size_t>(lanes_)) return;
    countPoints(index);
    std::uint32_t next[kClasses] = {}, end[kClasses] = {};  // of each class: where to look for strangers
    for (const std::uint8_t points : c.points) ++end[contact::kMaxPoints - points];
    for (std::size_t k = 1; k < kClasses; ++k) next[k] = end[k - 1], end[k] += end[k - 1];
    for (std::size_t k = 0; k < kClasses; ++k)
        for (std::uint32_t slot = next[k]; slot < end[k]; ++slot)
            while (contact::kMaxPoints - c.points[slot] != static_cast<int>(k)) {
                const auto home = static_cast<std::size_t>(contact::kMaxPoints - c.points[slot]);
                while (contact::kMaxPoints - c.points[next[home]] == static_cast<int>(home)) ++next[home];
                const auto place = static_cast<std::uint32_t>(index);
                exchangeContacts({place, slot}, {place, next[home]});
                moved(c.manifolds[slot], slot);
                moved(c.manifolds[next[home]], next[home]);
            }
}

}  // namespace ragtop
