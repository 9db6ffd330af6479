#include "axle_linkage.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace ragtop {
namespace {

constexpr float kRubberTravel = 1.5f;  ///< of a travel, as far as stops yield
constexpr float kMirrored = 1e-4f;     ///< of a radius, by which wheels may mirror each other badly

std::string written(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", value);
    return digits;
}
std::string written(const DVec3& p) { return "(" + written(p.x) + ", " + written(p.y) + ", " + written(p.z) + ") m"; }

std::string pathOf(std::size_t i) { return "/linkages/" + std::to_string(i); }

/// Between the ends of these a member has its length.
std::string whyTooShort(const Vec3& from, const Vec3& to, float radius, const std::string& name,
                        const std::string& other) {
    constexpr float kShortest = 0.01f;  // of a wheel's radius
    if (length(to - from) > kShortest * radius) return {};
    return name + " is " + written(DVec3(to)) + ", must be apart from " + other;
}

std::string whyTooShort(const Vec3& front, const Vec3& rear, const Vec3& ball, float radius, const std::string& path,
                        const std::string& arm) {
    if (std::string why = whyTooShort(front, rear, radius, path + "/" + arm + "Rear", arm + "Front"); !why.empty())
        return why;
    const Vec3 axis = normalized(front - rear), foot = rear + dot(ball - rear, axis) * axis;
    return whyTooShort(foot, ball, radius, path + "/" + arm + "Ball", "the axis of its arm");
}

std::string whyTooShort(const LinkageDef& def, float radius, const std::string& path) {
    std::string why;
    const auto try_ = [&](std::string found) {
        if (why.empty()) why = std::move(found);
    };
    if (const auto& a = def.doubleWishbone) {
        const std::string at = path + "/doubleWishbone";
        try_(whyTooShort(a->lowerFront, a->lowerRear, a->lowerBall, radius, at, "lower"));
        try_(whyTooShort(a->upperFront, a->upperRear, a->upperBall, radius, at, "upper"));
        try_(whyTooShort(a->lowerBall, a->upperBall, radius, at + "/upperBall", "lowerBall"));
    } else if (const auto& m = def.mcPherson) {
        const std::string at = path + "/mcPherson";
        try_(whyTooShort(m->lowerFront, m->lowerRear, m->lowerBall, radius, at, "lower"));
        try_(whyTooShort(m->strutFoot, m->strutTop, radius, at + "/strutTop", "strutFoot"));
    } else if (const auto& t = def.trailingArm) {
        try_(whyTooShort(t->inner, t->outer, radius, path + "/trailingArm/outer", "inner"));
    } else if (const auto& s = def.solidAxle) {
        for (std::size_t k = 0; k < s->rods.size(); ++k)
            try_(whyTooShort(s->rods[k].chassis, s->rods[k].carrier, radius,
                             path + "/solidAxle/rods/" + std::to_string(k) + "/carrier", "chassis"));
    }
    if (def.tieRod) try_(whyTooShort(def.tieRod->inner, def.tieRod->outer, radius, path + "/tieRod/outer", "inner"));
    if (def.spring)
        try_(whyTooShort(def.spring->chassis, def.spring->carrier, radius, path + "/spring/carrier", "chassis"));
    return why;
}

std::string whyNoKind(const LinkageDef& def, bool steers, const std::string& path) {
    const int kinds =
        (def.doubleWishbone ? 1 : 0) + (def.mcPherson ? 1 : 0) + (def.trailingArm ? 1 : 0) + (def.solidAxle ? 1 : 0);
    if (kinds != 1) {
        return path + " has " + std::to_string(kinds) +
               " kinds, must have one: doubleWishbone, mcPherson, trailingArm or solidAxle";
    }
    const bool upright = def.doubleWishbone || def.mcPherson;
    if (upright && !def.tieRod) return path + "/tieRod is absent, must be given for an upright";
    if (!upright && def.tieRod) return path + "/tieRod is given, must be absent where the carrier is no upright";
    if (!upright && steers) {
        return path + "/axle is " + std::to_string(def.axle) +
               ", whose wheels steer, must be one of wheels that do not, or have uprights";
    }
    if (def.solidAxle && def.solidAxle->rods.size() != 4) {
        return path + "/solidAxle/rods has " + std::to_string(def.solidAxle->rods.size()) + " rods, must have 4";
    }
    if (def.solidAxle && def.spring) return path + "/spring is given, must be absent for a solid axle";
    return {};
}

std::string whyNoWheels(const VehicleDef& def, const LinkageDef& linkage, std::size_t i) {
    const std::string axle = pathOf(i) + "/axle is " + std::to_string(linkage.axle);
    const auto count = std::count_if(def.wheels.begin(), def.wheels.end(),
                                     [&](const WheelDef& wheel) { return wheel.axle == linkage.axle; });
    if (count != 2) return axle + ", which has " + std::to_string(count) + " wheels, must be one of 2";
    const auto end = def.linkages.begin() + static_cast<std::ptrdiff_t>(i);
    const auto same = [&](const LinkageDef& other) { return other.axle == linkage.axle; };
    if (std::any_of(def.linkages.begin(), end, same)) return axle + ", must be that of no other";
    const auto [left, right] = axleWheels(def, linkage.axle);
    const WheelDef &a = def.wheels[left], &b = def.wheels[right];
    const Vec3 image{-a.position.x, a.position.y, a.position.z};
    if (!(a.position.x > 0) || length(image - b.position) > kMirrored * a.radius || a.radius != b.radius ||
        a.steerFactor != b.steerFactor) {
        return axle + ", whose wheels are at " + written(DVec3(a.position)) + " and " + written(DVec3(b.position)) +
               ", must be one of wheels that mirror each other at x = 0";
    }
    return {};
}

/// Coordinates up to which a linkage has to go: both ends of travel and of the rack.
struct Travel {
    CurveRange own;
    double rack = 0;
};

Travel travelOf(const VehicleDef& def, const LinkageDef& linkage, const LinkageSolver& solver) {
    const auto [left, right] = axleWheels(def, linkage.axle);
    Travel travel;
    for (const std::size_t k : {left, right}) {
        const SuspensionDef& s = def.wheels[k].suspension;
        travel.own.upper = std::max(travel.own.upper, static_cast<double>(kRubberTravel * s.travelUp));
        travel.own.lower = std::min(travel.own.lower, static_cast<double>(-kRubberTravel * s.travelDown));
    }
    const float angle = def.wheels[left].steerFactor * def.steering.maxAngle;
    travel.rack = std::abs(rackPerAngle(solver) * static_cast<double>(angle));
    return travel;
}

/// The first way that the linkage does not come all along.
std::string whyStuck(const VehicleDef& def, const LinkageDef& linkage, const LinkageSolver& solver,
                     const std::string& path) {
    const Travel travel = travelOf(def, linkage, solver);
    if (!std::isfinite(travel.rack)) {
        return path + "/tieRod/inner is " + written(DVec3(linkage.tieRod->inner)) +
               ", must be where the rack, which travels along x, turns the wheel";
    }
    for (const double rack : {0.0, travel.rack, -travel.rack}) {
        for (const double own : {travel.own.upper, travel.own.lower}) {
            for (const double other : {own, travel.own.upper + travel.own.lower - own}) {
                LinkageSolver::Stuck stuck;
                if (solver.reach(LinkageDrive::spring, {own, other, rack}, &stuck)) continue;
                return path + stuck.point + " has come to " + written(stuck.at) + " and no farther when the wheel is " +
                       written(stuck.share * own) + " m from rest and the rack " + written(stuck.share * rack) +
                       " m, must go on to " + written(own) + " m (half beyond the travel) and " + written(rack) + " m";
            }
        }
    }
    return {};
}

}  // namespace

AxleWheels axleWheels(const VehicleDef& def, unsigned axle) {
    std::vector<std::size_t> both;
    for (std::size_t i = 0; i < def.wheels.size(); ++i)
        if (def.wheels[i].axle == axle) both.push_back(i);
    AxleWheels wheels{both.front(), both.back()};
    if (def.wheels[wheels.left].position.x < def.wheels[wheels.right].position.x) std::swap(wheels.left, wheels.right);
    return wheels;
}

LinkageSolver linkageSolver(const VehicleDef& def, const LinkageDef& linkage) {
    const WheelDef& wheel = def.wheels[axleWheels(def, linkage.axle).left];
    return {linkage, wheel.position, wheel.radius, wheel.steerFactor != 0};
}

double rackPerAngle(const LinkageSolver& solver) {
    const bool steers =
        std::any_of(solver.holds().begin(), solver.holds().end(), [](const LinkageHold& hold) { return hold.racked; });
    if (!steers) return 0;
    const CarrierPlace rest = solver.atRest();
    const DVec3 axle = solver.axle(rest);
    const DVec3 turning = cross(solver.rates(LinkageDrive::rise, rest, {})[2].spin, axle);
    return (axle.x * axle.x + axle.z * axle.z) / (turning.x * axle.z - turning.z * axle.x);
}

std::string whyInvalid(const VehicleDef& def, const LinkageDef& linkage, std::size_t i) {
    if (std::string why = whyNoWheels(def, linkage, i); !why.empty()) return why;
    const std::string path = pathOf(i);
    const WheelDef& wheel = def.wheels[axleWheels(def, linkage.axle).left];
    if (std::string why = whyNoKind(linkage, wheel.steerFactor != 0, path); !why.empty()) return why;
    const float radius = wheel.radius;
    if (std::string why = whyTooShort(linkage, radius, path); !why.empty()) return why;
    const LinkageSolver solver = linkageSolver(def, linkage);
    if (const std::string why = solver.whyLoose(); !why.empty()) return path + " " + why + ", must do";
    return whyStuck(def, linkage, solver, path);
}

std::vector<AxleLinkage> axleLinkages(const VehicleDef& def) {
    std::vector<AxleLinkage> axles;
    for (const LinkageDef& linkage : def.linkages) {
        const LinkageSolver solver = linkageSolver(def, linkage);
        const Travel travel = travelOf(def, linkage, solver);
        const CurveRange other = solver.isSolid() ? travel.own : CurveRange{-travel.rack, travel.rack};
        axles.push_back(
            {axleWheels(def, linkage.axle),
             solver,
             solver.isSolid(),
             static_cast<float>(rackPerAngle(solver)),
             {SuspensionCurves(solver, false, travel.own, other), SuspensionCurves(solver, true, travel.own, other)}});
    }
    return axles;
}

}  // namespace ragtop
