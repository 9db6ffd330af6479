// How finely a mechanism divides a substep.

#include <cmath>

#include "direct/mechanism.h"

namespace ragtop::direct {

namespace {

constexpr double kTurn = 1.0 / 8;  ///< rad per inner step that is aimed at
constexpr double kMostTurn = 0.5;  ///< rad per inner step, beyond which there is no answer
constexpr double kSwing = 0.5;     ///< rad of swinging across a tension, per inner step, that is aimed at
constexpr int kMostInnerSteps = 64;
constexpr std::size_t kMostBodySteps = 1024;  ///< inner steps of all bodies together
constexpr double kGain = 0.01;                ///< share of the kinetic energy that a substep may gain
constexpr double kGap = 1e-3;                 ///< gap that may be closed against what acts, in the longest arm

}  // namespace

/// A force F on an arm r makes a body swing across its line with ω² = F r/I.
void Mechanism::measureSwing(double h) {
    double largest = 0;
    for (const MechanismJoint& joint : joints_) {
        const double force = length(joint.force) / h;
        const auto end = [&](std::uint32_t index, const DVec3& arm) {
            if (index >= moving_) return;
            const DVec3 ease = bodies_[index].inverseMoments;
            const DVec3 squares{arm.x * arm.x, arm.y * arm.y, arm.z * arm.z};
            const double r = length(arm), all = ease.x + ease.y + ease.z;
            const double swing = r > 0 ? force * (r * all - dot(ease, squares) / r) : 0;
            if (swing > largest) largest = swing;
        };
        end(joint.a, joint.anchorA);
        end(joint.b, joint.anchorB);
    }
    fastestSwing_ = std::sqrt(largest);
}

double Mechanism::fastestTurn() const {
    double largest = 0;
    for (std::size_t i = 0; i < moving_; ++i) {
        const double w = dot(bodies_[i].w, bodies_[i].w);
        if (!(w <= largest)) largest = w;
    }
    return std::sqrt(largest);
}

/// How many inner steps turning and swinging ask for.
double Mechanism::need(double h) const {
    const double turn = h * fastestTurn() / kTurn, swing = h * fastestSwing_ / kSwing;
    return turn > swing ? turn : swing;
}

int Mechanism::mostInnerSteps() const {
    int most = 1;
    while (most < kMostInnerSteps && 2 * static_cast<std::size_t>(most) * moving_ <= kMostBodySteps) most *= 2;
    return most;
}

/// Where an inner step has no answer, or makes energy, the substep begins again with twice as many. Their number is
/// kept as long as it can be, since each change of it leaves a little energy behind.
bool Mechanism::advance(double h, double closing) {
    if (!ready_) measureSwing(h);
    const double wanted = need(h);
    const int most = mostInnerSteps();
    if (!(h * fastestTurn() <= most * kMostTurn)) return false;
    if (wanted > effort_.largestNeed) effort_.largestNeed = wanted;
    while (effort_.pace < wanted && effort_.pace < most) effort_.pace *= 2;
    for (std::size_t i = 0; i < moving_; ++i) startBodies_[i] = bodies_[i];
    for (std::size_t i = 0; i < poses_.size(); ++i) startPoses_[i] = poses_[i];
    const double before = energy();
    for (;; effort_.pace *= 2) {
        if (advanceBy(h, closing) && !gains(before, h)) return true;
        if (effort_.pace >= most) return false;
        for (std::size_t i = 0; i < moving_; ++i) bodies_[i] = startBodies_[i];
        for (std::size_t i = 0; i < poses_.size(); ++i) poses_[i] = startPoses_[i];
        ready_ = false;
        effort_.largestNeed = 2 * effort_.pace;
    }
}

bool Mechanism::advanceBy(double h, double closing) {
    for (int i = 0; i < effort_.pace; ++i)
        if (!step(h / effort_.pace, closing)) return false;
    return std::isfinite(fastestTurn());
}

/// Kinetic energy and what constant forces do from where poses are counted.
double Mechanism::energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < moving_; ++i) {
        const MechanismBody& body = bodies_[i];
        sum += (0.5 * dot(body.v, body.v) - dot(body.acceleration, poses_[i].x)) / body.inverseMass;
        sum += 0.5 * dot(body.w, body.momentum);
    }
    return sum;
}

/// More energy after a substep than before, by more than a second-order step errs by. What moves by itself does work.
bool Mechanism::gains(double before, double h) const {
    for (std::size_t i = moving_; i < bodies_.size(); ++i)
        if (dot(bodies_[i].v, bodies_[i].v) + dot(bodies_[i].w, bodies_[i].w) > 0) return false;
    double work = 0, kinetic = 0, allowed = 0;
    for (std::size_t i = 0; i < moving_; ++i) {
        const MechanismBody& body = bodies_[i];
        work += h * dot(body.torque, body.w);
        kinetic += 0.5 * (dot(body.v, body.v) / body.inverseMass + dot(body.w, body.momentum));
        allowed += length(body.acceleration) / body.inverseMass;
    }
    return !(energy() - before - work <= kGain * kinetic + kGap * reach_ * allowed + kGain * std::fabs(work));
}

}  // namespace ragtop::direct
