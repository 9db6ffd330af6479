#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "shapes/mesh_build.h"

namespace ragtop {
namespace {

constexpr std::size_t kLeafSize = 4;  ///< lanes of FourFloats
constexpr int kBins = 16;             ///< of the longest axis, by trial
/// From this depth on halves are equal in number, so that 2³² triangles end within kMeshTreeDepth.
constexpr int kBalancedDepth = kMeshTreeDepth - 34;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr Bounds kNothing{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
/// Meets nothing, not even what reaches everywhere.
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Bounds kNowhere{{kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}};

struct Item {
    Bounds bounds;
    Vec3 middle;  ///< twice the centre
    std::uint32_t triangle;
};
using Items = std::span<Item>;

/// Half the surface of the box; zero of an empty one.
float halfSurface(const Bounds& b) {
    const Vec3 d = b.upper - b.lower;
    return d.x < 0 ? 0 : d.x * d.y + d.y * d.z + d.z * d.x;
}

struct Split {
    int axis = -1;  ///< negative: none found
    int bin = 0;    ///< the first of the upper half
    float lower = 0, perBin = 0;

    int binOf(const Item& item) const {
        return std::min(kBins - 1, static_cast<int>((item.middle[axis] - lower) * perBin));
    }
};

/// The split of least Σ surface × count over equal bins of centres [Wald, On fast Construction of SAH-based Bounding
/// Volume Hierarchies, 2007].
Split bestSplit(const Items& items) {
    Bounds middles = kNothing;
    for (const Item& item : items) middles = merge(middles, {item.middle, item.middle});
    Split best;
    float leastCost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const float extent = middles.upper[axis] - middles.lower[axis];
        const Split split{axis, 0, middles.lower[axis], static_cast<float>(kBins) / extent};
        if (!(extent > 0) || !std::isfinite(split.perBin)) continue;
        Bounds bounds[kBins];
        float count[kBins] = {};
        std::fill_n(bounds, kBins, kNothing);
        for (const Item& item : items) {
            const int bin = split.binOf(item);
            bounds[bin] = merge(bounds[bin], item.bounds);
            count[bin] += 1;
        }
        float upperCost[kBins] = {};
        Bounds upper = kNothing;
        float upperCount = 0;
        for (int bin = kBins - 1; bin > 0; --bin) {
            upper = merge(upper, bounds[bin]);
            upperCount += count[bin];
            upperCost[bin] = upperCount > 0 ? upperCount * halfSurface(upper) : -1;
        }
        Bounds lower = kNothing;
        float lowerCount = 0;
        for (int bin = 1; bin < kBins; ++bin) {
            lower = merge(lower, bounds[bin - 1]);
            lowerCount += count[bin - 1];
            if (lowerCount == 0 || upperCost[bin] < 0) continue;
            const float cost = lowerCount * halfSurface(lower) + upperCost[bin];
            if (cost < leastCost) {
                leastCost = cost;
                best = split;
                best.bin = bin;
            }
        }
    }
    return best;
}

std::size_t halve(const Items& items) {
    Bounds middles = kNothing;
    for (const Item& item : items) middles = merge(middles, {item.middle, item.middle});
    const Vec3 extent = middles.upper - middles.lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::sort(items.begin(), items.end(), [axis](const Item& a, const Item& b) {
        return a.middle[axis] < b.middle[axis] || (a.middle[axis] == b.middle[axis] && a.triangle < b.triangle);
    });
    return items.size() / 2;
}

/// The items below the split come first; both sides keep their order.
std::size_t divide(const Items& items, const Split& split) {
    std::vector<Item> above;
    auto to = items.begin();
    for (const Item& item : items) {
        if (split.binOf(item) < split.bin)
            *to++ = item;
        else
            above.push_back(item);
    }
    std::copy(above.begin(), above.end(), to);
    return static_cast<std::size_t>(to - items.begin());
}

/// Of two halves, stored depth first, while the tree is built.
struct Node {
    Bounds bounds;
    std::uint32_t first = 0;  ///< leaf: first triangle; inner: index of the right child (the left one follows)
    std::uint32_t count = 0;  ///< leaf: number of triangles; inner: 0
};

void addNode(std::vector<Node>& nodes, const Items& items, std::uint32_t first, int depth) {
    Bounds bounds = kNothing;
    for (const Item& item : items) bounds = merge(bounds, item.bounds);
    const std::size_t self = nodes.size();
    nodes.push_back({bounds, first, static_cast<std::uint32_t>(items.size())});
    if (items.size() <= kLeafSize) return;

    const Split split = depth < kBalancedDepth ? bestSplit(items) : Split{};
    const std::size_t half = split.axis >= 0 ? divide(items, split) : halve(items);
    nodes[self].count = 0;
    addNode(nodes, items.first(half), first, depth + 1);
    nodes[self].first = static_cast<std::uint32_t>(nodes.size());
    addNode(nodes, items.subspan(half), first + static_cast<std::uint32_t>(half), depth + 1);
}

/// The branch of an inner node: its children, of which the largest give way to their own while there is room. A leaf
/// that is the whole tree is the only child of its branch.
void addBranch(std::vector<MeshBranch>& branches, const std::vector<Node>& nodes, std::uint32_t node) {
    constexpr std::size_t kWidth = MeshBranch::kWidth;
    std::uint32_t child[kWidth] = {node};
    std::size_t count = 1;
    for (;;) {
        std::size_t largest = kWidth;
        float most = -1;
        for (std::size_t i = 0; i < count; ++i) {
            const Node& candidate = nodes[child[i]];
            const float surface = halfSurface(candidate.bounds);
            if (candidate.count == 0 && surface > most) largest = i, most = surface;
        }
        if (largest == kWidth || count == kWidth) break;
        for (std::size_t i = count++; i > largest + 1; --i) child[i] = child[i - 1];
        child[largest + 1] = nodes[child[largest]].first;
        ++child[largest];
    }
    const std::size_t self = branches.size();
    branches.emplace_back();
    for (std::size_t i = 0; i < kWidth; ++i) {
        const Node& of = nodes[i < count ? child[i] : node];
        const Bounds bounds = i < count ? of.bounds : kNowhere;
        for (int axis = 0; axis < 3; ++axis) {
            branches[self].lower[axis][i] = bounds.lower[axis];
            branches[self].upper[axis][i] = bounds.upper[axis];
        }
        if (i >= count) continue;
        branches[self].first[i] = of.count > 0 ? of.first : static_cast<std::uint32_t>(branches.size());
        branches[self].count[i] = of.count;
        if (of.count == 0) addBranch(branches, nodes, child[i]);
    }
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<Item>& items) {
    std::vector<T> old = std::move(values);
    values.clear();
    values.reserve(old.size());
    for (const Item& item : items) values.push_back(old[item.triangle]);
}

}  // namespace

void buildTree(MeshTables& mesh) {
    std::vector<Item> items(mesh.triangles.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        const Triangle& t = mesh.triangles[i];
        const Bounds b = boundsOfTriangle(mesh.vertices[t.a], mesh.vertices[t.b], mesh.vertices[t.c]);
        items[i] = {b, b.lower + b.upper, i};
    }
    std::vector<Node> nodes;
    addNode(nodes, items, 0, 0);
    mesh.branches.clear();
    addBranch(mesh.branches, nodes, 0);
    mesh.bounds = nodes[0].bounds;
    reorder(mesh.triangles, items);
    reorder(mesh.normals, items);
    reorder(mesh.activeEdges, items);
    reorder(mesh.sourceIndex, items);
}

}  // namespace ragtop
