#include "bicycle.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace ragtop {
namespace {

/// BMW 320i of CommonRoad, in its own units (feet, slugs, pounds) converted as there [Althoff, Koschi, Manzinger,
/// CommonRoad, IV 2017; vehicle models 2020a].
constexpr double kFoot = 0.3048, kPound = 4.4482216152605, kG = 9.81;
struct Published {
    double mu = 1.0489, front = 21.92 / 1.0489, rear = 21.92 / 1.0489;
    double a = kFoot * 3.793293, b = kFoot * 4.667707, h = kFoot * 2.01355;
    double m = kPound / kFoot * 74.91452, I = kPound * kFoot * 1321.416;
};

Bicycle<double> bicycleOf(const Published& p) {
    const double length = p.a + p.b;
    const std::array<BicycleAxle<double>, 2> axles{
        {{p.a, p.m * kG * p.b / length, p.mu * p.front, 1}, {-p.b, p.m * kG * p.a / length, p.mu * p.rear, 0}}};
    return makeBicycle<double>(axles, p.m, p.I, p.h);
}

/// Rates of yaw rate and angle of drift as published.
std::array<double, 2> publishedRates(const Published& p, double v, double drift, double yaw, double angle, double acc) {
    const double L = p.a + p.b, f = kG * p.b - acc * p.h, r = kG * p.a + acc * p.h;
    const double c = p.mu * p.m / (p.I * L);
    return {-c / v * (p.a * p.a * p.front * f + p.b * p.b * p.rear * r) * yaw +
                c * (p.b * p.rear * r - p.a * p.front * f) * drift + c * p.a * p.front * f * angle,
            (p.mu / (v * v * L) * (p.rear * r * p.b - p.front * f * p.a) - 1) * yaw -
                p.mu / (v * L) * (p.rear * r + p.front * f) * drift + p.mu / (v * L) * p.front * f * angle};
}

/// The same by the law.
std::array<double, 2> ownRates(const Bicycle<double>& car, double v, double drift, double yaw, double angle,
                               double acc) {
    const LateralMotion<double> rate = lateralLaw(car, v, acc, angle).rate({v * drift, yaw});
    return {rate.yaw, rate.side / v};
}

TEST(Bicycle, HasTheSingleTrackDerivativesOfCommonRoad) {
    const Published p;
    const double v = 15.7216236334290116, limited = 11.5 * 7.319 / v;  // what its engine can do of 0.63 g
    const auto [yaw, drift] =
        ownRates(bicycleOf(p), v, 0.0033012170610298, 0.0529001056654038, 0.0197545248559617, limited);
    EXPECT_NEAR(yaw, 0.6435589397748606, 1e-9);
    EXPECT_NEAR(drift, 0.0313297971641291, 1e-9);
}

TEST(Bicycle, HasTheKinematicDerivativeOfCommonRoad) {
    EXPECT_NEAR(rollingMotion(bicycleOf({}), 16.3546957860883566, std::tan(0.0378491427211811)).yaw, 0.2401426578627629,
                1e-9);
}

TEST(Bicycle, HasThePublishedDerivativesOfAnyCar) {
    std::mt19937 random(7);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    for (int i = 0; i < 1000; ++i) {
        const Published p{between(0.1, 2), between(5, 30),  between(5, 30),    between(0.5, 4),
                          between(0.5, 4), between(0.1, 1), between(100, 4e4), between(100, 1e5)};
        const double v = between(0.5, 60), drift = between(-0.2, 0.2), yaw = between(-1, 1);
        const double angle = between(-0.5, 0.5), acc = between(-3, 3);
        const auto own = ownRates(bicycleOf(p), v, drift, yaw, angle, acc);
        const auto published = publishedRates(p, v, drift, yaw, angle, acc);
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}})
            EXPECT_NEAR(own[k], published[k], 1e-9 * (1 + std::abs(published[k]) + 1000 / v)) << i;
    }
}

/// m 1500, I 2500, a 1.2, b 1.4, axles of 80 and 100 kN/rad.
Bicycle<float> workedCar() {
    const float weight = 1500 * 9.81f, length = 2.6f;
    const float front = weight * 1.4f / length, rear = weight * 1.2f / length;
    const std::array<BicycleAxle<float>, 2> axles{{{1.2f, front, 80e3f / front, 1}, {-1.4f, rear, 100e3f / rear, 0}}};
    return makeBicycle<float>(axles, 1500, 2500, 0.5f);
}

/// Of yaw rates after a step of the angle by 1.
struct Step {
    float gain = 0, overshoot = 0, t90 = 0;
};
Step stepOf(float speed, float h) {
    const LateralLaw<float> law = lateralLaw(workedCar(), speed, 0.0f, 1.0f);
    LateralMotion<float> now;
    float most = 0;
    std::vector<float> yaws{0};
    for (int i = 0; i < static_cast<int>(10 / h); ++i) {
        now = lateralAfter(law, now, h);
        most = std::max(most, now.yaw);
        yaws.push_back(now.yaw);
    }
    Step step{now.yaw, most / now.yaw - 1, 0};
    std::size_t k = 1;
    while (yaws[k] < 0.9f * step.gain) ++k;
    const float share = (0.9f * step.gain - yaws[k - 1]) / (yaws[k] - yaws[k - 1]);
    step.t90 = h * (static_cast<float>(k - 1) + share);
    return step;
}

TEST(Bicycle, StepsAsItsLinearSystemDoes) {
    struct Known {
        float speed, gain, overshoot, t90;
    };
    // Figures of docs/vehicles.md; digits that are not given are its tolerance.
    for (const Known& known : {Known{10, 3.4278f, 0.0002f, 0.186f}, Known{20, 5.1690f, 0.036f, 0.219f},
                               Known{30, 5.4988f, 0.155f, 0.189f}}) {
        const Step step = stepOf(known.speed, 1e-3f);
        EXPECT_NEAR(step.gain, known.gain, 2e-4f * known.gain);
        EXPECT_NEAR(step.overshoot, known.overshoot, 1e-3f);
        EXPECT_NEAR(step.t90, known.t90, 1e-3f);
    }
}

TEST(Bicycle, IsWhereItIsWhateverTheStep) {
    for (const float speed : {0.01f, 1.0f, 10.0f, 40.0f, -5.0f}) {
        const LateralLaw<float> law = lateralLaw(workedCar(), speed, 0.0f, 0.05f);
        const LateralMotion<float> from{0.3f, -0.1f}, once = lateralAfter(law, from, 0.1f);
        LateralMotion<float> often = from;
        for (int i = 0; i < 100; ++i) often = lateralAfter(law, often, 1e-3f);
        // Each step rounds once.
        EXPECT_NEAR(once.side, often.side, 100 * 3e-7f * (1 + std::abs(often.side)));
        EXPECT_NEAR(once.yaw, often.yaw, 100 * 3e-7f * (1 + std::abs(often.yaw)));
    }
}

TEST(Bicycle, RollsWithoutSlipAtNoSpeed) {
    const float speed = 0.01f, angle = 0.1f;
    const LateralMotion<float> law = lateralAfter(lateralLaw(workedCar(), speed, 0.0f, angle), {}, 1);
    const LateralMotion<float> rolls = rollingMotion(workedCar(), speed, angle);
    EXPECT_NEAR(law.yaw, rolls.yaw, 1e-4f * rolls.yaw);
    EXPECT_NEAR(law.side, rolls.side, 1e-4f * rolls.side);
    EXPECT_NEAR(rolls.yaw, speed * angle / 2.6f, 1e-6f * speed);
}

}  // namespace
}  // namespace ragtop
