#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "double_math.h"
#include "ragtop/linkage_def.h"

/// Kinematics of a suspension: where the linkage alone lets the wheel go.
///
/// A carrier is the rigid body that holds a wheel, or both of a solid axle. What holds it are equations gᵢ = 0 in its
/// place, each of which takes one of its six freedoms. With those of the coordinates, how far springs are compressed
/// or hubs have risen, they are six, and Newton's method solves them,
///
///     Jᵢ (v, ω) = −gᵢ,   rod: g = |x − c| − L,   plane: g = n·(x − c),   line of the carrier: g = n·(c − x),
///
/// c a point of the chassis, x one of the carrier, whose place changes by (v, ω); J with unit right sides gives how it
/// moves with a coordinate [Dixon, Suspension Geometry and Computation, 2009, ch. 13].
namespace ragtop {

enum class HoldKind { rod, plane, line };

/// One equation.
struct LinkageHold {
    HoldKind kind = HoldKind::rod;
    DVec3 chassis, carrier;  ///< c, x, with the car standing
    DVec3 normal;            ///< n: of a plane in the chassis, of a line in the carrier; unit
    double length = 0;       ///< L, m
    bool racked = false;     ///< c goes with the rack, along x
    std::string point;       ///< what a file calls it
};

/// Of a solid axle both wheels count; of others the left one, which stands for the right one mirrored.
struct LinkageCoordinates {
    double left = 0, right = 0;  ///< m
    double rack = 0;             ///< m to the left
};

/// By what coordinates are meant.
enum class LinkageDrive {
    spring,  ///< how far the spring is compressed, over the motion ratio of the standing car
    rise,    ///< how far the hub has risen
};

/// Of a carrier in the chassis: of its middle, which is the hub of a single wheel, and how it has turned since rest.
struct CarrierPlace {
    DVec3 middle;
    DQuat turn;
};

/// How a place changes with a coordinate, per m.
struct CarrierRate {
    DVec3 velocity, spin;
};

class LinkageSolver {
public:
    LinkageSolver(const LinkageDef& def, const Vec3& leftHub, float radius, bool steers);

    bool isSolid() const { return solid_; }
    CarrierPlace atRest() const { return {middle_, {}}; }
    /// Empty where the carrier is held by five equations, four of a solid axle, that do not depend on each other.
    std::string whyLoose() const;
    /// Where the carrier comes from rest as coordinates grow to these; empty where it does not, and `stuck` tells the
    /// share of the way that it comes, and the point that holds it.
    struct Stuck {
        double share = 0;
        std::string point;
        DVec3 at;  ///< of that point
    };
    std::optional<CarrierPlace> reach(LinkageDrive drive, const LinkageCoordinates& to, Stuck* stuck = nullptr) const;
    /// By the left coordinate, the right one, the rack.
    std::array<CarrierRate, 3> rates(LinkageDrive drive, const CarrierPlace& place, const LinkageCoordinates& at) const;

    DVec3 hub(const CarrierPlace& place, bool right = false) const;
    /// Of a wheel, to the left, unit.
    DVec3 axle(const CarrierPlace& place, bool right = false) const;
    /// Velocity of a point of the carrier.
    static DVec3 velocityAt(const CarrierRate& rate, const CarrierPlace& place, const DVec3& point) {
        return rate.velocity + cross(rate.spin, point - place.middle);
    }
    /// A point of the carrier, known at rest.
    DVec3 moved(const CarrierPlace& place, const DVec3& atRest) const {
        return place.middle + rotate(place.turn, atRest - middle_);
    }
    /// m that the left spring gets shorter per m that its wheel rises, with the car standing; both of a solid axle.
    double motionRatio() const { return ratio_; }
    /// m of the left spring, compressed from rest.
    double springWay(const CarrierPlace& place) const;
    double springRate(const CarrierRate& rate, const CarrierPlace& place) const;
    /// Points of the axis about which the upright steers: below, above; empty where it does not.
    std::optional<std::array<DVec3, 2>> kingpin(const CarrierPlace& place) const;
    const std::vector<LinkageHold>& holds() const { return holds_; }

private:
    using Row = std::array<double, 6>;
    struct System {
        std::array<Row, 6> rows{};
        std::array<double, 6> errors{};
        std::array<const LinkageHold*, 6> holds{};
    };
    void hold(HoldKind kind, const DVec3& chassis, const DVec3& carrier, const std::string& point,
              const DVec3& normal = {});
    void holdArm(const DVec3& front, const DVec3& rear, const DVec3& ball, const std::string& kind,
                 const std::string& name);
    Row rowOf(const LinkageHold& hold, const CarrierPlace& place, double rack, double& error) const;
    System systemAt(LinkageDrive drive, const CarrierPlace& place, const LinkageCoordinates& at) const;
    bool settle(LinkageDrive drive, const LinkageCoordinates& at, CarrierPlace& place, std::size_t* worst) const;

    std::vector<LinkageHold> holds_;               ///< five, or four
    std::vector<LinkageHold> springs_;             ///< rods: one, or none
    DVec3 middle_, leftHub_, rightHub_;            ///< at rest
    DVec3 leftAxle_, rightAxle_;                   ///< at rest, unit, to the left
    std::optional<std::array<DVec3, 2>> kingpin_;  ///< at rest; the upper one of a strut is in the chassis
    bool kingpinTopFixed_ = false;
    double radius_ = 1;  ///< m, unit of length of turns
    double ratio_ = 1;
    double sense_ = 1;  ///< sign of the determinant at rest
    bool solid_ = false;
};

}  // namespace ragtop
