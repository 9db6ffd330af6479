#pragma once

#include <algorithm>
#include <vector>

#include "ragtop/body.h"
#include "ragtop/world.h"

namespace ragtop {

/// Turns a game's frame times into fixed steps and blends poses between them:
///
///     for (double dt : stepper.advance(frameTime)) { stepper.remember(world); world.step(dt); }
///     draw(stepper.blended(world, body));
class FixedStepper {
public:
    /// `step` in s, above zero. At most `maxSteps` are made per frame; time beyond that is dropped, so that a slow
    /// machine slows the game rather than stopping it. Throws std::invalid_argument.
    explicit FixedStepper(double step = 1.0 / 60, int maxSteps = 4);

    /// The steps to make for a frame that took `frameTime` s (negative and NaN count as zero).
    class Steps {
    public:
        struct End {};
        struct Iterator {
            int left;
            double step;
            double operator*() const { return step; }
            Iterator& operator++() { --left; return *this; }
            bool operator!=(End) const { return left > 0; }
        };
        Steps(int count, double step) : count_(count), step_(step) {}
        Iterator begin() const { return {count_, step_}; }
        End end() const { return {}; }
        int count() const { return count_; }

    private:
        int count_;
        double step_;
    };
    Steps advance(double frameTime);

    /// Time since the last step over the step, in [0, 1).
    double blendFactor() const { return accumulator_ / step_; }
    /// Seconds that were dropped so far because frames took longer than maxSteps.
    double dropped() const { return dropped_; }

    /// Keeps the poses before a step; call it before World::step.
    void remember(const World& world);
    /// The pose at which to draw a body now, between the remembered and the current one.
    Pose blended(const World& world, BodyId body) const;

private:
    double step_;
    int maxSteps_;
    double accumulator_ = 0;
    double dropped_ = 0;
    std::vector<Pose> previous_;
    std::vector<std::uint32_t> generations_;
};

}  // namespace ragtop
