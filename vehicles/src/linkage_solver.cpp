#include "linkage_solver.h"

#include <algorithm>
#include <utility>

namespace ragtop {
namespace {

constexpr DVec3 kUp{0, 1, 0};
constexpr int kMostSteps = 20;         ///< of Newton's method, which doubles its digits in each
constexpr double kSettled = 1e-10;     ///< of a wheel's radius, by which equations may be wrong
constexpr double kFarthestTurn = 0.5;  ///< rad, and radii: of a step that is small enough to be of the same assembly
constexpr double kLoose = 1e-3;        ///< least pivot, of equations whose rows have unit length, of what is held
constexpr double kLeastRatio = 0.01;   ///< m of a spring per m of its wheel, of one that carries
constexpr int kParts = 8;              ///< of a way from rest, each the first guess of the next

DVec3 across(const DVec3& n) {
    const DVec3 least = std::abs(n.x) < std::abs(n.z) ? DVec3{1, 0, 0} : DVec3{0, 0, 1};
    return unit(cross(n, least));
}

/// Gauss's elimination with the largest pivot of a column. Rows have been divided by their lengths.
struct Elimination {
    double least = 1;  ///< pivot
    double sense = 1;  ///< sign of the determinant
};

template <std::size_t Sides>
Elimination eliminate(std::array<std::array<double, 6>, 6> a, std::array<std::array<double, Sides>, 6>& sides) {
    Elimination result;
    for (std::size_t k = 0; k < 6; ++k) {
        std::size_t best = k;
        for (std::size_t i = k + 1; i < 6; ++i)
            if (std::abs(a[i][k]) > std::abs(a[best][k])) best = i;
        if (best != k) {
            std::swap(a[best], a[k]);
            std::swap(sides[best], sides[k]);
            result.sense = -result.sense;
        }
        const double pivot = a[k][k];
        result.least = std::min(result.least, std::abs(pivot));
        if (pivot < 0) result.sense = -result.sense;
        if (!(std::abs(pivot) > 0)) return {0, 0};
        for (std::size_t i = 0; i < 6; ++i) {
            if (i == k) continue;
            const double factor = a[i][k] / pivot;
            for (std::size_t j = k; j < 6; ++j) a[i][j] -= factor * a[k][j];
            for (std::size_t j = 0; j < Sides; ++j) sides[i][j] -= factor * sides[k][j];
        }
    }
    for (std::size_t k = 0; k < 6; ++k)
        for (double& side : sides[k]) side /= a[k][k];
    return result;
}

}  // namespace

LinkageSolver::LinkageSolver(const LinkageDef& def, const Vec3& leftHub, float radius, bool steers)
    : leftHub_(leftHub), rightHub_{-leftHub_.x, leftHub_.y, leftHub_.z}, radius_(static_cast<double>(radius)) {
    middle_ = leftHub_;
    const SinCos camber = sinCos(def.camber), toe = sinCos(def.toe);
    leftAxle_ = DVec3(Vec3{camber.cos * toe.cos, -camber.sin, camber.cos * toe.sin});
    rightAxle_ = {leftAxle_.x, -leftAxle_.y, -leftAxle_.z};
    if (const auto& arms = def.doubleWishbone) {
        holdArm(DVec3(arms->lowerFront), DVec3(arms->lowerRear), DVec3(arms->lowerBall), "/doubleWishbone", "lower");
        holdArm(DVec3(arms->upperFront), DVec3(arms->upperRear), DVec3(arms->upperBall), "/doubleWishbone", "upper");
        kingpin_ = {DVec3(arms->lowerBall), DVec3(arms->upperBall)};
    } else if (const auto& strut = def.mcPherson) {
        holdArm(DVec3(strut->lowerFront), DVec3(strut->lowerRear), DVec3(strut->lowerBall), "/mcPherson", "lower");
        const DVec3 top(strut->strutTop), foot(strut->strutFoot), axis = top - foot, first = across(axis);
        hold(HoldKind::line, top, foot, "/mcPherson/strutTop", first);
        hold(HoldKind::line, top, foot, "/mcPherson/strutFoot", unit(cross(axis, first)));
        kingpin_ = {DVec3(strut->lowerBall), top};
        kingpinTopFixed_ = true;
    } else if (const auto& arm = def.trailingArm) {
        const DVec3 inner(arm->inner), outer(arm->outer), axis = unit(outer - inner), first = across(axis);
        for (const DVec3& n : {axis, first, cross(axis, first)})
            hold(HoldKind::plane, inner, inner, "/trailingArm/inner", n);
        // As far from the first as is a unit of length, so that all equations weigh alike.
        const DVec3 far = inner + radius_ * axis;
        for (const DVec3& n : {first, cross(axis, first)}) hold(HoldKind::plane, far, far, "/trailingArm/outer", n);
    } else if (const auto& beam = def.solidAxle) {
        solid_ = true;
        middle_ = 0.5 * (leftHub_ + rightHub_);
        for (std::size_t i = 0; i < beam->rods.size(); ++i) {
            const RodDef& rod = beam->rods[i];
            hold(HoldKind::rod, DVec3(rod.chassis), DVec3(rod.carrier),
                 "/solidAxle/rods/" + std::to_string(i) + "/carrier");
        }
    }
    if (def.tieRod) {
        hold(HoldKind::rod, DVec3(def.tieRod->inner), DVec3(def.tieRod->outer), "/tieRod/outer");
        holds_.back().racked = steers;
    }
    const CarrierPlace rest{middle_, {}};
    if (def.spring) {
        const DVec3 chassis(def.spring->chassis), carrier(def.spring->carrier);
        springs_.push_back({HoldKind::rod, chassis, carrier, {}, length(carrier - chassis), false, "/spring/carrier"});
    }
    if (holds_.size() != (solid_ ? 4u : 5u)) return;
    const System system = systemAt(LinkageDrive::rise, rest, {});
    std::array<std::array<double, 1>, 6> none{};
    sense_ = eliminate(system.rows, none).sense;
    if (!springs_.empty() && std::abs(sense_) > 0) ratio_ = springRate(rates(LinkageDrive::rise, rest, {})[0], rest);
}

void LinkageSolver::hold(HoldKind kind, const DVec3& chassis, const DVec3& carrier, const std::string& point,
                         const DVec3& normal) {
    holds_.push_back({kind, chassis, carrier, normal, length(carrier - chassis), false, point});
}

/// An arm that turns about an axis holds its ball as two rods from any two points of that axis do; these have the same
/// distance as the axis has from the ball, so that they stand across each other whatever the points of the axis.
void LinkageSolver::holdArm(const DVec3& front, const DVec3& rear, const DVec3& ball, const std::string& kind,
                            const std::string& name) {
    const DVec3 axis = unit(front - rear), foot = rear + dot(ball - rear, axis) * axis;
    const double reach = length(ball - foot);
    hold(HoldKind::rod, foot + reach * axis, ball, kind + "/" + name + "Ball");
    hold(HoldKind::rod, foot - reach * axis, ball, kind + "/" + name + "Ball");
}

DVec3 LinkageSolver::hub(const CarrierPlace& place, bool right) const {
    return moved(place, right ? rightHub_ : leftHub_);
}

DVec3 LinkageSolver::axle(const CarrierPlace& place, bool right) const {
    return rotate(place.turn, right ? rightAxle_ : leftAxle_);
}

LinkageSolver::Row LinkageSolver::rowOf(const LinkageHold& hold, const CarrierPlace& place, double rack,
                                        double& error) const {
    const DVec3 c = hold.racked ? hold.chassis + DVec3{rack, 0, 0} : hold.chassis;
    const DVec3 x = moved(place, hold.carrier);
    DVec3 along, moment;
    if (hold.kind == HoldKind::rod) {
        const double size = length(x - c);
        along = (1 / size) * (x - c);
        moment = cross(x - place.middle, along);
        error = size - hold.length;
    } else if (hold.kind == HoldKind::plane) {
        along = hold.normal;
        moment = cross(x - place.middle, along);
        error = dot(along, x - c);
    } else {
        const DVec3 n = rotate(place.turn, hold.normal);
        along = -1 * n;
        moment = cross(n, c - place.middle);
        error = dot(n, c - x);
    }
    // Turns count as what they move at the tread.
    const double turn = 1 / radius_;
    return {along.x, along.y, along.z, turn * moment.x, turn * moment.y, turn * moment.z};
}

LinkageSolver::System LinkageSolver::systemAt(LinkageDrive drive, const CarrierPlace& place,
                                              const LinkageCoordinates& at) const {
    System system;
    std::size_t i = 0;
    for (const LinkageHold& hold : holds_) {
        system.rows[i] = rowOf(hold, place, at.rack, system.errors[i]);
        system.holds[i] = &hold;
        ++i;
    }
    if (drive == LinkageDrive::spring && !springs_.empty()) {
        system.rows[i] = rowOf(springs_[0], place, 0, system.errors[i]);
        system.errors[i] += ratio_ * at.left;
        return system;
    }
    const auto rises = [&](const DVec3& hubAtRest, double rise) {
        const LinkageHold hub{HoldKind::plane, hubAtRest + rise * kUp, hubAtRest, kUp, 0, false, {}};
        system.rows[i] = rowOf(hub, place, 0, system.errors[i]);
        ++i;
    };
    rises(leftHub_, at.left);
    if (solid_) rises(rightHub_, at.right);
    return system;
}

std::string LinkageSolver::whyLoose() const {
    const System system = systemAt(LinkageDrive::rise, {middle_, {}}, {});
    std::array<std::array<double, 1>, 6> none{};
    if (!(eliminate(system.rows, none).least > kLoose)) return "does not hold the wheel in all but its travel";
    if (!(ratio_ > kLeastRatio)) return "has a spring that is not compressed where the wheel rises";
    return {};
}

bool LinkageSolver::settle(LinkageDrive drive, const LinkageCoordinates& at, CarrierPlace& place,
                           std::size_t* worst) const {
    const double turn = 1 / radius_;
    // A spring gets shorter where the hub rises, and the determinant is linear in its row.
    const double sense = drive == LinkageDrive::spring && !springs_.empty() ? -sense_ : sense_;
    for (int step = 0; step < kMostSteps; ++step) {
        const System system = systemAt(drive, place, at);
        std::array<std::array<double, 1>, 6> side;
        double largest = 0;
        for (std::size_t i = 0; i < 6; ++i) {
            side[i][0] = -system.errors[i];
            const double error = std::abs(system.errors[i]);
            if (worst && i < holds_.size() && error > largest) *worst = i;
            largest = std::max(largest, error);
        }
        const Elimination of = eliminate(system.rows, side);
        if (!(of.least > kLoose * kLoose)) return false;
        if (largest < kSettled * radius_) return of.sense == sense;
        const DVec3 move{side[0][0], side[1][0], side[2][0]}, spin = turn * DVec3{side[3][0], side[4][0], side[5][0]};
        if (!(length(spin) < kFarthestTurn) || !(length(move) < kFarthestTurn * radius_)) return false;
        place.middle = place.middle + move;
        place.turn = turnedBy(place.turn, spin);
    }
    return false;
}

std::optional<CarrierPlace> LinkageSolver::reach(LinkageDrive drive, const LinkageCoordinates& to, Stuck* stuck) const {
    CarrierPlace place{middle_, {}};
    for (int part = 1; part <= kParts; ++part) {
        const double share = static_cast<double>(part) / kParts;
        const CarrierPlace before = place;
        std::size_t worst = 0;
        if (settle(drive, {share * to.left, share * to.right, share * to.rack}, place, &worst)) continue;
        if (stuck) *stuck = {share, holds_[worst].point, moved(before, holds_[worst].carrier)};
        return {};
    }
    return place;
}

std::array<CarrierRate, 3> LinkageSolver::rates(LinkageDrive drive, const CarrierPlace& place,
                                                const LinkageCoordinates& at) const {
    const System system = systemAt(drive, place, at);
    const bool bySpring = drive == LinkageDrive::spring && !springs_.empty();
    std::array<std::array<double, 3>, 6> sides{};
    const std::size_t first = holds_.size();
    sides[first][0] = bySpring ? -ratio_ : 1;
    if (solid_) sides[first + 1][1] = 1;
    for (std::size_t i = 0; i < holds_.size(); ++i) {
        if (!holds_[i].racked) continue;
        // Of a rod c moves away from x where x does not from c.
        sides[i][2] = system.rows[i][0];
    }
    eliminate(system.rows, sides);
    std::array<CarrierRate, 3> rates;
    const double turn = 1 / radius_;
    for (std::size_t k = 0; k < 3; ++k) {
        rates[k].velocity = {sides[0][k], sides[1][k], sides[2][k]};
        rates[k].spin = turn * DVec3{sides[3][k], sides[4][k], sides[5][k]};
    }
    return rates;
}

double LinkageSolver::springWay(const CarrierPlace& place) const {
    if (springs_.empty()) return hub(place).y - leftHub_.y;
    return springs_[0].length - length(moved(place, springs_[0].carrier) - springs_[0].chassis);
}

double LinkageSolver::springRate(const CarrierRate& rate, const CarrierPlace& place) const {
    if (springs_.empty()) return velocityAt(rate, place, hub(place)).y;
    const DVec3 at = moved(place, springs_[0].carrier);
    return -dot(velocityAt(rate, place, at), unit(at - springs_[0].chassis));
}

std::optional<std::array<DVec3, 2>> LinkageSolver::kingpin(const CarrierPlace& place) const {
    if (!kingpin_) return {};
    const auto& [below, above] = *kingpin_;
    return std::array<DVec3, 2>{moved(place, below), kingpinTopFixed_ ? above : moved(place, above)};
}

}  // namespace ragtop
