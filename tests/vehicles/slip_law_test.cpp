#include "slip_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "road.h"
#include "tire.h"

/// Tires by the Magic Formula and by curves: the law, and the tire that comes to it.
namespace ragtop {
namespace {

constexpr float kSlipLoad = 4000;  // N
constexpr double kDegree = 3.14159265358979 / 180;

MagicFormulaDef magicOf(std::initializer_list<std::pair<std::string_view, float>> numbers) {
    MagicFormulaDef def;
    for (std::size_t i = 0; i < def.values.size(); ++i) {
        const std::string_view name = kMagicCoefficients[i].tunable.name;
        const bool isScale = name.front() == 'L';
        const bool isNeeded = name == "PCX1" || name == "PDX1" || name == "PKX1" || name == "PKY4";
        if (!isScale && !isNeeded && kMagicCoefficients[i].tunable.unit == "1") def.values[i] = 0;
        for (const auto& [key, value] : numbers) {
            if (key == name) def.values[i] = value;
        }
    }
    return def;
}

/// The set of CommonRoad's vehicle models, its terms of load left out and its lateral shifts.
MagicFormulaDef commonRoad() {
    return magicOf({{"FITTYP", 52},        {"FNOMIN", 4000},   {"PCX1", 1.6411f},    {"PDX1", 1.1739f},
                    {"PEX1", 0.46403f},    {"PKX1", 22.303f},  {"PHX1", 1.2297e-3f}, {"PVX1", -8.8098e-6f},
                    {"RBX1", 13.276f},     {"RBX2", -13.778f}, {"RCX1", 1.2568f},    {"REX1", 0.65225f},
                    {"RHX1", 5.0722e-3f},  {"PCY1", 1.3507f},  {"PDY1", 1.0489f},    {"PEY1", -7.4722e-3f},
                    {"PKY1", -21.92f},     {"PKY2", 1},        {"RBY1", 7.1433f},    {"RBY2", 9.1916f},
                    {"RBY3", -2.7856e-2f}, {"RCY1", 1.0719f},  {"REY1", -0.27572f},  {"RHY1", 5.7448e-6f}});
}

SlipLaw lawOf(const MagicFormulaDef& def, float inclination = 0, float load = kSlipLoad) {
    return magicFactors(def, {1, 1, load, inclination});
}

/// Slip over the speed of travel of a slip ratio and a slip angle to the left.
Vec2 slipOf(double kappa, double alpha) {
    return {static_cast<float>(kappa * std::cos(alpha)), static_cast<float>(-std::sin(alpha))};
}

TEST(MagicFormula, MeetsThePublishedFormulaAlongTheWheel) {
    const SlipLaw law = lawOf(commonRoad());
    for (const auto& [kappa, force] : {std::pair{0.01, 986.3}, std::pair{0.05, 3514.0}, std::pair{0.1, 4539.9},
                                       std::pair{0.2, 4627.3}, std::pair{0.5, 3926.6}, std::pair{1.0, 3368.1}}) {
        EXPECT_NEAR(static_cast<double>(kSlipLoad * forceOverLoad(law, slipOf(kappa, 0)).x), force, 1e-3 * force)
            << kappa;
    }
    double peak = 0, at = 0;
    for (double kappa = 0; kappa < 1; kappa += 1e-3) {
        const auto force = static_cast<double>(kSlipLoad * forceOverLoad(law, slipOf(kappa, 0)).x);
        if (force > peak) at = kappa;
        peak = std::max(peak, force);
    }
    EXPECT_NEAR(peak, 4695.6, 4.7);
    EXPECT_NEAR(at, 0.149, 2e-3);
}

TEST(MagicFormula, MeetsThePublishedFormulaAcrossTheWheel) {
    const SlipLaw law = lawOf(commonRoad());
    for (const auto& [degrees, force] : {std::pair{1.0, 1463.5}, std::pair{2.0, 2602.8}, std::pair{4.0, 3765.5},
                                         std::pair{6.0, 4116.6}, std::pair{8.0, 4193.3}, std::pair{15.0, 4089.4}}) {
        // A wheel that drifts to the left is pushed to the right.
        for (const double side : {1.0, -1.0}) {
            const auto found =
                static_cast<double>(kSlipLoad * forceOverLoad(law, slipOf(0, side * degrees * kDegree)).y);
            EXPECT_NEAR(found, -side * force, 1e-3 * force) << degrees;
        }
    }
}

/// The formula again in double precision and by the C library, for pure slip at right angles and for locked wheels.
TEST(MagicFormula, HoldsForLockedWheelsAndAtRightAngles) {
    const auto magic = [](double B, double C, double D, double E, double x) {
        return D * std::sin(C * std::atan(B * x - E * (B * x - std::atan(B * x))));
    };
    const SlipLaw law = lawOf(commonRoad());
    const double Dx = 1.1739 * 4000, Bx = 22.303 * 4000 / (1.6411 * Dx);
    const double locked = magic(Bx, 1.6411, Dx, 0.46403, -1 + 1.2297e-3) - 8.8098e-6 * 4000;
    EXPECT_NEAR(static_cast<double>(kSlipLoad * forceOverLoad(law, {-1, 0}).x), locked, 1e-3 * std::abs(locked));
    const double Dy = 1.0489 * 4000, By = -21.92 * 4000 / (1.3507 * Dy);
    const double across = magic(By, 1.3507, Dy, -7.4722e-3, 90 * kDegree);
    EXPECT_NEAR(static_cast<double>(kSlipLoad * forceOverLoad(law, {0, -1}).y), across, 1e-3 * std::abs(across));
}

/// Camber to the right pushes to the right: K_γ γ at no slip angle, in version 6.1.
TEST(MagicFormula, PushesToWhereItLeans) {
    const MagicFormulaDef def = magicOf({{"FITTYP", 61},
                                         {"PCY1", 1.3f},
                                         {"PDY1", 1},
                                         {"PKY1", -20},
                                         {"PKY2", 1.5f},
                                         {"PKY4", 2},
                                         {"PKY6", -0.9f},
                                         {"PVY3", -0.2f}});
    const float lean = 0.05f;
    EXPECT_NEAR(forceOverLoad(lawOf(def, lean), {}).y, -0.9f * lean, 2e-3f * 0.9f * lean);
    EXPECT_NEAR(forceOverLoad(lawOf(def, -lean), {}).y, 0.9f * lean, 2e-3f * 0.9f * lean);
    EXPECT_NEAR(forceOverLoad(lawOf(def, 0), {}).y, 0, 1e-6f);
}

/// With a trail and nothing else Mz = −t F_y: it turns the wheel to where it goes, and fades as the tire slides.
TEST(MagicFormula, TurnsItsWheelByTheTrailOfItsForce) {
    const MagicFormulaDef def = magicOf({{"PCY1", 1.3f},
                                         {"PDY1", 1},
                                         {"PKY1", -20},
                                         {"PKY2", 1.5f},
                                         {"PKY4", 2},
                                         {"QBZ1", 10},
                                         {"QCZ1", 1.2f},
                                         {"QDZ1", 0.1f}});
    const SlipLaw law = lawOf(def);
    const float angle = 1e-3f;
    const Vec2 slip = slipOf(0, static_cast<double>(angle));
    const float force = forceOverLoad(law, slip).y;
    ASSERT_LT(force, 0);
    const auto alignmentAt = [&](const Vec2& at, float forward) {
        return alignmentOverLoad(law, at, forcesOverLoad(law, at), forward);
    };
    EXPECT_NEAR(alignmentAt(slip, 1), -0.3f * 0.1f * force, 1e-3f * 0.03f * std::abs(force));
    EXPECT_NEAR(alignmentAt(slip, -1), 0.3f * 0.1f * force, 1e-3f * 0.03f * std::abs(force));
    EXPECT_LT(std::abs(alignmentAt(slipOf(0, 1.2), 1)), 0.2f * 0.03f);
}

/// Brakes take of what is left for cornering: the weights are 1 without the other slip and fall with it.
TEST(MagicFormula, CombinesSlips) {
    const SlipLaw law = lawOf(commonRoad());
    const double angle = 4 * kDegree;
    double before = 1e9;
    for (const double kappa : {0.0, -0.02, -0.05, -0.1, -0.3, -1.0}) {
        const Vec2 force = forceOverLoad(law, slipOf(kappa, angle));
        EXPECT_LT(std::hypot(force.x / 1.18f, force.y / 1.05f), 1.12f) << kappa;
        EXPECT_LT(static_cast<double>(std::abs(force.y)), before * 1.01) << kappa;
        before = static_cast<double>(std::abs(force.y));
    }
}

TEST(SlipCurves, GoThroughTheirPoints) {
    const SlipCurvesDef def;
    const SlipLaw law = slipCurves(def, {});
    EXPECT_NEAR(forceOverLoad(law, {def.longitudinal.peakSlip, 0}).x, def.longitudinal.peakFriction, 1e-6f);
    EXPECT_NEAR(forceOverLoad(law, {-def.longitudinal.slideSlip, 0}).x, -def.longitudinal.slideFriction, 1e-6f);
    EXPECT_NEAR(forceOverLoad(law, {-1, 0}).x, -def.longitudinal.slideFriction, 1e-6f);
    EXPECT_NEAR(forceOverLoad(law, {0, 0.5f * def.lateral.peakSlip}).y, 0.75f * def.lateral.peakFriction, 1e-6f);
    EXPECT_NEAR(forceOverLoad(law, {0, 1}).y, def.lateral.slideFriction, 1e-6f);
    const Vec2 both = forceOverLoad(law, {def.longitudinal.peakSlip, def.lateral.peakSlip});
    EXPECT_LT(std::hypot(both.x / def.longitudinal.peakFriction, both.y / def.lateral.peakFriction), 1);
}

TEST(SlipLaw, KnowsExponentials) {
    for (float x = -20; x < 20; x += 0.37f) {
        EXPECT_NEAR(exponential(x) / std::exp(x), 1, 2e-6f) << x;
    }
}

TireDef magicTire() {
    TireDef def;
    def.magicFormula = commonRoad();
    return def;
}

/// A tire at a given motion of its wheel, over so many metres or seconds.
struct SlipRig {
    TireSpec spec;
    Vec2 u, force;

    explicit SlipRig(const TireDef& def) : spec(makeTireSpec(def, kSlipLoad, kGravity)) {}
    void run(const Vec2& travel, float tread, float h, int steps) {
        const float transport = std::sqrt(travel.x * travel.x + travel.y * travel.y);
        const Vec2 slip{travel.x - tread, travel.y};
        for (int i = 0; i < steps; ++i) {
            const TireLaw law = tireLaw(spec, {}, {travel, tread}, kSlipLoad, transport);
            TireLine line = tireLine(law, u);
            TireVisit visit;
            for (int k = 0; k < 6; ++k) {
                visit = solveTire(law, line, u, transport, kSlipLoad * h, h, {}, slip);
                line = lineAfter(law, deflectionAfter(law, line, u, visit, slip, transport, kSlipLoad * h, h),
                                 visit.sliding);
            }
            force = {visit.impulse.x / h, visit.impulse.y / h};
            u = withinPatch(law, rolledDeflection(law, u, slip, transport, h));
        }
    }
};

/// Whatever the speed, the step and the slip, combined ones, locked wheels and right angles too: the tire comes to its
/// law.
TEST(SlipLaw, IsWhatATireComesTo) {
    TireDef curves;
    curves.slipCurves = SlipCurvesDef{};
    for (const TireDef& def : {magicTire(), curves}) {
        for (const float hz : {120.0f, 1000.0f}) {
            for (const float speed : {5.0f, 30.0f}) {
                for (const double angle : {0.0, 3 * kDegree, -8 * kDegree, 45 * kDegree, 90 * kDegree}) {
                    for (const double kappa : {0.0, 0.03, -0.1, -0.5, -1.0}) {
                        SlipRig rig(def);
                        const Vec2 travel{speed * static_cast<float>(std::cos(angle)),
                                          speed * static_cast<float>(std::sin(angle))};
                        const float tread = travel.x * static_cast<float>(1 + kappa);
                        rig.run(travel, tread, 1 / hz, static_cast<int>(hz * (0.5f + 4 / speed)));
                        const TireLaw law = tireLaw(rig.spec, {}, {}, kSlipLoad, 0);
                        const Vec2 expected = forceOverLoad(law.slips, slipOf(kappa, angle));
                        EXPECT_NEAR(rig.force.x, kSlipLoad * expected.x, 1e-3f * kSlipLoad)
                            << angle << " " << kappa << " " << hz;
                        EXPECT_NEAR(rig.force.y, kSlipLoad * expected.y, 1e-3f * kSlipLoad)
                            << angle << " " << kappa << " " << hz;
                    }
                }
            }
        }
    }
}

VehicleDef onTires(const TireDef& tire) {
    VehicleDef def = plainTires(1);
    // In the ground, so that loads stay: what the law says of one tire is then what the car does.
    def.chassis.centerOfMass = Vec3{0, 0, 0};
    for (WheelDef& wheel : def.wheels) {
        wheel.tire = tire;
        wheel.tire.rollingResistance = 0;
        wheel.brakeTorque = 3000;
        wheel.handbrakeTorque = wheel.driveShare = wheel.steerFactor = 0;
    }
    def.wheels[0].driveShare = def.wheels[1].driveShare = 1;
    return def;
}

/// m from 30 m/s to 10 m/s at a pedal.
double brakingDistance(const VehicleDef& def, float pedal, double dt) {
    Road road(0, awake());
    Vehicle car(road.world, def, {.position = {}, .speed = 32});
    car.input.clutch = 1;
    run(road.world, 0.5, dt);
    car.input.brake = pedal;
    double from = -1;
    for (double t = 0; t < 8; t += dt) {
        road.world.step(dt);
        const float speed = car.telemetry().speed;
        const double z = road.world.pose(car.chassis()).position.z;
        if (from < 0 && speed < 30) from = z;
        if (speed < 10) return z - from;
    }
    return 1e9;
}

/// A locked wheel slows the car by what the law says of it, and the best pedal by the law's peak, at any step.
TEST(SlipLaw, BestPedalBeatsLockedWheelsByWhatTheLawSays) {
    TireDef curves;
    curves.slipCurves = SlipCurvesDef{};
    for (const auto& [tire, peak, locked] :
         {std::tuple{magicTire(), 1.1739, 0.84203}, std::tuple{curves, 1.05, 0.85}}) {
        const VehicleDef def = onTires(tire);
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
            const double way = (30 * 30 - 10 * 10) / (2 * 9.81);
            const double sliding = brakingDistance(def, 1, dt);
            EXPECT_NEAR(sliding, way / locked, 0.02 * way / locked) << dt;
            double best = sliding;
            const double most = peak * 1200 * 9.81 / 4 * 0.3;
            // Torque slows the wheels too.
            for (double share = 0.99; share < 1.07; share += 0.005)
                best = std::min(best, brakingDistance(def, static_cast<float>(share * most / 3000), dt));
            EXPECT_NEAR(sliding / best, peak / locked, 0.02 * peak / locked) << dt;
        }
    }
}

/// Braked on a slope for a minute, at any heading: at rest the law is a spring.
TEST(SlipLaw, HoldsACarOnASlope) {
    TireDef curves;
    curves.slipCurves = SlipCurvesDef{};
    for (const TireDef& tire : {magicTire(), curves}) {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
            for (const float heading : {0.0f, 0.8f, 1.57f}) {
                Road road(0.2f, awake());
                VehicleDef def = onTires(tire);
                Vehicle car(road.world, def, {.position = {}, .heading = heading});
                car.input = {.brake = 1};
                run(road.world, 5, dt);
                const DVec3 before = road.world.pose(car.chassis()).position;
                run(road.world, 20, dt);
                EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, before)), 1e-4f)
                    << heading << " " << dt;
            }
        }
    }
}

TEST(SlipLaw, RefusesNumbersThatAreNone) {
    VehicleDef def = hatchback();
    def.wheels[1].tire.slipCurves = SlipCurvesDef{};
    def.wheels[1].tire.slipCurves->lateral.slideSlip = 0.1f;
    EXPECT_EQ(whyInvalid(def), "/wheels/1/tire/slipCurves/lateral/slideSlip is 0.1, must be above peakSlip, 0.15");
    def.wheels[1].tire.slipCurves = SlipCurvesDef{};
    def.wheels[1].tire.magicFormula = MagicFormulaDef{};
    EXPECT_EQ(whyInvalid(def), "/wheels/1/tire/slipCurves is given, must be absent where magicFormula is given");
    def.wheels[1].tire.slipCurves.reset();
    def.wheels[1].tire.magicFormula->values[magicIndex("PKY1")] = 20;
    EXPECT_EQ(whyInvalid(def), "/wheels/1/tire/magicFormula/PKY1 is 20, must be in [-1000000, -0.001]");
}

}  // namespace
}  // namespace ragtop
