#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <vector>

#include "../tests/core/scenes.h"
#include "../tests/core/tree_rig.h"
#include "base/aligned_array.h"
#include "broadphase/bounds_tree.h"
#include "constraints/contact_layout.h"
#include "narrowphase/collide.h"
#include "solve/kernel_table.h"

/// Single parts of a step on one thread.
namespace ragtop {
namespace {

/// Boxes side by side on the ground, or each on another one, four points each, in bundles of the kernels' width.
enum class Below { ground, body };
class ContactRows {
public:
    ContactRows(const KernelTable& table, int contacts, Below below)
        : kernels(table),
          bodyCount(contacts),
          states_(std::pmr::get_default_resource()),
          inertias_(std::pmr::get_default_resource()),
          dynamics_(std::pmr::get_default_resource()),
          histories_(std::pmr::get_default_resource()),
          bundles_(std::pmr::get_default_resource()) {
        const bool stacked = below == Below::body;
        const auto count = static_cast<std::size_t>(stacked ? 2 * contacts : contacts);
        states_.resize(count + 1, {});
        inertias_.resize(count + 1, {});
        dynamics_.resize(count + 1, {});
        histories_.resize(count + 1, {});
        bundles_.resize(static_cast<std::size_t>(bundleCount() * contact::kFields * kernels.lanes), 0.0f);
        for (std::uint32_t body = 1; body <= count; ++body) addBody(body);
        for (int i = 0; i < contacts; ++i) {
            const auto body = static_cast<std::uint32_t>(i + 1);
            order_.push_back(body);
            fill(i, stacked ? body + static_cast<std::uint32_t>(contacts) : 0, body);
        }
        context_.h = context_.dt = 1.0f / 240;
        context_.inverseH = 240;
        context_.soft = makeSoftness(30, 10, context_.h);
        context_.softStatic = makeSoftness(60, 5, context_.h);
        context_.pushOut = 1.8f;
        prepare();
    }
    int bundleCount() const { return (bodyCount + kernels.lanes - 1) / kernels.lanes; }
    BodyArrays arrays() { return {states_.data(), inertias_.data(), dynamics_.data(), histories_.data()}; }
    template <class ContactKernel>
    void run(ContactKernel kernel) {
        kernel(bundles_.data(), 0, bundleCount(), arrays(), context_);
    }
    void prepare() {
        kernels.prepareContacts(bundles_.data(), 0, bundleCount(), arrays(), context_);
    }
    void integrate() {
        kernels.integrateVelocities(arrays(), order_.data(), 0, bodyCount, context_);
        kernels.integratePositions(arrays(), order_.data(), 0, bodyCount, context_);
        for (BodyState& state : states_) {
            state.v = state.dp = {};
            state.dq = {};
        }
    }

    const KernelTable& kernels;
    const int bodyCount;

private:
    void addBody(std::uint32_t body) {
        states_[body].invMass = 0.001f;
        states_[body].v = {0.125f, -0.25f, 0};
        inertias_[body] = {0.006f, 0, 0, 0.006f, 0, 0.006f, 0, 0};
        dynamics_[body].inertia = {160, 160, 160};
        dynamics_[body].inverseInertia = {1 / 160.0f, 1 / 160.0f, 1 / 160.0f};
        dynamics_[body].acceleration = {0, -9.81f, 0};
    }
    void fill(int i, std::uint32_t bodyA, std::uint32_t bodyB) {
        const int n = kernels.lanes;
        float* lane = bundles_.data() + static_cast<std::size_t>(i / n * contact::kFields * n + i % n);
        const auto at = [&](int field) -> float& { return lane[static_cast<std::size_t>(field * n)]; };
        const std::uint32_t points = contact::kMaxPoints;
        std::memcpy(&at(contact::kBodyA), &bodyA, sizeof bodyA);
        std::memcpy(&at(contact::kBodyB), &bodyB, sizeof bodyB);
        const float anchor = bodyA == 0 ? -0.5f : 0.5f;
        at(contact::kOffset + 1) = anchor + 0.5f;
        std::memcpy(&at(contact::kPointCount), &points, sizeof points);
        at(contact::kNormal + 1) = 1;
        at(contact::kFriction) = 0.5f;
        at(contact::kSlidingShare) = 1;
        at(contact::kSize) = 0.5f;
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const int point = contact::kPoints + j * contact::kPointFields;
            at(point + contact::kAnchor) = j % 2 == 0 ? -0.5f : 0.5f;
            at(point + contact::kAnchor + 1) = anchor;
            at(point + contact::kAnchor + 2) = j / 2 == 0 ? -0.5f : 0.5f;
            at(point + contact::kSeparation) = -0.001f;
        }
    }

    AlignedArray<BodyState> states_;
    AlignedArray<BodyInertia> inertias_;
    AlignedArray<BodyDynamics> dynamics_;
    AlignedArray<BodyHistory> histories_;
    AlignedArray<float> bundles_;
    std::vector<std::uint32_t> order_;
    SolverContext context_;
};

constexpr int kContacts = 2048;

void perItem(benchmark::State& state, int items) {
    state.counters["time/item"] =
        benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// One bias pass over contacts of four points with friction and twist.
void contactSolve(benchmark::State& state, Below below) {
    ContactRows rows(selectKernels(static_cast<int>(state.range(0))), kContacts, below);
    for (auto _ : state) rows.run(rows.kernels.solveContacts);
    perItem(state, kContacts);
    state.SetLabel(rows.kernels.name);
}
/// One relaxing pass over the same.
void contactRelax(benchmark::State& state, Below below) {
    ContactRows rows(selectKernels(static_cast<int>(state.range(0))), kContacts, below);
    for (auto _ : state) rows.run(rows.kernels.relaxContacts);
    perItem(state, kContacts);
    state.SetLabel(rows.kernels.name);
}
void contactPrepare(benchmark::State& state, Below below) {
    ContactRows rows(selectKernels(static_cast<int>(state.range(0))), kContacts, below);
    for (auto _ : state) rows.prepare();
    perItem(state, kContacts);
    state.SetLabel(rows.kernels.name);
}
void contactWarmStart(benchmark::State& state, Below below) {
    ContactRows rows(selectKernels(static_cast<int>(state.range(0))), kContacts, below);
    for (auto _ : state) rows.run(rows.kernels.warmStartContacts);
    perItem(state, kContacts);
    state.SetLabel(rows.kernels.name);
}
void bodyIntegrate(benchmark::State& state) {
    ContactRows rows(selectKernels(static_cast<int>(state.range(0))), kContacts, Below::ground);
    for (auto _ : state) rows.integrate();
    perItem(state, kContacts);
    state.SetLabel(rows.kernels.name);
}
void laneCounts(benchmark::internal::Benchmark* bench) {
    bench->ArgName("lanes")->Arg(4)->Arg(8)->Arg(16)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(contactSolve, bodies, Below::body)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactSolve, ground, Below::ground)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactRelax, bodies, Below::body)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactRelax, ground, Below::ground)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactPrepare, bodies, Below::body)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactPrepare, ground, Below::ground)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactWarmStart, bodies, Below::body)->Apply(laneCounts);
BENCHMARK_CAPTURE(contactWarmStart, ground, Below::ground)->Apply(laneCounts);
BENCHMARK(bodyIntegrate)->Apply(laneCounts);

/// Figures of sixteen balls: Jacobians, factor and solution of one substep; `doublePrecision` in double precision.
void treeSolve(benchmark::State& state, bool doublePrecision) {
    constexpr int kTrees = 64;
    const direct::TreeTables& tables = direct::selectTreeKernels(static_cast<int>(state.range(0)));
    const direct::TreeKernels& kernels = doublePrecision ? tables.doublePrecision : tables.single;
    test::TreeRig rig(kernels, test::limbed(test::figure(4, 4)), kTrees);
    rig.begin();
    for (auto _ : state) rig.solve({1.0f / 240, 40});
    perItem(state, kTrees);
    state.SetLabel(kernels.name);
}
BENCHMARK_CAPTURE(treeSolve, single, false)->Apply(laneCounts);
BENCHMARK_CAPTURE(treeSolve, doublePrecision, true)->Apply(laneCounts);

/// Of it the factor and one solution alone, of what has been gathered, turned and aimed.
void treeFactor(benchmark::State& state, bool doublePrecision) {
    constexpr int kTrees = 64;
    const direct::TreeTables& tables = direct::selectTreeKernels(static_cast<int>(state.range(0)));
    const direct::TreeKernels& kernels = doublePrecision ? tables.doublePrecision : tables.single;
    test::TreeRig rig(kernels, test::limbed(test::figure(4, 4)), kTrees);
    rig.begin();
    rig.solve({1.0f / 240, 40});
    for (auto _ : state) rig.factor();
    perItem(state, kTrees);
    state.SetLabel(kernels.name);
}
BENCHMARK_CAPTURE(treeFactor, single, false)->Apply(laneCounts);
BENCHMARK_CAPTURE(treeFactor, doublePrecision, true)->Apply(laneCounts);

/// Pairs as one box resting on another, with the cache of the step before.
void pairBench(benchmark::State& state, const Shape& a, const Shape& b, const Vec3& offset) {
    const ConvexView viewA = convexView(a), viewB = convexView(b);
    std::vector<Frame> frames;
    scenes::Dice dice(2);
    for (int i = 0; i < 64; ++i)
        frames.push_back({offset + Vec3{dice.between(-0.25f, 0.25f), 0, dice.between(-0.25f, 0.25f)},
                          normalized(Quat{0.001f, 0.001f * static_cast<float>(i % 8), 0.0f, 1})});
    SeparationCache cache;
    Manifold manifold;
    std::size_t i = 0;
    for (auto _ : state) {
        collide(viewA, viewB, frames[i++ % frames.size()], 0.01f, cache, manifold);
        benchmark::DoNotOptimize(manifold);
    }
}
void boxBox(benchmark::State& state) { pairBench(state, Box{}, Box{}, {0, 0.999f, 0}); }
void boxSphere(benchmark::State& state) { pairBench(state, Box{}, Sphere{}, {0, 0.999f, 0}); }
void boxCapsule(benchmark::State& state) { pairBench(state, Box{}, Capsule{}, {0, 0.999f, 0}); }
void capsuleCapsule(benchmark::State& state) { pairBench(state, Capsule{}, Capsule{}, {0.499f, 0, 0}); }
/// Too far apart for points, in directions that the last axis does not always tell.
void boxBoxNear(benchmark::State& state) { pairBench(state, Box{}, Box{}, {0.98f, 1.012f, 0}); }
/// Sixteen points on balls of half a metre.
ConvexHull pebble(std::uint64_t seed) {
    scenes::Dice dice(seed);
    std::vector<Vec3> points;
    for (int i = 0; i < 16; ++i)
        points.push_back(0.5f * normalized(Vec3{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)}));
    return ConvexHull(points);
}
void hullHull(benchmark::State& state) { pairBench(state, pebble(3), pebble(4), {0, 0.75f, 0}); }
BENCHMARK(boxBox);
BENCHMARK(boxBoxNear);
BENCHMARK(hullHull);
BENCHMARK(boxSphere);
BENCHMARK(boxCapsule);
BENCHMARK(capsuleCapsule);

float hillAt(float x, float z) { return 0.5f * std::sin(0.5f * x) * std::cos(0.5f * z); }

/// 20,000 triangles of a metre.
TriangleMesh hillMesh() {
    constexpr std::uint32_t kCells = 100;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t j = 0; j <= kCells; ++j)
        for (std::uint32_t i = 0; i <= kCells; ++i) {
            const float x = static_cast<float>(i) - 50, z = static_cast<float>(j) - 50;
            vertices.push_back({x, hillAt(x, z), z});
            if (i == kCells || j == kCells) continue;
            const std::uint32_t corner = j * (kCells + 1) + i, next = corner + kCells + 1;
            triangles.push_back({corner, next, corner + 1});
            triangles.push_back({corner + 1, next, next + 1});
        }
    return TriangleMesh(vertices, triangles);
}

/// Shapes of a metre on hills of triangles as large as they are.
void meshPair(benchmark::State& state, const Shape& shape) {
    const TriangleMesh hills = hillMesh();
    const ConvexView view = convexView(shape);
    scenes::Dice dice(6);
    std::vector<Frame> frames;
    for (int i = 0; i < 64; ++i) {
        const float x = dice.between(-40, 40), z = dice.between(-40, 40);
        frames.push_back({{x, hillAt(x, z) + 0.49f, z}, normalized(Quat{0.1f, dice.between(-1, 1), 0.1f, 1})});
    }
    Manifold manifolds[kMaxManifolds];
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(collide(hills.data(), view, frames[i++ % frames.size()], 0.1f, manifolds));
        benchmark::DoNotOptimize(manifolds);
    }
}
BENCHMARK_CAPTURE(meshPair, sphere, Sphere{});
BENCHMARK_CAPTURE(meshPair, box, Box{});
BENCHMARK_CAPTURE(meshPair, capsule, Capsule{});

/// Unit boxes in a cube of 40 m, and queries of the same size.
void treeQuery(benchmark::State& state) {
    scenes::Dice dice(9);
    const auto box = [&dice] {
        const Vec3 at{dice.between(0, 40), dice.between(0, 40), dice.between(0, 40)};
        return Bounds{at, at + Vec3{1, 1, 1}};
    };
    StageMemory scratch(std::pmr::get_default_resource());
    BoundsTree tree(std::pmr::get_default_resource(), scratch);
    for (std::uint32_t i = 0; i < state.range(0); ++i) tree.insert(box(), 1, i);
    std::vector<Bounds> queries;
    for (int i = 0; i < 1024; ++i) queries.push_back(box());
    std::size_t i = 0;
    std::uint64_t found = 0;
    for (auto _ : state)
        tree.query(queries[i++ % queries.size()], [&](std::uint32_t) {
            ++found;
            return true;
        });
    benchmark::DoNotOptimize(found);
    state.counters["found"] = benchmark::Counter(static_cast<double>(found), benchmark::Counter::kAvgIterations);
}
BENCHMARK(treeQuery)->ArgName("boxes")->Arg(1000)->Arg(10000);

}  // namespace
}  // namespace ragtop
