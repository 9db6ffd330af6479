#include "contender.h"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <memory_resource>
#include <stdexcept>

#include "../../tests/core/heap_counter.h"
#include "../stability/adapters/ragtop.h"
#include "../stability/extremes.h"
#include "../stability/scenery.h"
#include "builder.h"

namespace ragtop::speed {

double now(Clock clock) {
    timespec time{};
    clock_gettime(clock == Clock::wall ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

namespace {

using stability::Engine;

constexpr double kStep = 1.0 / 60;
constexpr int kStepsPerSample = 30;  // of quality
constexpr int kSteadySteps = 60;     // in which allocations count
constexpr int kStepsPerNudge = 60;

/// The heap, counted.
class CountedMemory : public std::pmr::memory_resource {
public:
    std::size_t peak() const { return peak_; }

private:
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
        const std::size_t held = held_ += bytes;
        std::size_t peak = peak_;
        while (held > peak && !peak_.compare_exchange_weak(peak, held)) {
        }
        return std::pmr::new_delete_resource()->allocate(bytes, alignment);
    }
    void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
        held_ -= bytes;
        std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
    }
    bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

    std::atomic<std::size_t> held_{0}, peak_{0};
};

/// Steps an engine through the windows of a course.
class Player {
public:
    Player(const Course& course, Engine& engine, Clock clock, Purpose purpose)
        : course_(course), scene_(course.scene), engine_(engine), clock_(clock), purpose_(purpose) {}
    virtual ~Player() = default;

    std::vector<WindowResult> play() {
        std::vector<WindowResult> results;
        for (const Window& window : course_.windows) {
            for (const BodyDef& def : window.arrivals) {
                stability::add(scene_, def);
                engine_.add(def);
            }
            WindowResult result = play(window);
            if (!window.name.empty()) results.push_back(std::move(result));
        }
        return results;
    }

protected:
    virtual void beginWindow() {}
    virtual void noteStep() {}
    virtual std::optional<Work> endWindow(int /*steps*/, long /*allocations*/) { return {}; }

private:
    WindowResult play(const Window& window) {
        WindowResult result;
        result.name = window.name;
        beginWindow();
        double total = 0;
        Quality worst;
        long heapBefore = heapCalls(), other = 0;
        for (int i = 0; i < window.steps; ++i) {
            if (i + kSteadySteps == window.steps) heapBefore = heapCalls(), other = 0;
            const long heapBeforeNudge = heapCalls();
            if (course_.nudged && i % kStepsPerNudge == kStepsPerNudge / 2) nudge();
            other += heapCalls() - heapBeforeNudge;
            const double before = now(clock_);
            engine_.step(kStep);
            const double taken = now(clock_) - before;
            total += taken;
            result.worstMs = std::max(result.worstMs, taken);
            const long heapAfterStep = heapCalls();
            noteStep();
            if (purpose_ == Purpose::quality && (i + 1) % kStepsPerSample == 0)
                addQualityOnTheWay(scene_, engine_, worst);
            other += heapCalls() - heapAfterStep;
        }
        result.ms = total / window.steps;
        result.work = endWindow(window.steps, heapCalls() - heapBefore - other);
        if (purpose_ == Purpose::times || window.name.empty()) return result;
        result.quality = measureQuality(scene_, engine_);
        if (worst.gap) result.quality->gap = stability::larger(*worst.gap, *result.quality->gap);
        if (worst.below) result.quality->below = stability::larger(*worst.below, *result.quality->below);
        return result;
    }

    /// Gives some body that moves a speed of 0.1 m/s more, along the floor.
    void nudge() {
        constexpr double kSpeed = 0.1;
        std::size_t body = 0;
        do body = dice_.bits() % scene_.bodies.size();
        while (scene_.bodies[body].def.type != BodyType::dynamic);
        const auto force = static_cast<float>(kSpeed / kStep) * stability::massOf(scene_.bodies[body].def).mass;
        const int at = static_cast<int>(body);
        engine_.push(at, {0.6f * force, 0, 0.8f * force}, engine_.motion(at).pose.position);
    }

    const Course& course_;
    Scene scene_;
    Engine& engine_;
    Clock clock_;
    Purpose purpose_;
    PeerDice dice_{31};
};

/// Also reads what the world tells of its steps.
class RagtopPlayer : public Player {
public:
    RagtopPlayer(const Course& course, stability::RagtopEngine& engine, const CountedMemory& memory, Clock clock,
                 Purpose purpose)
        : Player(course, engine, clock, purpose), world_(engine.world()), memory_(memory) {}

private:
    void beginWindow() override {
        stages_.clear();
        bodies_.clear();
        awake_ = residual_ = 0;
        directSteps_ = 0;
    }
    void noteStep() override {
        const StepStats stats = world_.stats();
        for (std::size_t i = 0; i < stats.stages.size(); ++i) {
            if (stages_.size() <= i) stages_.emplace_back(stats.stages[i].name, 0.0);
            stages_[i].second += stats.stages[i].ms;
        }
        double worst = 0;
        awake_ += stats.awakeBodies;
        for (const StepStats::Island& island : stats.islands) {
            bodies_[island.reason] += island.bodies;
            worst = std::max(worst, island.residual);
        }
        if (stats.islands.empty()) return;
        residual_ += worst;
        ++directSteps_;
    }
    std::optional<Work> endWindow(int steps, long allocations) override {
        Work work;
        work.allocations = allocations;
        work.stages = stages_;
        for (auto& [name, ms] : work.stages) ms /= steps;
        double swept = awake_;
        for (const auto& [reason, bodies] : bodies_) {
            work.solverMix[reason] = bodies / awake_;
            swept -= bodies;
        }
        if (awake_ > 0) work.solverMix["swept"] = swept / awake_;
        if (directSteps_ > 0) work.residual = residual_ / directSteps_;
        work.peakBytes = memory_.peak();
        return work;
    }

    const World& world_;
    const CountedMemory& memory_;
    std::vector<std::pair<std::string, double>> stages_;
    std::map<std::string, double> bodies_;  // that were solved directly, by reason, summed over steps
    double awake_ = 0, residual_ = 0;
    int directSteps_ = 0;
};

}  // namespace

std::vector<WindowResult> playRagtop(const Course& course, int threads, int lanes, Clock clock, Purpose purpose) {
    CountedMemory memory;
    WorldConfig config;
    config.tasks = threads > 1 ? threadTasks(threads) : serialTasks();
    config.lanes = lanes;
    config.memory = &memory;
    stability::RagtopEngine engine(course.scene, course.scene.settings, config);
    return RagtopPlayer(course, engine, memory, clock, purpose).play();
}

#ifdef RAGTOP_WITH_BULLET
std::vector<WindowResult> playBullet(const Course& course, Clock clock, Purpose purpose) {
    const auto engine = stability::makeBullet(course.scene, {.yardstick = true});
    return Player(course, *engine, clock, purpose).play();
}
bool hasBullet() { return true; }
#else
std::vector<WindowResult> playBullet(const Course&, Clock, Purpose) {
    throw std::runtime_error("built without Bullet");
}
bool hasBullet() { return false; }
#endif

}  // namespace ragtop::speed
