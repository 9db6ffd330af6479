#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>

#include "axle_linkage.h"
#include "hardpoints.h"
#include "ragtop/suspension_geometry.h"

namespace ragtop {
namespace {

constexpr double kExact = 2e-7;  ///< m and rad, of hardpoints in single precision

WheelPosture left(const VehicleDef& def, unsigned axle, double rise, double rack = 0) {
    return wheelPostures(def, axle, {rise, rise, rack})[0];
}

constexpr double kRises[] = {-0.12, -0.06, 0, 0.04, 0.12};

/// Both arms and the tie rod turn by one angle, so that the upright goes along a circle without turning.
TEST(Linkage, ParallelWishbonesOfEqualLengthKeepCamberAndToe) {
    const VehicleDef def = withLinkages({parallelWishbones()});
    constexpr double arm = 0.32;
    for (const double rise : kRises) {
        const WheelPosture at = left(def, 0, rise);
        EXPECT_NEAR(at.camber, 0, kExact);
        EXPECT_NEAR(at.toe, 0, kExact);
        EXPECT_NEAR(at.hub.x, 0.74 - (arm - std::sqrt(arm * arm - rise * rise)), kExact) << rise;
        EXPECT_NEAR(at.hub.z, 1.26, kExact);
        // Arms that are parallel meet nowhere: the line to the contact is parallel to them too.
        const double slope = -rise / std::sqrt(arm * arm - rise * rise);
        EXPECT_NEAR(at.rollCenter, at.hub.x * slope, 1e-6);
        EXPECT_NEAR(at.scrub, 0.07, kExact);
        EXPECT_NEAR(at.trail, 0, kExact);
        EXPECT_EQ(at.motionRatio, 1);
    }
}

TEST(Linkage, TrailingArmTurnsAboutItsAxisAndKeepsCamberAndToe) {
    const VehicleDef def = withLinkages({rearArms()});
    constexpr double arm = 0.41, height = 0.30;
    for (const double rise : kRises) {
        const WheelPosture at = left(def, 1, rise);
        EXPECT_NEAR(at.camber, 0, kExact);
        EXPECT_NEAR(at.toe, 0, kExact);
        const double along = std::sqrt(arm * arm - rise * rise);
        EXPECT_NEAR(at.hub.z, -0.85 - along, kExact);
        EXPECT_NEAR(at.hub.x, 0.74, kExact);
        EXPECT_NEAR(at.rollCenter, 0, kExact);
        // Turning about the axis by a unit of rise per length along.
        EXPECT_NEAR(at.driveSlope, rise / along, 1e-6);
        EXPECT_NEAR(at.brakeSlope, (rise - height) / along, 1e-6);
        const double angle = std::asin(rise / arm);
        const Eigen::Vector2d seat(0.28 - 0.30, -1.20 + 0.85), top(0.62 - 0.30, -1.18 + 0.85);
        const auto springAt = [&](double a) {
            return (Eigen::Vector2d(std::cos(a) * seat.x() - std::sin(a) * seat.y(),
                                    std::sin(a) * seat.x() + std::cos(a) * seat.y()) -
                    top)
                .norm();
        };
        constexpr double step = 1e-5;
        const double ratio = (springAt(angle - step) - springAt(angle + step)) / (2 * step) / along;
        EXPECT_NEAR(at.motionRatio, ratio, 1e-6);
    }
}

/// The hubs of a beam are a track apart, whatever holds it.
TEST(Linkage, SolidAxleLeansBothWheelsOneWayByItsRoll) {
    const VehicleDef def = withLinkages({beamOnRods()});
    for (const double roll : {0.0, 0.03, -0.08}) {
        for (const double heave : {0.0, 0.04}) {
            const auto [a, b] = wheelPostures(def, 1, {heave + roll, heave - roll, 0});
            EXPECT_NEAR(a.camber, -std::asin(2 * roll / 1.48), kExact);
            EXPECT_NEAR(a.camber, -b.camber, kExact);
            EXPECT_NEAR(a.toe, -b.toe, kExact);
            EXPECT_NEAR(length(a.hub - b.hub), 1.48, kExact);
        }
    }
    // About where its rod across meets the middle.
    for (const WheelPosture& at : wheelPostures(def, 1, {})) EXPECT_NEAR(at.rollCenter, 0.32, 1e-6);
}

using Point = Eigen::Vector3d;
Point of(const Vec3& p) {
    return DVec3(p).x * Point::UnitX() + DVec3(p).y * Point::UnitY() + DVec3(p).z * Point::UnitZ();
}

/// A root between ends where a function has other signs.
template <class Function>
double rootOf(Function&& f, double a, double b) {
    const bool below = f(a) < 0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (a + b);
        ((f(middle) < 0) == below ? a : b) = middle;
    }
    return 0.5 * (a + b);
}

/// By one angle after the other: the arm's puts the ball; the strut's line passes the top at the ball's distance, which
/// leaves a turn about the line between them, that of the tie rod's length.
class StrutByAngles {
public:
    explicit StrutByAngles(const LinkageDef& def)
        : points_(*def.mcPherson), inner_(of(def.tieRod->inner)), outer_(of(def.tieRod->outer)) {}
    struct Upright {
        Point ball;
        Eigen::Matrix3d turn;
        Point at(const Point& p, const Point& ballAtRest) const { return ball + turn * (p - ballAtRest); }
    };
    Upright at(double armAngle, double rack) const {
        const Point front = of(points_.lowerFront), axis = (of(points_.lowerRear) - front).normalized();
        const Point ball0 = of(points_.lowerBall), top = of(points_.strutTop);
        const Point ball = front + Eigen::AngleAxisd(armAngle, axis) * (ball0 - front);
        const Point along = (top - of(points_.strutFoot)).normalized();
        const Point near = ball0 - top - along.dot(ball0 - top) * along;  // from the line to the ball
        const double far = std::sqrt((top - ball).squaredNorm() - near.squaredNorm());
        // At rest the body's point on its own line at this distance takes the place of the top.
        const Point bodyTop = ball0 - near + far * along;
        const Eigen::Quaterniond lean = Eigen::Quaterniond::FromTwoVectors(bodyTop - ball0, top - ball);
        const auto turned = [&](double angle) {
            return Upright{ball, (Eigen::AngleAxisd(angle, (top - ball).normalized()) * lean).toRotationMatrix()};
        };
        const double rod = (outer_ - inner_).norm();
        const Point end = inner_ + rack * Point::UnitX();
        return turned(rootOf([&](double a) { return (turned(a).at(outer_, ball0) - end).norm() - rod; }, -0.7, 0.7));
    }
    Upright risen(const Point& hub, double rise, double rack) const {
        const Point ball0 = of(points_.lowerBall);
        return at(rootOf([&](double a) { return at(a, rack).at(hub, ball0).y() - hub.y() - rise; }, -0.6, 0.6), rack);
    }

private:
    McPhersonDef points_;
    Point inner_, outer_;
};

TEST(Linkage, McPhersonStrutIsWhereItsAnglesPutIt) {
    const VehicleDef def = withLinkages({frontStruts()});
    const StrutByAngles strut(def.linkages[0]);
    const Point hub = of(def.wheels[0].position), ball = of(def.linkages[0].mcPherson->lowerBall);
    for (const double rise : kRises) {
        for (const double rack : {0.0, 0.03, -0.05}) {
            const auto upright = strut.risen(hub, rise, rack);
            const Point axle = upright.turn * Point::UnitX(), at = upright.at(hub, ball);
            const WheelPosture posture = left(def, 0, rise, rack);
            EXPECT_NEAR(posture.camber, -std::asin(axle.y()), 1e-6) << rise << " " << rack;
            EXPECT_NEAR(posture.toe, std::atan2(axle.z(), axle.x()), 1e-6) << rise << " " << rack;
            EXPECT_NEAR(posture.hub.x, at.x(), 1e-6);
            EXPECT_NEAR(posture.hub.z, at.z(), 1e-6);
        }
    }
}

/// Seen from ahead, forces at the contact act along the line to where the arms' lines meet.
TEST(Linkage, RollCentreIsOnTheLineToWhereTheArmsMeet) {
    LinkageDef flat = raceWishbones();
    for (Vec3* p : {&flat.doubleWishbone->lowerBall, &flat.doubleWishbone->upperBall}) p->z = 1.26f;
    flat.doubleWishbone->upperRear.y = flat.doubleWishbone->upperFront.y;
    // A tie rod in the plane of the lower arm, that does not steer: the plane motion is that of the arms.
    flat.tieRod = TieRodDef{.inner = {0.35f, 0.22f, 1.12f}, .outer = {0.70f, 0.18f, 1.12f}};
    const VehicleDef def = withLinkages({flat});
    const DoubleWishboneDef& arms = *flat.doubleWishbone;
    const auto slope = [](const Vec3& a, const Vec3& b) { return DVec3(b - a).y / DVec3(b - a).x; };
    const double lower = slope(arms.lowerFront, arms.lowerBall), upper = slope(arms.upperFront, arms.upperBall);
    const DVec3 l(arms.lowerBall), u(arms.upperBall);
    const double x = (u.y - l.y + lower * l.x - upper * u.x) / (lower - upper), y = l.y + lower * (x - l.x);
    EXPECT_NEAR(left(def, 0, 0).rollCenter, 0.74 * y / (0.74 - x), 1e-5);
}

TEST(Linkage, RatesAreThoseOfTheCurves) {
    const VehicleDef def = withLinkages({raceWishbones()});
    constexpr double step = 1e-4;
    for (const double rise : {-0.07, 0.0, 0.05}) {
        const WheelPosture at = left(def, 0, rise), up = left(def, 0, rise + step), down = left(def, 0, rise - step);
        EXPECT_NEAR(at.camberRate, (up.camber - down.camber) / (2 * step), 1e-5);
        EXPECT_NEAR(at.toeRate, (up.toe - down.toe) / (2 * step), 1e-5);
        EXPECT_NEAR(at.driveSlope, (up.hub.z - down.hub.z) / (2 * step), 1e-5);
        EXPECT_NEAR(at.rollCenter, at.contact.x * (up.contact.x - down.contact.x) / (2 * step), 2e-4);  // toes in, too
        EXPECT_LT(at.camberRate, -0.3);  // shorter above, which leans the outer wheel into the turn
        EXPECT_GT(at.caster, 0.05);
        EXPECT_GT(at.kingpin, 0.1);
    }
}

/// A rod at right angles to a steering arm of length e turns it by 1/e.
TEST(Linkage, RackTravelsByTheSteeringArm) {
    LinkageDef behind = parallelWishbones(), ahead = parallelWishbones();
    ahead.tieRod->inner.z = ahead.tieRod->outer.z = 1.40f;
    EXPECT_NEAR(rackTravel(withLinkages({behind}), 0), -0.14, kExact);
    EXPECT_NEAR(rackTravel(withLinkages({ahead}), 0), 0.14, kExact);
    EXPECT_EQ(rackTravel(withLinkages({rearArms()}), 1), 0);
    const WheelPosture turned = left(withLinkages({ahead}), 0, 0, 0.05);
    EXPECT_NEAR(turned.toe, -std::asin(0.05 / 0.14), 2e-2);  // the rod leans, too
    EXPECT_LT(turned.toe, -0.3);
}

TEST(Linkage, WheelsMirrorEachOther) {
    const VehicleDef def = withLinkages({frontStruts()});
    const auto [a, b] = wheelPostures(def, 0, {0.05, -0.03, 0.02});
    const auto [c, d] = wheelPostures(def, 0, {-0.03, 0.05, -0.02});
    EXPECT_EQ(a.camber, d.camber);
    EXPECT_EQ(a.toe, d.toe);
    EXPECT_EQ(a.contact.x, -d.contact.x);
    EXPECT_EQ(b.trail, c.trail);
}

/// What level 2 goes along is what the linkage does.
TEST(Linkage, CurvesKeepToTheLinkageAllOverItsTravel) {
    for (const LinkageDef& linkage : {frontStruts(), raceWishbones(), rearArms(), beamOnRods()}) {
        const VehicleDef def = withLinkages({linkage});
        const LinkageSolver solver = linkageSolver(def, linkage);
        const AxleLinkage axle = axleLinkages(def)[0];
        for (const bool right : {false, true}) {
            for (const double own : {-0.15, -0.07, 0.0, 0.031, 0.13}) {
                for (const double share : {-1.0, -0.41, 0.0, 0.73}) {
                    const double rack = share * std::abs(static_cast<double>(0.6f * axle.rackTravel));
                    const double other = axle.solid ? 0.13 * share : rack;
                    LinkageCoordinates at{own, own, right && !axle.solid ? -rack : rack};
                    if (axle.solid) (right ? at.left : at.right) = other;
                    const auto place = solver.reach(LinkageDrive::spring, at);
                    ASSERT_TRUE(place);
                    const bool isRight = right && axle.solid;
                    const DVec3 gone = solver.hub(*place, isRight) - solver.hub(solver.atRest(), isRight);
                    const DVec3 axis = solver.axle(*place, isRight);
                    const double side = right && !axle.solid ? -1 : 1;
                    const WheelGuide guide =
                        axle.curves[right ? 1 : 0].with(static_cast<float>(other)).at(static_cast<float>(own));
                    EXPECT_NEAR(length(DVec3(guide.hub) - DVec3{side * gone.x, gone.y, gone.z}), 0, 2e-5)
                        << linkage.axle << " " << own << " " << share;
                    EXPECT_NEAR(length(DVec3(guide.axle) - DVec3{axis.x, side * axis.y, side * axis.z}), 0, 2e-4)
                        << linkage.axle << " " << own << " " << share;
                    const auto rate = solver.rates(LinkageDrive::spring, *place, at)[isRight ? 1 : 0];
                    EXPECT_NEAR(guide.spinRate, dot(rate.spin, axis), 2e-3);
                    EXPECT_NEAR(guide.hubRate.y, LinkageSolver::velocityAt(rate, *place, solver.hub(*place, isRight)).y,
                                1e-3);
                }
            }
        }
    }
}

std::string whyBad(const LinkageDef& linkage) { return whyInvalid(withLinkages({linkage})); }

TEST(Linkage, SaysWhatCannotBeAssembled) {
    EXPECT_EQ(whyInvalid(withLinkages({frontStruts(), rearArms()})), "");
    LinkageDef def = frontStruts();
    def.axle = 7;
    EXPECT_EQ(whyBad(def), "/linkages/0/axle is 7, which has 0 wheels, must be one of 2");
    EXPECT_EQ(whyInvalid(withLinkages({rearArms(), rearArms()})), "/linkages/1/axle is 1, must be that of no other");
    def = frontStruts();
    def.trailingArm = TrailingArmDef{};
    EXPECT_EQ(whyBad(def),
              "/linkages/0 has 2 kinds, must have one: doubleWishbone, mcPherson, trailingArm or solidAxle");
    def = frontStruts();
    def.tieRod.reset();
    EXPECT_EQ(whyBad(def), "/linkages/0/tieRod is absent, must be given for an upright");
    def = rearArms();
    def.axle = 0;
    EXPECT_NE(whyBad(def).find("whose wheels steer, must be one of wheels that do not"), std::string::npos);
    def = rearArms();
    def.trailingArm->outer = def.trailingArm->inner;
    EXPECT_EQ(whyBad(def), "/linkages/0/trailingArm/outer is (0.45, 0.3, -0.85) m, must be apart from inner");
    def = beamOnRods();
    def.solidAxle->rods.pop_back();
    EXPECT_EQ(whyBad(def), "/linkages/0/solidAxle/rods has 3 rods, must have 4");
    def = beamOnRods();
    def.solidAxle->rods[3] = def.solidAxle->rods[0];
    EXPECT_EQ(whyBad(def), "/linkages/0 does not hold the wheel in all but its travel, must do");
    def = parallelWishbones();
    def.tieRod->outer = def.doubleWishbone->lowerBall;  // on the steering axis
    EXPECT_EQ(whyBad(def), "/linkages/0 does not hold the wheel in all but its travel, must do");
    def = parallelWishbones();
    // An arm of 0.1 m has turned down before 1.5 of 100 mm.
    def.doubleWishbone->upperFront.x = def.doubleWishbone->upperRear.x = 0.57f;
    const std::string stuck = whyBad(def);
    EXPECT_TRUE(stuck.starts_with("/linkages/0/doubleWishbone/")) << stuck;
    EXPECT_NE(stuck.find("must go on to -0.15 m"), std::string::npos) << stuck;
    def = rearArms();
    def.spring->chassis = {0.55f, 0.28f, -0.9f};  // across the way of its other end
    def.spring->carrier = {0.55f, 0.30f, -1.20f};
    EXPECT_EQ(whyBad(def), "/linkages/0 has a spring that is not compressed where the wheel rises, must do");
    VehicleDef crooked = withLinkages({rearArms()});
    crooked.wheels[3].position.x = -0.80f;
    EXPECT_NE(whyInvalid(crooked).find("must be one of wheels that mirror each other"), std::string::npos);
    EXPECT_THROW(wheelPostures(withLinkages({rearArms()}), 0, {}), std::invalid_argument);
    EXPECT_THROW(wheelPostures(withLinkages({rearArms()}), 1, {0.5, 0.5, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
