#include "broadphase/bounds_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory_resource>
#include <random>
#include <utility>
#include <vector>

#include "base/stage_runner.h"
#include "broadphase/sought_bounds.h"

namespace ragtop {
namespace {

struct Model {
    std::pmr::monotonic_buffer_resource memory;
    StageMemory scratch{&memory};
    BoundsTree tree{&memory, scratch};
    std::map<std::uint32_t, Bounds> proxies;  // the value of each proxy is its own name plus 1000
    std::mt19937 random{7};

    float uniform(float lower, float upper) { return std::uniform_real_distribution<float>(lower, upper)(random); }
    Vec3 point(float size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Bounds box(float world, float size) {
        const Vec3 center = point(world);
        const Vec3 half{uniform(0, size), uniform(0, size), uniform(0, size)};
        return {center - half, center + half};
    }
    std::uint32_t any() {
        auto it = proxies.begin();
        std::advance(it, static_cast<long>(random() % proxies.size()));
        return it->first;
    }
    void insert(const Bounds& bounds, std::uint32_t category = 1) {
        const auto next = static_cast<std::uint32_t>(proxies.size());
        const std::uint32_t proxy = tree.insert(bounds, category, next);
        proxies[proxy] = bounds;
        values[proxy] = next;
    }
    void change() {
        const auto what = random() % 8;
        if (proxies.size() < 3 || what < 3) {
            insert(box(20, 2));
        } else if (what < 5) {
            const auto proxy = any();
            tree.remove(proxy);
            proxies.erase(proxy);
        } else if (what == 5) {
            const auto proxy = any();
            tree.move(proxy, proxies[proxy] = box(20, 2));
        } else {
            const auto proxy = any();
            Bounds& bounds = proxies[proxy];
            bounds = merge(bounds, {bounds.lower + point(1), bounds.upper + point(1)});
            tree.enlarge(proxy, bounds);
        }
    }
    std::map<std::uint32_t, std::uint32_t> values;

    std::vector<std::uint32_t> queried(const Bounds& bounds) const {
        std::vector<std::uint32_t> found;
        tree.query(bounds, [&](std::uint32_t value) {
            found.push_back(value);
            return true;
        });
        std::sort(found.begin(), found.end());
        return found;
    }
    std::vector<std::uint32_t> expected(const Bounds& bounds) const {
        std::vector<std::uint32_t> found;
        for (const auto& [proxy, own] : proxies) {
            if (overlaps(own, bounds)) found.push_back(values.at(proxy));
        }
        std::sort(found.begin(), found.end());
        return found;
    }

    // Every inner node holds its children, knows its height and categories; every node hangs where it says.
    int checkedHeight() const {
        if (tree.empty()) return 0;
        int leaves = 0;
        const int height = check(tree.header().root, BoundsTree::kNull, leaves);
        EXPECT_EQ(leaves, tree.proxyCount());
        EXPECT_EQ(leaves, static_cast<int>(proxies.size()));
        return height;
    }
    int check(std::uint32_t index, std::uint32_t parent, int& leaves) const {
        const auto& node = tree.nodes()[index];
        EXPECT_EQ(node.parent, parent);
        if (node.height == 0) {
            ++leaves;
            return 0;
        }
        const auto& left = tree.nodes()[node.left];
        const auto& right = tree.nodes()[node.right];
        EXPECT_TRUE(contains(node.bounds, left.bounds) && contains(node.bounds, right.bounds));
        EXPECT_EQ(node.category, left.category | right.category);
        EXPECT_EQ(node.flags & (left.flags | right.flags), left.flags | right.flags);
        const int height = 1 + std::max(check(node.left, index, leaves), check(node.right, index, leaves));
        EXPECT_EQ(height, node.height);
        return height;
    }
};

// Exact in doubles: where the way of the box's centre meets bounds grown by its extents.
double enterFraction(const Vec3& origin, const Vec3& along, const Vec3& extents, const Bounds& bounds) {
    double from = 0, to = 1;
    for (int i = 0; i < 3; ++i) {
        const double lower = static_cast<double>(bounds.lower[i]) - extents[i] - origin[i];
        const double upper = static_cast<double>(bounds.upper[i]) + extents[i] - origin[i];
        const double move = along[i];
        if (move == 0) {
            if (lower > 0 || upper < 0) return 2;
            continue;
        }
        from = std::max(from, std::min(lower / move, upper / move));
        to = std::min(to, std::max(lower / move, upper / move));
    }
    return from <= to ? from : 2;
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// What is found between the branches where proxies seek, as pairs of values; within one tree the lower value comes first.
Pairs pairsFound(const Model& model, const Model& partners, std::size_t few) {
    const bool within = &model == &partners;
    std::pmr::vector<BoundsTree::NodePair> branches;
    model.tree.collectSeeking(partners.tree, few, branches);
    Pairs pairs;
    for (const BoundsTree::NodePair branch : branches)
        model.tree.forPairs(partners.tree, branch, [&](std::uint32_t a, std::uint32_t b) {
            pairs.push_back(within && b < a ? std::pair(b, a) : std::pair(a, b));
        });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}
Pairs pairsExpected(const Model& model, const Model& partners, const std::vector<std::uint32_t>& seeking) {
    const bool within = &model == &partners;
    Pairs pairs;
    for (const std::uint32_t proxy : seeking)
        for (const auto& [other, bounds] : partners.proxies) {
            const std::uint32_t a = model.values.at(proxy), b = partners.values.at(other);
            if ((within && a == b) || !overlaps(model.proxies.at(proxy), bounds)) continue;
            pairs.push_back(within && b < a ? std::pair(b, a) : std::pair(a, b));
        }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

TEST(BoundsTree, FindsEachPairOfWhatSeeksOnce) {
    Model model, obstacles;
    for (const int proxies : {0, 1, 2, 3, 10, 300}) {
        while (static_cast<int>(model.proxies.size()) < proxies) model.insert(model.box(10, 2));
        while (static_cast<int>(obstacles.proxies.size()) < proxies / 3) obstacles.insert(obstacles.box(10, 4));
        for (const unsigned oneIn : {1u, 2u, 20u}) {
            std::vector<std::uint32_t> seeking;
            for (const auto& [proxy, bounds] : model.proxies)
                if (model.random() % oneIn == 0) seeking.push_back(proxy);
            for (const std::uint32_t proxy : seeking) model.tree.seek(proxy);
            for (const std::size_t few : {0, 8, 1000}) {
                EXPECT_EQ(pairsFound(model, model, few), pairsExpected(model, model, seeking)) << proxies;
                EXPECT_EQ(pairsFound(model, obstacles, few), pairsExpected(model, obstacles, seeking)) << proxies;
            }
            for (const std::uint32_t proxy : seeking) model.tree.stopSeeking(proxy);
            EXPECT_TRUE(pairsFound(model, model, 8).empty());
        }
    }
}

TEST(BoundsTree, FewFindAllThatTheirBoundsMeet) {
    Model model;
    std::pmr::vector<BoundsTree::NodePair> waiting;
    for (const int proxies : {0, 1, 2, 3, 10, 300}) {
        while (static_cast<int>(model.proxies.size()) < proxies) model.insert(model.box(10, 2));
        for (const std::size_t seekers : {std::size_t{0}, std::size_t{1}, std::size_t{40}}) {
            std::vector<Bounds> sought;
            while (sought.size() < seekers) sought.push_back(model.box(10, sought.empty() ? 20.0f : 1.0f));
            Pairs pairs, expected;
            model.tree.queryAll(sought, waiting,
                                [&](std::uint32_t place, std::uint32_t value) { pairs.emplace_back(place, value); });
            for (std::uint32_t place = 0; place < seekers; ++place)
                for (const auto& [proxy, bounds] : model.proxies)
                    if (overlaps(sought[place], bounds)) expected.emplace_back(place, model.values.at(proxy));
            std::sort(pairs.begin(), pairs.end());
            std::sort(expected.begin(), expected.end());
            EXPECT_EQ(pairs, expected) << proxies << " proxies, " << seekers << " seekers";
        }
    }
}

TEST(BoundsTree, AgreesWithBruteForceThroughTenThousandChanges) {
    Model model;
    for (int i = 0; i < 10000; ++i) {
        model.change();
        if (i % 50 == 0) model.tree.refitEnlarged();
        if (i % 10 == 0) {
            const Bounds region = model.box(25, 8);
            ASSERT_EQ(model.queried(region), model.expected(region)) << "after change " << i;
        }
        if (i % 500 == 0) model.checkedHeight();
    }
    model.tree.refitEnlarged();
    model.checkedHeight();
    ASSERT_FALSE(HasFailure());
}

TEST(BoundsTree, CastsMeetWhatBruteForceMeets) {
    Model model;
    for (int i = 0; i < 2000; ++i) model.insert(model.box(50, 1.5f));
    for (int i = 0; i < 2000; ++i) {
        const Vec3 origin = model.point(60);
        Vec3 along = model.point(80);
        if (i % 5 == 0) along[i % 3] = 0;
        if (i % 7 == 0) along = {i % 2 == 0 ? 100.0f : -100.0f, 0, 0};
        const Vec3 extents = i % 3 == 0 ? Vec3{} : Vec3{model.uniform(0, 3), model.uniform(0, 3), model.uniform(0, 3)};
        std::vector<std::uint32_t> met;
        model.tree.cast({origin, along, extents}, [&](std::uint32_t value, float closer) {
            met.push_back(value);
            return closer;
        });
        std::sort(met.begin(), met.end());
        std::vector<std::uint32_t> must;
        for (const auto& [proxy, bounds] : model.proxies) {
            if (enterFraction(origin, along, extents, bounds) <= 1) must.push_back(model.values.at(proxy));
        }
        ASSERT_TRUE(std::includes(met.begin(), met.end(), must.begin(), must.end())) << "cast " << i;
        // Only roundings may add what is not met.
        ASSERT_LE(met.size(), must.size() + 2);
    }
}

TEST(BoundsTree, CastsThatShrinkFindTheNearest) {
    Model model;
    std::map<std::uint32_t, Bounds> byValue;
    for (int i = 0; i < 2000; ++i) model.insert(model.box(50, 1.5f));
    for (const auto& [proxy, bounds] : model.proxies) byValue[model.values[proxy]] = bounds;
    int visits = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 origin = model.point(60);
        const Vec3 along = model.point(120);
        double found = 2;
        model.tree.cast({origin, along, {}}, [&](std::uint32_t value, float closer) {
            ++visits;
            const double fraction = enterFraction(origin, along, {}, byValue[value]);
            found = std::min(found, fraction);
            return fraction < closer ? static_cast<float>(fraction) : closer;
        });
        double nearest = 2;
        for (const auto& [value, bounds] : byValue) {
            nearest = std::min(nearest, enterFraction(origin, along, {}, bounds));
        }
        ASSERT_EQ(found, nearest);
    }
    EXPECT_LT(visits, 1000 * 10);
}

TEST(BoundsTree, QueryEndsWhenTheVisitorSaysSo) {
    Model model;
    for (int i = 0; i < 20; ++i) model.insert({{-1, -1, -1}, {1, 1, 1}});
    int visits = 0;
    model.tree.query({{0, 0, 0}, {0, 0, 0}}, [&](std::uint32_t) { return ++visits < 3; });
    EXPECT_EQ(visits, 3);
    visits = 0;
    model.tree.cast({{-5, 0, 0}, {10, 0, 0}, {}}, [&](std::uint32_t, float) {
        ++visits;
        return 0.0f;
    });
    EXPECT_EQ(visits, 1);
}

TEST(BoundsTree, HeightStaysLogarithmicWhateverTheOrder) {
    constexpr int kCount = 1024;
    const auto grow = [](auto boundsOf) {
        Model model;
        for (int i = 0; i < kCount; ++i) model.insert(boundsOf(static_cast<float>(i)));
        const int height = model.checkedHeight();
        // Twice log2 n, and the room that keeps rebuilds rare.
        EXPECT_LE(height, 2 * std::bit_width(static_cast<unsigned>(kCount)) + 16);
        return height;
    };
    grow([](float i) { return Bounds{{i, 0, 0}, {i + 0.9f, 1, 1}}; });
    grow([](float i) { return Bounds{{0, 0, 0}, {i + 1, i + 1, i + 1}}; });
    grow([](float i) { return Bounds{{0, 0, 0}, {1 / (i + 1), 1, 1}}; });
    grow([](float i) { return Bounds{{i * i * i, 0, 0}, {i * i * i + 1, 1, 1}}; });
    EXPECT_LE(grow([](float) { return Bounds{{0, 0, 0}, {1, 1, 1}}; }), 20);
}

TEST(BoundsTree, RefitsTightenWhatMotionLoosened) {
    Model model;
    for (int i = 0; i < 1000; ++i) model.insert(model.box(50, 0.5f));
    // Everything flies elsewhere in place, a few times: branches are only turned at first, and rebuilt now and then.
    for (int step = 0; step < 8; ++step) {
        for (auto& [proxy, bounds] : model.proxies) model.tree.enlarge(proxy, bounds = model.box(50, 0.5f));
        model.tree.refitEnlarged();
        for (int i = 0; i < 10; ++i) {
            const Bounds region = model.box(50, 8);
            ASSERT_EQ(model.queried(region), model.expected(region));
        }
    }
    EXPECT_LE(model.checkedHeight(), 2 * std::bit_width(1000u));
    float inner = 0;
    for (const auto& node : model.tree.nodes()) {
        if (node.height != 1) continue;
        const Vec3 size = node.bounds.upper - node.bounds.lower;
        inner = std::max({inner, size.x, size.y, size.z});
    }
    // 1000 boxes in 100³ m³: neighbours are about 10 m apart; without a rebuild pairs would span the scene.
    EXPECT_LT(inner, 50);
    for (int i = 0; i < 100; ++i) {
        const Bounds region = model.box(50, 8);
        ASSERT_EQ(model.queried(region), model.expected(region));
    }
}

/// Bounds given on many threads make the tree that enlarging one after the other makes.
TEST(BoundsTree, ThreadsRefitToTheSameTree) {
    Model serial, threaded;
    for (int i = 0; i < 3000; ++i) {
        const Bounds bounds = serial.box(50, 0.5f);
        serial.insert(bounds);
        threaded.insert(bounds);
    }
    StageRunner runner(threadTasks(3));
    std::mt19937 random(3);
    for (int step = 0; step < 20; ++step) {
        std::vector<std::pair<std::uint32_t, Bounds>> moved;
        for (auto& [proxy, bounds] : serial.proxies)
            if (random() % 3 == 0) moved.push_back({proxy, bounds = serial.box(50, 0.5f)});
        for (const auto& [proxy, bounds] : moved) serial.tree.enlarge(proxy, bounds);
        serial.tree.refitEnlarged();
        runner.parallelFor(static_cast<int>(moved.size()), 16, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i)
                threaded.tree.give(moved[static_cast<std::size_t>(i)].first, moved[static_cast<std::size_t>(i)].second);
        });
        for (const auto& [proxy, bounds] : moved) EXPECT_TRUE(threaded.tree.wasGiven(proxy));
        runner.parallelFor(static_cast<int>(moved.size()), 16, [&](int begin, int end, int) {
            for (int i = begin; i < end; ++i) threaded.tree.tellGiven(moved[static_cast<std::size_t>(i)].first);
        });
        threaded.tree.refitEnlarged(&runner);
        ASSERT_EQ(serial.tree.nodes().size(), threaded.tree.nodes().size());
        for (std::size_t i = 0; i < serial.tree.nodes().size(); ++i) {
            const BoundsTree::Node &a = serial.tree.nodes()[i], &b = threaded.tree.nodes()[i];
            ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0) << "step " << step << ", node " << i;
        }
    }
}

TEST(SoughtBounds, OverlapWhereBoundsDo) {
    Model model;
    const float infinity = std::numeric_limits<float>::infinity();
    const Bounds all{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}, one{{0, 0, 0}, {1, 1, 1}};
    EXPECT_TRUE(SoughtBounds(one).overlaps({{1, 0, 0}, {2, 1, 1}}));
    EXPECT_FALSE(SoughtBounds(one).overlaps({{std::nextafter(1.0f, 2.0f), 0, 0}, {2, 1, 1}}));
    for (int i = 0; i < 10000; ++i) {
        const Bounds a = model.box(4, 3), b = model.box(4, 3);
        ASSERT_EQ(SoughtBounds(a).overlaps(b), overlaps(a, b));
        ASSERT_TRUE(SoughtBounds(all).overlaps(b) && SoughtBounds(a).overlaps(all));
    }
}

TEST(BoundsTree, CategoriesOfBranchesFollowTheirLeaves) {
    Model model;
    for (int i = 0; i < 100; ++i) model.insert(model.box(20, 1), 1u << (i % 32));
    for (int i = 0; i < 50; ++i) model.tree.setCategory(model.any(), 1u << (i % 5));
    model.checkedHeight();
}

TEST(BoundsTree, RestoredTreeBehavesAsTheSavedOne) {
    Model model;
    for (int i = 0; i < 500; ++i) model.change();
    const BoundsTree::Header header = model.tree.header();
    const std::vector<BoundsTree::Node> nodes(model.tree.nodes().begin(), model.tree.nodes().end());
    const auto proxies = model.proxies;
    const auto random = model.random;
    const auto values = model.values;

    const auto visits = [&] {
        std::vector<std::uint32_t> order;
        for (int i = 0; i < 500; ++i) {
            model.change();
            if (i % 20 == 0) model.tree.refitEnlarged();
            model.tree.query(model.box(20, 5), [&](std::uint32_t value) {
                order.push_back(value);
                return true;
            });
        }
        return order;
    };
    const auto first = visits();
    model.tree.restore(header, nodes.data(), nodes.size());
    model.proxies = proxies;
    model.random = random;
    model.values = values;
    EXPECT_EQ(visits(), first);
}

TEST(BoundsTree, SameShapeAtEveryScale) {
    // Powers of two are exact, so a scene of another size has the same tree.
    Model small, large;
    for (int i = 0; i < 300; ++i) {
        const Bounds b = small.box(20, 2);
        small.insert(b);
        large.insert({64 * b.lower, 64 * b.upper});
    }
    ASSERT_EQ(small.tree.nodes().size(), large.tree.nodes().size());
    for (std::size_t i = 0; i < small.tree.nodes().size(); ++i) {
        EXPECT_EQ(small.tree.nodes()[i].parent, large.tree.nodes()[i].parent);
        EXPECT_EQ(small.tree.nodes()[i].left, large.tree.nodes()[i].left);
    }
}

}  // namespace
}  // namespace ragtop
