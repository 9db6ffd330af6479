#include "gltf/physics_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ragtop {
namespace {

constexpr float kEndless = 1e5f;          ///< m or rad, where a limit has no end
constexpr float kLeastCone = 1e-3f;       ///< rad; a narrower cone is no freedom
constexpr float kGreatestCone = 3.1f;     ///< rad; a wider one is no bound
constexpr float kGreatestPyramid = 1.5f;  ///< rad, of SwingPyramid

/// One coordinate and what the file says of it.
struct Coordinate {
    std::optional<Range> range{};
    Stop stop{};
    std::optional<GltfDrive> drive{};

    bool isLocked() const { return range && range->lower == 0 && range->upper == 0; }
};

using Axes = std::array<Coordinate, 3>;

/// The coordinates of a joint, with a cone or a ball that bounds several together.
struct Freedoms {
    Axes travel{}, turn{};
    std::optional<float> cone{};  ///< rad, of the two axes but `coneAxis`
    int coneAxis = 0;
    std::optional<Range> distance{};
    Stop together{};  ///< of the cone or the distance
    std::vector<std::string> lost{};
};

Stop stopOf(const GltfLimit& limit) {
    if (!limit.stiffness) return {};
    return {.stiffness = *limit.stiffness, .damping = limit.damping};
}

Range rangeOf(const GltfLimit& limit) {
    const float lower = limit.min.value_or(-kEndless), upper = limit.max.value_or(kEndless);
    return {std::min(lower, upper), std::max(lower, upper)};
}

void bound(Coordinate& axis, const Range& range, const Stop& stop) {
    axis.range = range;
    axis.stop = stop;
}

/// Two or three axes together: none of them moves where the bound is zero.
void boundTogether(Freedoms& to, const GltfLimit& limit, const std::vector<int>& axes, bool turns) {
    const float upper = limit.max.value_or(kEndless);
    Axes& coordinates = turns ? to.turn : to.travel;
    if (upper < kLeastCone && limit.min.value_or(0) >= 0 && (turns || upper == 0)) {
        for (const int axis : axes) bound(coordinates[static_cast<std::size_t>(axis)], {0, 0}, stopOf(limit));
    } else if (turns && axes.size() == 2) {
        if (upper < kGreatestCone) to.cone = upper;
        to.coneAxis = 3 - axes[0] - axes[1];
        to.together = stopOf(limit);
    } else if (!turns && axes.size() == 3) {
        to.distance = Range{std::max(limit.min.value_or(0), 0.0f), upper};
        to.together = stopOf(limit);
    } else {
        to.lost.push_back(turns ? "a limit of the whole rotation: each axis is limited alone"
                                : "a limit of two axes of travel together: each is limited alone");
        for (const int axis : axes)
            bound(coordinates[static_cast<std::size_t>(axis)], {-std::abs(upper), std::abs(upper)}, stopOf(limit));
    }
}

void addLimit(Freedoms& to, const GltfLimit& limit) {
    for (const bool turns : {false, true}) {
        std::vector<int> axes = turns ? limit.angularAxes : limit.linearAxes;
        std::sort(axes.begin(), axes.end());
        axes.erase(std::unique(axes.begin(), axes.end()), axes.end());
        if (axes.size() == 1)
            bound((turns ? to.turn : to.travel)[static_cast<std::size_t>(axes[0])], rangeOf(limit), stopOf(limit));
        else if (!axes.empty())
            boundTogether(to, limit, axes, turns);
    }
}

Freedoms freedomsOf(const GltfJoint& joint) {
    Freedoms result;
    for (const GltfLimit& limit : joint.limits) addLimit(result, limit);
    for (const GltfDrive& drive : joint.drives) {
        Axes& axes = drive.type == GltfDriveType::linear ? result.travel : result.turn;
        axes[static_cast<std::size_t>(drive.axis)].drive = drive;
    }
    return result;
}

int locked(const Axes& axes) {
    return static_cast<int>(std::count_if(axes.begin(), axes.end(), [](const Coordinate& c) { return c.isLocked(); }));
}

int freeAxis(const Axes& axes) {
    for (int i = 0; i < 3; ++i)
        if (!axes[static_cast<std::size_t>(i)].isLocked()) return i;
    return 0;
}

/// The turn whose x axis is that axis, and y and z those after it.
Quat turnTo(int axis) {
    return axis == 0 ? Quat{} : axis == 1 ? Quat{0.5f, 0.5f, 0.5f, 0.5f} : Quat{-0.5f, -0.5f, -0.5f, 0.5f};
}

void turnFreedoms(Freedoms& freedoms, int axis) {
    for (Axes* axes : {&freedoms.travel, &freedoms.turn}) std::rotate(axes->begin(), axes->begin() + axis, axes->end());
    freedoms.coneAxis = (freedoms.coneAxis + 3 - axis) % 3;
}

/// A drive of acceleration has the stiffness and damping of unit inertia: ω² = k, 2 ζ ω = d.
std::optional<Spring> springOf(const Coordinate& axis, std::vector<std::string>& lost) {
    if (!axis.drive || (axis.drive->stiffness == 0 && axis.drive->damping == 0)) return std::nullopt;
    const GltfDrive& drive = *axis.drive;
    Spring spring{.speed = drive.velocityTarget, .maxForce = drive.maxForce.value_or(kNoForceLimit)};
    if (drive.mode == GltfDriveMode::force) {
        spring.stiffness = drive.stiffness;
        spring.damping = drive.damping;
    } else if (drive.stiffness > 0) {
        const float omega = std::sqrt(drive.stiffness);
        spring.frequency = omega / (2 * kPi);
        spring.dampingRatio = drive.damping / (2 * omega);
    } else {
        lost.push_back("a drive of acceleration without stiffness, which is left out");
        return std::nullopt;
    }
    return spring;
}

/// All fields that joints of one coordinate have in common.
template <class Def>
void fill(Def& def, const Coordinate& axis, std::vector<std::string>& lost) {
    def.limit = axis.range;
    def.stop = axis.stop;
    def.spring = springOf(axis, lost);
    if (def.spring) def.target = axis.drive->positionTarget;
}

AxisDef axisOf(const Coordinate& axis, std::vector<std::string>& lost) {
    AxisDef def;
    fill(def, axis, lost);
    return def;
}

bool alike(const std::optional<GltfDrive>& a, const std::optional<GltfDrive>& b) {
    if (!a || !b) return !a && !b;
    return a->stiffness == b->stiffness && a->damping == b->damping && a->maxForce == b->maxForce && a->mode == b->mode;
}

bool sameStop(const Stop& a, const Stop& b) { return a.stiffness == b.stiffness && a.damping == b.damping; }

/// Whether a ball can say what bounds and drives its rotation: all of its limits have one stop, and swing has one
/// spring.
bool isBall(const Freedoms& f) {
    const auto swings = [&](std::size_t i) {
        const std::optional<Range>& range = f.turn[i].range;
        return range && range->lower > -kGreatestPyramid && range->upper < kGreatestPyramid &&
               range->lower < range->upper;
    };
    const bool both = swings(1) && swings(2), none = !f.turn[1].range && !f.turn[2].range;
    if (f.cone ? f.coneAxis != 0 || !none : !both && !none) return false;
    const std::optional<Range>& twist = f.turn[0].range;
    if (twist && (twist->lower < -kPi || twist->upper > kPi)) return false;
    const Stop& swing = f.cone ? f.together : f.turn[1].stop;
    if (both && !sameStop(f.turn[1].stop, f.turn[2].stop)) return false;
    if (twist && (f.cone || both) && !sameStop(f.turn[0].stop, swing)) return false;
    return alike(f.turn[1].drive, f.turn[2].drive);
}

BallDef ballOf(const Freedoms& f, std::vector<std::string>& lost) {
    BallDef ball;
    ball.swingLimit = f.cone;
    if (!f.cone && f.turn[1].range) ball.swingPyramid = SwingPyramid{*f.turn[1].range, *f.turn[2].range};
    ball.twistLimit = f.turn[0].range;
    ball.stop = f.turn[0].range ? f.turn[0].stop : f.cone ? f.together : f.turn[1].stop;
    const bool whole = alike(f.turn[0].drive, f.turn[1].drive);
    ball.spring = springOf(f.turn[1], lost);
    if (!whole) ball.twistSpring = springOf(f.turn[0], lost);
    const auto target = [&](std::size_t i) { return f.turn[i].drive ? f.turn[i].drive->positionTarget : 0.0f; };
    const auto speed = [&](std::size_t i) { return f.turn[i].drive ? f.turn[i].drive->velocityTarget : 0.0f; };
    const Vec3 pull{target(0), target(1), target(2)};
    ball.target = rotationAbout(normalized(pull), length(pull));
    ball.targetSpeed = {speed(0), speed(1), speed(2)};
    for (std::optional<Spring>* spring : {&ball.spring, &ball.twistSpring}) {
        if (!*spring) continue;
        ball.maxSpringTorque = std::min(ball.maxSpringTorque, (*spring)->maxForce);
        (*spring)->speed = 0;
        (*spring)->maxForce = kNoForceLimit;
    }
    return ball;
}

SixDofDef sixDofOf(const Freedoms& f, std::vector<std::string>& lost) {
    SixDofDef def;
    def.x = axisOf(f.travel[0], lost), def.y = axisOf(f.travel[1], lost), def.z = axisOf(f.travel[2], lost);
    def.twist = axisOf(f.turn[0], lost), def.swingY = axisOf(f.turn[1], lost), def.swingZ = axisOf(f.turn[2], lost);
    if (f.cone) {
        lost.push_back("a cone beside other limits: each of its axes is limited alone");
        for (AxisDef* axis : {&def.twist, &def.swingY, &def.swingZ})
            if (axis != std::array{&def.twist, &def.swingY, &def.swingZ}[static_cast<std::size_t>(f.coneAxis)])
                axis->limit = Range{-*f.cone, *f.cone}, axis->stop = f.together;
    }
    if (f.distance) {
        lost.push_back("a limit of distance beside other limits: each axis is limited alone");
        for (AxisDef* axis : {&def.x, &def.y, &def.z})
            axis->limit = Range{-f.distance->upper, f.distance->upper}, axis->stop = f.together;
    }
    return def;
}

bool anyDrive(const Axes& axes) {
    return std::any_of(axes.begin(), axes.end(), [](const Coordinate& c) { return c.drive.has_value(); });
}

template <class Def>
JointDef oneAxis(const Coordinate& axis, std::vector<std::string>& lost) {
    Def def;
    fill(def, axis, lost);
    return def;
}

JointDef kindOf(const Freedoms& f, int travels, int turns, std::vector<std::string>& lost) {
    if (travels == 0 && turns == 0) return FixedDef{};
    if (travels == 0 && turns == 1) return oneAxis<HingeDef>(f.turn[0], lost);
    if (travels == 1 && turns == 0) return oneAxis<SliderDef>(f.travel[0], lost);
    if (travels == 0 && turns == 3 && isBall(f)) return ballOf(f, lost);
    if (travels == 1 && turns == 1 && !f.turn[0].isLocked())
        return CylindricalDef{.turn = axisOf(f.turn[0], lost), .travel = axisOf(f.travel[0], lost)};
    if (travels == 2 && turns == 1 && f.travel[0].isLocked() && !f.turn[0].isLocked())
        return PlaneDef{
            .y = axisOf(f.travel[1], lost), .z = axisOf(f.travel[2], lost), .turn = axisOf(f.turn[0], lost)};
    if (f.distance && travels == 3 && turns == 3 && !anyDrive(f.travel) && !anyDrive(f.turn) && !f.cone)
        return DistanceDef{.limit = f.distance, .stop = f.together};
    return sixDofOf(f, lost);
}

/// The axis of the kind: the one that is free, or that its cone is about.
int mainAxis(const Freedoms& f, int travels, int turns) {
    if (turns == 1) return freeAxis(f.turn);
    if (travels == 1) return freeAxis(f.travel);
    return travels == 0 && f.cone ? f.coneAxis : 0;
}

}  // namespace

JointFromGltf jointFromGltf(const GltfJoint& from) {
    Freedoms freedoms = freedomsOf(from);
    const int travels = 3 - locked(freedoms.travel), turns = 3 - locked(freedoms.turn);
    const int axis = mainAxis(freedoms, travels, turns);
    turnFreedoms(freedoms, axis);
    JointFromGltf result{.turn = turnTo(axis), .lost = std::move(freedoms.lost)};
    result.joint = kindOf(freedoms, travels, turns, result.lost);
    return result;
}

GltfJoint reversed(GltfJoint joint) {
    for (GltfLimit& limit : joint.limits) {
        if (limit.linearAxes.size() + limit.angularAxes.size() != 1) continue;
        std::swap(limit.min, limit.max);
        for (std::optional<float>* end : {&limit.min, &limit.max})
            if (*end) *end = -**end;
    }
    for (GltfDrive& drive : joint.drives) {
        drive.positionTarget = -drive.positionTarget;
        drive.velocityTarget = -drive.velocityTarget;
    }
    return joint;
}

}  // namespace ragtop
