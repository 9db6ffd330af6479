#include "base/worker_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace ragtop {
namespace {

constexpr float kSize = 1000;
constexpr float kWay = 1e-6f;  ///< s per unit of size that a way takes whose share is 1

/// What each way of sharing takes, in shares of kWay.
struct Machine {
    float all = 1, alone = 1, outsideSolve = 1, half = 1;

    float of(const Sharing& sharing, int workers) const {
        if (sharing.workers == 1) return alone;
        if (sharing.workers < workers) return half;
        return sharing.shareSolve ? all : outsideSolve;
    }
    float best(int workers) const { return std::min({all, alone, outsideSolve, workers >= 4 ? half : all}); }
};

struct Played {
    double time = 0, least = 0;  ///< in shares of kWay, and what it would have been with the best way in each step
    Sharing last;
    std::set<int> workers;
};

/// Steps that take what the machine says, and up to `noise` longer.
Played play(WorkerChoice& choice, int workers, const Machine& machine, int steps, float noise = 0, float size = kSize) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> longer(0, noise);
    Played run;
    for (int i = 0; i < steps; ++i) {
        const Sharing sharing = choice.next();
        const float share = machine.of(sharing, workers);
        run.time += static_cast<double>(share);
        run.least += static_cast<double>(machine.best(workers));
        run.workers.insert(sharing.workers);
        choice.note(kWay * size * share * (1 + longer(random)), size);
        run.last = choice.next();
    }
    return run;
}

TEST(WorkerChoice, OneWorkerIsNoChoice) {
    WorkerChoice choice(1);
    const Played run = play(choice, 1, {}, 500);
    EXPECT_EQ(run.workers, std::set<int>{1});
}

TEST(WorkerChoice, EachWayIsTriedAtTheBeginning) {
    WorkerChoice choice(16);
    EXPECT_EQ(choice.next(), (Sharing{16, true}));
    const Played run = play(choice, 16, {}, 8 * WorkerChoice::kTrial);
    EXPECT_EQ(run.workers, (std::set<int>{1, 8, 16}));
}

TEST(WorkerChoice, TheFastestWayIsFound) {
    struct Case {
        int workers;
        Machine machine;
        Sharing expected;
    };
    const std::vector<Case> cases = {
        {2, {.all = 0.6f}, {2, true}},
        {2, {.all = 1.4f, .outsideSolve = 1.1f}, {1, false}},
        {2, {.all = 1.1f, .outsideSolve = 0.9f}, {2, false}},
        {16, {.all = 0.5f, .half = 0.4f}, {8, true}},
        {16, {.all = 0.2f, .half = 0.4f}, {16, true}},
    };
    for (const Case& c : cases)
        for (const float noise : {0.0f, 0.1f}) {
            WorkerChoice choice(c.workers);
            play(choice, c.workers, c.machine, 64, noise);
            std::size_t chosen = 0;
            for (int i = 0; i < 500; ++i) {
                chosen += choice.next() == c.expected ? 1u : 0u;
                play(choice, c.workers, c.machine, 1, noise);
            }
            EXPECT_GT(chosen, 450u) << c.expected.workers << c.expected.shareSolve;
        }
}

/// Trials cost kCost, and a way that is slower by kWorth is not told from the fastest.
TEST(WorkerChoice, WhatTrialsCostIsBounded) {
    constexpr int kSteps = 20000;
    for (const int workers : {2, 16})
        for (const float slower : {1.02f, 1.1f, 1.5f, 2.0f, 4.0f})
            for (const bool alone : {false, true}) {
                Machine machine{slower, slower, slower, slower};
                (alone ? machine.alone : machine.all) = 1;
                WorkerChoice choice(workers);
                const Played run = play(choice, workers, machine, kSteps);
                // The first trials, before anything is known: of three ways, and again soon after another one won.
                const double first = 8 * WorkerChoice::kTrial * static_cast<double>(slower - 1);
                const double bound = static_cast<double>(WorkerChoice::kCost + (slower < 1.04f ? WorkerChoice::kWorth : 0));
                EXPECT_LT(run.time, run.least * (1 + bound) + first) << workers << " workers, " << slower;
            }
}

TEST(WorkerChoice, FollowsAMachineThatChanges) {
    const Machine near{.all = 0.6f, .outsideSolve = 0.8f}, far{.all = 1.4f, .outsideSolve = 1.2f};
    WorkerChoice choice(2);
    play(choice, 2, near, 2000);
    EXPECT_EQ(choice.next().workers, 2);
    // A trial of what lost by 67 % waits for 4 · 0.67 · 2/kCost steps.
    play(choice, 2, far, 600);
    EXPECT_EQ(choice.next().workers, 1);
    play(choice, 2, near, 600);
    EXPECT_EQ(choice.next().workers, 2);
}

/// A step of a hundred times the usual length, because something else had the processor or a system was factorized, falls
/// into the first trial of a way that is no faster then. When it is, later, that is found as if it had not been disturbed.
TEST(WorkerChoice, OneLongStepDoesNotBarAWay) {
    for (int disturbed = 0; disturbed < WorkerChoice::kTrial; ++disturbed) {
        WorkerChoice choice(2);
        int alone = 0;
        for (int i = 0; i < 400; ++i) {
            const Sharing sharing = choice.next();
            const Machine machine{.all = i < 50 ? 1.0f : 1.2f, .outsideSolve = 1.2f};
            const bool isLong = sharing.workers == 1 && alone++ == disturbed;
            choice.note(kWay * kSize * machine.of(sharing, 2) * (isLong ? 100.0f : 1.0f), kSize);
        }
        EXPECT_EQ(choice.next().workers, 1) << disturbed;
    }
}

/// Something else has a processor just when helpers are held against the calling thread alone.
TEST(WorkerChoice, ADisturbanceIsForgottenSoon) {
    const Machine machine{.all = 0.6f};
    WorkerChoice choice(2);
    play(choice, 2, machine, 200);
    WorkerChoice foreseen = choice;
    int steps = 0;
    for (; foreseen.next().workers == 2; ++steps) play(foreseen, 2, machine, 1);
    ASSERT_GT(steps, WorkerChoice::kTrial);
    play(choice, 2, machine, steps - WorkerChoice::kTrial);
    play(choice, 2, {.all = 3}, 2 * WorkerChoice::kTrial);
    ASSERT_EQ(choice.next().workers, 1);
    play(choice, 2, machine, static_cast<int>(WorkerChoice::kFirstWait) + 4 * WorkerChoice::kTrial);
    EXPECT_EQ(choice.next(), (Sharing{2, true}));
}

TEST(WorkerChoice, AGrowingSceneIsNoReasonToChange) {
    const Machine machine{.all = 0.9f};
    WorkerChoice choice(2);
    play(choice, 2, machine, 64);
    int others = 0;
    float size = kSize;
    for (int i = 0; i < 400; ++i) {
        size *= i % 40 == 20 ? 2.0f : i % 40 == 39 ? 0.5f : 1.01f;
        if (i % 40 == 39) size = kSize;
        others += choice.next() == Sharing{2, true} ? 0 : 1;
        play(choice, 2, machine, 1, 0, size);
    }
    EXPECT_LT(others, 400 / 8);
    EXPECT_EQ(choice.next(), (Sharing{2, true}));
}

TEST(WorkerChoice, StepsWithoutSizeOrTimeTellNothing) {
    WorkerChoice choice(2);
    for (int i = 0; i < 100; ++i) choice.note(1e-3f, 0);
    for (int i = 0; i < 100; ++i) choice.note(0, 100);
    EXPECT_EQ(choice.next(), (Sharing{2, true}));
}

}  // namespace
}  // namespace ragtop
