#include "robot_homes.h"

#include <algorithm>
#include <limits>
#include <map>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

/// Of limits, as of those of the joints that they become; rad or m.
constexpr float kFarthestLimit = 1e5f;

bool hasCoordinate(const ImportedRobotJoint& joint) {
    return joint.kind == RobotJointKind::hinge || joint.kind == RobotJointKind::slider;
}

/// What a coordinate is of that of the joint which it follows in the end: factor · x + shift.
struct Follows {
    std::size_t first = 0;
    double factor = 1, shift = 0;
};

std::vector<Follows> firstOfAll(const ImportedRobot& robot, const std::vector<int>& followed) {
    std::vector<Follows> all(robot.links.size());
    std::vector<bool> known(all.size(), false);
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::vector<std::size_t> way{i};
        while (!known[way.back()] && followed[way.back()] >= 0)
            way.push_back(static_cast<std::size_t>(followed[way.back()]));
        if (!known[way.back()]) all[way.back()].first = way.back();
        known[way.back()] = true;
        for (std::size_t k = way.size() - 1; k-- > 0;) {
            const ImportedRobotJoint& joint = robot.links[way[k]].joint;
            const Follows& next = all[way[k + 1]];
            const double factor = joint.multiplier, shift = joint.offset;
            all[way[k]] = {next.first, factor * next.factor, factor * next.shift + shift};
            known[way[k]] = true;
        }
    }
    return all;
}

struct Interval {
    double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
    bool empty() const { return lower > upper; }
    void meet(double from, double to) {
        lower = std::max(lower, std::min(from, to));
        upper = std::min(upper, std::max(from, to));
    }
};

}  // namespace

bool hasSoftEnds(const ImportedRobotJoint& joint) {
    return joint.limited && joint.kPosition > 0 && joint.kVelocity > 0 &&
           std::max(joint.softLower, joint.lower) <= std::min(joint.softUpper, joint.upper);
}

Range hardRange(const ImportedRobotJoint& joint) {
    return {std::clamp(joint.lower, -kFarthestLimit, kFarthestLimit),
            std::clamp(joint.upper, -kFarthestLimit, kFarthestLimit)};
}

Range softRange(const ImportedRobotJoint& joint) {
    const Range hard = hardRange(joint);
    if (!hasSoftEnds(joint)) return hard;
    return {std::max(hard.lower, joint.softLower), std::min(hard.upper, joint.softUpper)};
}

std::vector<int> followedLinks(const ImportedRobot& robot, const std::string& file,
                               std::vector<std::string>& warnings) {
    std::map<std::string, int> byName;
    for (std::size_t i = 0; i < robot.links.size(); ++i)
        if (robot.links[i].parent >= 0) byName.emplace(robot.links[i].joint.name, static_cast<int>(i));
    std::vector<int> followed(robot.links.size(), -1);
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
        const ImportedRobotJoint& joint = robot.links[i].joint;
        if (joint.follows.empty() || !hasCoordinate(joint)) continue;
        const auto found = byName.find(joint.follows);
        if (found != byName.end() && hasCoordinate(robot.links[static_cast<std::size_t>(found->second)].joint))
            followed[i] = found->second;
        else
            warnings.push_back("joint '" + joint.name + "' follows '" + joint.follows +
                               "', which has no coordinate; it is left free");
    }
    // Whoever is met twice on one way is on a ring; whoever a way has been through leads out.
    std::vector<std::size_t> seen(followed.size(), 0);
    for (std::size_t i = 0; i < followed.size(); ++i)
        for (std::size_t at = i; followed[at] >= 0 && (seen[at] == 0 || seen[at] == i + 1);
             at = static_cast<std::size_t>(followed[at])) {
            if (seen[at] == i + 1)
                throw AssetError(file, "",
                                 "joint '" + robot.links[at].joint.name +
                                     "' follows itself through others, must follow one that follows none");
            seen[at] = i + 1;
        }
    return followed;
}

std::vector<float> homesOf(const ImportedRobot& robot, const std::vector<int>& followed,
                           std::vector<std::string>& warnings) {
    const std::vector<Follows> first = firstOfAll(robot, followed);
    std::vector<Interval> allowed(robot.links.size());
    for (std::size_t i = 0; i < allowed.size(); ++i) {
        const ImportedRobotJoint& joint = robot.links[i].joint;
        const auto& [of, factor, shift] = first[i];
        if (!joint.limited || !hasCoordinate(joint) || factor == 0) continue;
        const Range range = softRange(joint);
        allowed[of].meet((static_cast<double>(range.lower) - shift) / factor,
                         (static_cast<double>(range.upper) - shift) / factor);
    }
    std::vector<float> homes(robot.links.size(), 0);
    for (std::size_t i = 0; i < homes.size(); ++i) {
        const ImportedRobotJoint& joint = robot.links[i].joint;
        if (!hasCoordinate(joint)) continue;
        const auto& [of, factor, shift] = first[i];
        Interval range = allowed[of];
        if (range.empty()) {
            const ImportedRobotJoint& leader = robot.links[of].joint;
            range = {};
            if (leader.limited) range.meet(softRange(leader).lower, softRange(leader).upper);
            if (of == i)
                warnings.push_back("joint '" + joint.name +
                                   "' and those that follow it are within their ranges at no place; they begin beyond");
        }
        homes[i] = static_cast<float>(factor * std::clamp(0.0, range.lower, range.upper) + shift);
    }
    return homes;
}

}  // namespace ragtop
