#include "ragtop/fixed_stepper.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace ragtop {

FixedStepper::FixedStepper(double step, int maxSteps) : step_(step), maxSteps_(maxSteps) {
    std::ostringstream why;
    if (!(step > 0 && std::isfinite(step))) {
        why << "step is " << step << " s; allowed are finite numbers above 0";
    } else if (maxSteps < 1) {
        why << "maxSteps is " << maxSteps << "; allowed are 1 and more";
    }
    if (why.tellp() > 0) throw std::invalid_argument(why.str());
}

FixedStepper::Steps FixedStepper::advance(double frameTime) {
    if (frameTime > 0) accumulator_ += frameTime;
    int count = 0;
    for (; count < maxSteps_ && accumulator_ >= step_; ++count) accumulator_ -= step_;
    if (accumulator_ >= step_) {
        // What is left of a step stays, so that the picture goes on smoothly.
        const double rest = std::isfinite(accumulator_) ? std::fmod(accumulator_, step_) : 0;
        dropped_ += accumulator_ - rest;
        accumulator_ = rest;
    }
    return {count, step_};
}

void FixedStepper::remember(const World& world) {
    generations_.assign(generations_.size(), 0);
    for (const BodyId body : world.bodies()) {
        if (body.index >= previous_.size()) {
            previous_.resize(body.index + std::size_t{1});
            generations_.resize(body.index + std::size_t{1}, 0);
        }
        previous_[body.index] = world.pose(body);
        generations_[body.index] = body.generation;
    }
}

Pose FixedStepper::blended(const World& world, BodyId body) const {
    const Pose now = world.pose(body);
    // A body made since then has no earlier pose.
    if (body.index >= previous_.size() || generations_[body.index] != body.generation) return now;
    return blend(previous_[body.index], now, blendFactor());
}

}  // namespace ragtop
