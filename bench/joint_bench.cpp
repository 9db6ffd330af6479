#include <benchmark/benchmark.h>

#include <memory_resource>
#include <vector>

#include "../tests/core/scenes.h"
#include "constraints/joint_bundles.h"
#include "constraints/joint_swing.h"
#include "solve/joint_kernels.h"

/// Joints in lanes on one thread, in time per joint and substep.
namespace ragtop {
namespace {

/// Pairs of bodies with a joint between them each; one joint in four is at the end of its range.
class JointRows {
public:
    JointRows(const JointDef& def, int lanes, int joints)
        : kernels(selectJointKernels(lanes)),
          graph_(kernels.lanes, std::pmr::get_default_resource()),
          bundles_(kernels.lanes, std::pmr::get_default_resource()),
          states_(static_cast<std::size_t>(2 * joints + 1)),
          inertias_(static_cast<std::size_t>(2 * joints + 1)) {
        scenes::Dice dice(5);
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(joints); ++i) {
            add(def, 2 * i + 1, i % 4 == 0 ? 1.0f : 0.125f, dice);
            graph_.insertJoint(i, 2 * i + 1, true, 2 * i + 2, true, false);
        }
        for (JointSim& joint : joints_) sims_.push_back(&joint);
        bundles_.build(graph_, sims_.data());
        constexpr float h = 1.0f / 240;
        pass_ = {{states_.data(), inertias_.data(), nullptr, nullptr}, {h, 240, makeSoftness(60, 2, h)}};
        load();
    }
    void load() { kernels.load(view(), 0, count()); }
    void store() { kernels.store(view(), 0, count()); }
    void substep() {
        kernels.warmStart(view(), 0, count(), pass_);
        kernels.solve(view(), 0, count(), pass_);
        kernels.relax(view(), 0, count(), pass_);
    }
    /// One by one.
    void substepAlone() {
        for (JointSim& joint : joints_) warmStartJoint(joint, states_.data(), inertias_.data(), pass_.context);
        for (JointSim& joint : joints_) solveJoint(joint, states_.data(), inertias_.data(), pass_.context, true);
        for (JointSim& joint : joints_) solveJoint(joint, states_.data(), inertias_.data(), pass_.context, false);
    }

    const JointKernels& kernels;

private:
    JointLanesView view() { return bundles_.view(sims_.data()); }
    int count() const { return bundles_.bundleCount(); }
    void add(const JointDef& def, std::uint32_t first, float turn, scenes::Dice& dice) {
        for (const std::uint32_t body : {first, first + 1}) {
            states_[body].invMass = 1;
            states_[body].v = {dice.between(-1, 1), dice.between(-1, 1), 0};
            states_[body].w = {dice.between(-1, 1), dice.between(-1, 1), 0};
            inertias_[body] = {20, 1, 2, 30, -1, 25, {}};
        }
        JointSim joint;
        joint.stateA = first;
        joint.stateB = first + 1;
        compileJoint(def, {}, {}, joint);
        const Quat turned = rotationAbout({1, 1, 0}, turn);
        prepareJoint(joint, {{0.25f, 0, 0}, {}, turned}, nullptr, nullptr, {});
        joints_.push_back(joint);
    }

    ConstraintGraph graph_;
    JointBundles bundles_;
    std::vector<JointSim> joints_;
    std::vector<JointSim*> sims_;
    std::vector<BodyState> states_;
    std::vector<BodyInertia> inertias_;
    JointPass pass_;
};

constexpr int kJoints = 2048;

JointBodies arms() {
    JointBodies bodies;
    bodies.frameA.position = {0.125f, 0, 0};
    bodies.frameB.position = {-0.125f, 0, 0};
    return bodies;
}
JointDef ball() { return BallDef{.bodies = arms()}; }
JointDef swingTwist() {
    return BallDef{.bodies = arms(), .swingLimit = 0.5f, .twistLimit = Range{-0.5f, 0.5f}, .friction = 0.5f};
}
JointDef hinge() { return HingeDef{.bodies = arms()}; }
JointDef limitedHinge() {
    return HingeDef{.bodies = arms(), .limit = Range{-0.5f, 0.5f}, .motor = Motor{1, 0.5f}, .friction = 0.5f};
}
JointDef drivenBall() { return BallDef{.bodies = arms(), .spring = Spring{.stiffness = 10, .damping = 1}}; }
JointDef fixed() { return FixedDef{.bodies = arms()}; }
JointDef rope() { return DistanceDef{.bodies = arms(), .limit = Range{0, 0.25f}}; }

void perJoint(benchmark::State& state) {
    state.counters["time/item"] =
        benchmark::Counter(kJoints, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void jointSubstep(benchmark::State& state, JointDef (*def)()) {
    JointRows rows(def(), static_cast<int>(state.range(0)), kJoints);
    for (auto _ : state) rows.substep();
    perJoint(state);
    state.SetLabel(rows.kernels.name);
}
void jointSubstepAlone(benchmark::State& state, JointDef (*def)()) {
    JointRows rows(def(), 4, kJoints);
    for (auto _ : state) rows.substepAlone();
    perJoint(state);
}
/// Into lanes and back, once per step.
void jointCopies(benchmark::State& state, JointDef (*def)()) {
    JointRows rows(def(), static_cast<int>(state.range(0)), kJoints);
    for (auto _ : state) {
        rows.load();
        rows.store();
    }
    perJoint(state);
    state.SetLabel(rows.kernels.name);
}

void laneCounts(benchmark::internal::Benchmark* bench) {
    bench->ArgName("lanes")->Arg(4)->Arg(8)->Arg(16)->Unit(benchmark::kMicrosecond);
}
#define RAGTOP_JOINT_BENCH(kind)                                    \
    BENCHMARK_CAPTURE(jointSubstep, kind, kind)->Apply(laneCounts); \
    BENCHMARK_CAPTURE(jointCopies, kind, kind)->Apply(laneCounts);  \
    BENCHMARK_CAPTURE(jointSubstepAlone, kind, kind)->Unit(benchmark::kMicrosecond)
RAGTOP_JOINT_BENCH(ball);
RAGTOP_JOINT_BENCH(swingTwist);
RAGTOP_JOINT_BENCH(drivenBall);
RAGTOP_JOINT_BENCH(hinge);
RAGTOP_JOINT_BENCH(limitedHinge);
RAGTOP_JOINT_BENCH(fixed);
RAGTOP_JOINT_BENCH(rope);

/// The margin of a swing in any direction.
void swingMargin(benchmark::State& state, const SwingLimit& limit) {
    constexpr int kDirections = 4096;
    scenes::Dice dice(5);
    std::vector<Vec3> directions;
    while (directions.size() < kDirections) {
        const Vec3 d{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
        if (const float l = length(d); l > 0.1f && l < 1) directions.push_back((1 / l) * d);
    }
    for (auto _ : state)
        for (const Vec3& d : directions) {
            SwingMargin sides[SwingLimit::kSides];
            swingMargins(limit, d, sides);
            benchmark::DoNotOptimize(sides);
        }
    state.counters["time/item"] =
        benchmark::Counter(kDirections, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
SwingLimit elliptic(float y, float z) {
    SwingLimit limit;
    limit.shape = SwingShape::ellipse;
    limit.y = y, limit.z = z;
    return limit;
}
/// Corners by turns near and far, so that half of them are concave.
SwingLimit reachOf(int corners) {
    ReachPolygon reach;
    reach.count = corners;
    for (int i = 0; i < corners; ++i) {
        const SinCos about = sinCos(2 * kPi * static_cast<float>(i) / static_cast<float>(corners));
        const SinCos from = sinCos(i % 2 == 0 ? 0.6f : 1.1f);
        reach.corners[static_cast<std::size_t>(i)].direction = {from.cos, from.sin * about.cos, from.sin * about.sin};
    }
    SwingLimit limit;
    compile(limit, reach);
    return limit;
}
BENCHMARK_CAPTURE(swingMargin, ellipse, elliptic(0.3f, 1.2f))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(swingMargin, wideEllipse, elliptic(2.2f, 0.6f))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(swingMargin, polygonOf6, reachOf(6))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(swingMargin, polygonOf12, reachOf(12))->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ragtop
