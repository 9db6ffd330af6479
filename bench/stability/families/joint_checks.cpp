#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "constraints/joint_swing.h"
#include "joint_kinds.h"
#include "ragtop/scene.h"
#include "ragtop/tasks.h"

namespace ragtop::stability {
namespace {
namespace joint_checks_cases {

constexpr double kDegree = std::numbers::pi / 180;

// ---- signed angles to the edges of swing limits, against brute force

/// Not exactly along x, where a swing has no direction.
Vec3 anyDirection(Dice& dice) {
    for (;;) {
        const Vec3 d{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
        if (const float l = length(d); l > 0.1f && l < 1 && d.y != 0) return (1 / l) * d;
    }
}

/// The least angle from d to a closed line through these directions: the nearest of them, then its two neighbours'
/// chords.
double nearest(const std::vector<Vec3>& edge, const Vec3& d) {
    std::size_t at = 0;
    float least = 9;
    for (std::size_t i = 0; i < edge.size(); ++i) {
        const float square = lengthSquared(edge[i] - d);
        if (square < least) least = square, at = i;
    }
    const Vec3 middle = edge[at];
    for (const std::size_t next : {(at + 1) % edge.size(), (at + edge.size() - 1) % edge.size()}) {
        const Vec3 chord = edge[next] - middle;
        const float along = std::clamp(dot(d - middle, chord) / lengthSquared(chord), 0.0f, 1.0f);
        least = smaller(least, lengthSquared(normalized(middle + along * chord) - d));
    }
    return 2 * std::asin(0.5 * std::sqrt(static_cast<double>(least)));
}

double marginOf(const SwingLimit& limit, const Vec3& d) {
    SwingMargin sides[SwingLimit::kSides];
    swingMargins(limit, d, sides);
    return static_cast<double>(sides[0].margin);
}

constexpr int kDirections = 100000;

/// Ellipses from slender to nearly round and beyond a hemisphere: the swing vector is inside where
/// (s_y/y)² + (s_z/z)² ≤ 1.
void ellipse(Trial& trial) {
    constexpr double kHalfAngles[][2] = {{0.3, 1.2}, {1.2, 0.3}, {0.9, 1.0}, {2.2, 0.6}, {0.2, 0.25}};
    constexpr int kEdge = 4000;
    Dice dice;
    double worst = 0;
    for (const auto& [y, z] : kHalfAngles) {
        SwingLimit limit;
        limit.shape = SwingShape::ellipse;
        limit.y = static_cast<float>(y), limit.z = static_cast<float>(z);
        std::vector<Vec3> edge;
        for (int i = 0; i < kEdge; ++i) {
            const double phi = 2 * std::numbers::pi * i / kEdge;
            edge.push_back(
                directionOfSwing(static_cast<float>(y * std::cos(phi)), static_cast<float>(z * std::sin(phi))));
        }
        for (int i = 0; i < kDirections / 5; ++i) {
            const Vec3 d = anyDirection(dice);
            const double across = std::hypot(static_cast<double>(d.y), static_cast<double>(d.z));
            const double swing = std::atan2(across, static_cast<double>(d.x)) / across;
            const double sy = -swing * static_cast<double>(d.z) / y, sz = swing * static_cast<double>(d.y) / z;
            const double exact = (sy * sy + sz * sz <= 1 ? 1 : -1) * nearest(edge, d);
            worst = larger(worst, std::abs(marginOf(limit, d) - exact));
        }
    }
    trial.expectAtMost("signed angle", worst, 0.1 * kDegree, "rad");
}

/// Inside where the great arc to a place outside crosses the edge an odd number of times.
bool isInside(const std::vector<Vec3>& corners, const Vec3& d) {
    const Vec3 outside{-1, 1e-3f, 2e-3f}, n = cross(d, outside);
    int crossings = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const Vec3 m = cross(a, b);
        if (dot(n, a) * dot(n, b) >= 0 || dot(m, d) * dot(m, outside) >= 0) continue;
        const Vec3 line = cross(n, m), at = dot(line, a) > 0 ? line : -line;
        if (dot(cross(d, at), n) > 0 && dot(cross(at, outside), n) > 0) ++crossings;
    }
    return crossings % 2 == 1;
}

struct CornerAngles {
    double about, from;  ///< degrees about x and from x
};

/// A convex polygon, a concave one and one that is larger than a hemisphere.
void polygon(Trial& trial) {
    const std::vector<std::vector<CornerAngles>> polygons{
        {{0, 40}, {90, 60}, {180, 30}, {270, 50}},
        {{0, 70}, {45, 20}, {90, 80}, {150, 60}, {180, 25}, {225, 70}, {290, 40}},
        {{0, 130}, {70, 150}, {140, 120}, {210, 160}, {280, 110}},
    };
    constexpr int kPerEdge = 1000;
    Dice dice;
    double worst = 0;
    for (const std::vector<CornerAngles>& angles : polygons) {
        ReachPolygon reach;
        reach.count = static_cast<int>(angles.size());
        std::vector<Vec3> corners, edge;
        for (std::size_t i = 0; i < angles.size(); ++i) {
            const double a = angles[i].about * kDegree, f = angles[i].from * kDegree;
            corners.push_back(toVec3({std::cos(f), std::sin(f) * std::cos(a), std::sin(f) * std::sin(a)}));
            reach.corners[i].direction = corners[i];
        }
        for (std::size_t i = 0; i < corners.size(); ++i)
            for (int k = 0; k < kPerEdge; ++k) {
                const float share = static_cast<float>(k) / kPerEdge;
                edge.push_back(normalized((1 - share) * corners[i] + share * corners[(i + 1) % corners.size()]));
            }
        SwingLimit limit;
        compile(limit, reach);
        for (int i = 0; i < kDirections / 3; ++i) {
            const Vec3 d = anyDirection(dice);
            const double exact = (isInside(corners, d) ? 1 : -1) * nearest(edge, d);
            worst = larger(worst, std::abs(marginOf(limit, d) - exact));
        }
    }
    trial.expectAtMost("signed angle", worst, 0.1 * kDegree, "rad");
}

// ---- couplings

/// Two limp links hang from a wall, let go level, with a tendon over both hinges: 0.7 q₁ + q₂ stays in its range.
void tendon(Trial& trial) {
    World world;
    BodyDef link = solidBody(Box{{0.25f, 0.03f, 0.03f}}, {0.25, 0, 0}, 1, {});
    link.shapes[0].filter.mask = 0;
    const BodyId first = world.create(link);
    link.pose.position.x = 0.75;
    const BodyId second = world.create(link);
    const Quat alongZ = rotationBetween({1, 0, 0}, {0, 0, 1});
    HingeDef hip, knee;
    hip.bodies.b = knee.bodies.a = first;
    knee.bodies.b = second;
    hip.bodies.frameA = {{}, alongZ}, knee.bodies.frameA = {{0.25f, 0, 0}, alongZ};
    hip.bodies.frameB = knee.bodies.frameB = {{-0.25f, 0, 0}, alongZ};
    CouplingDef def;
    def.count = 2;
    def.parts[0] = {world.create(JointDef(hip)), 0, 0.7f};
    def.parts[1] = {world.create(JointDef(knee)), 0, 1};
    def.sum.limit = Range{-0.6f, 0.4f};
    const CouplingId sum = world.create(def);
    double beyond = 0;
    for (double t = 0; t < 10; t += trial.dt()) {
        world.step(trial.dt());
        beyond = larger(beyond, -static_cast<double>(world.state(sum).limitMargin));
    }
    trial.expectAtMost("beyond its range", beyond, 0.1 * kDegree, "rad");
}

// ---- definitions that mean nothing

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// One error of one line that says something; else what was made is destroyed again.
bool isRefused(World& world, const JointDef& def) {
    try {
        world.destroy(world.create(def));
        return false;
    } catch (const std::invalid_argument& error) {
        const std::string text = error.what();
        return text.size() > 10 && text.find('\n') == std::string::npos;
    }
}

/// What is wrong with the ends of a joint, whatever its kind.
std::vector<std::function<void(JointBodies&)>> wrongEnds(BodyId body, BodyId gone) {
    return {
        [](JointBodies& ends) { ends.frameA.position.y = kNan; },
        [](JointBodies& ends) { ends.frameB.rotation.x = kNan; },
        [](JointBodies& ends) {
            ends.frameA.rotation = {0, 0, 0, 0};
        },
        [](JointBodies& ends) {
            ends.frameB.rotation = {0, 0, 0, 3};
        },
        [](JointBodies& ends) { ends.breakForce = -1; },
        [](JointBodies& ends) { ends.breakTorque = kNan; },
        [=](JointBodies& ends) { ends.a = ends.b = body; },
        [](JointBodies& ends) { ends.a = ends.b = {}; },
        [=](JointBodies& ends) { ends.b = gone; },
    };
}

std::vector<AxisDef> wrongAxes() {
    std::vector<AxisDef> wrong(8);
    wrong[0].limit = Range{1, -1};
    wrong[1].limit = Range{kNan, 1};
    wrong[2].motor = Motor{kNan, 1};
    wrong[3].motor = Motor{1, -1};
    wrong[4].spring = Spring{-1, 0};
    wrong[5].spring = Spring{kNan, 0};
    wrong[6].friction = -1;
    wrong[7].stop.restitution = 2;
    return wrong;
}

/// Each coordinate of each kind with each fault, and what only one kind can have wrong.
std::vector<JointDef> wrongJoints() {
    std::vector<JointDef> wrong;
    for (const AxisDef& axis : wrongAxes()) {
        wrong.push_back(HingeDef{{}, axis.limit, axis.stop, axis.motor, axis.spring, 0, axis.friction});
        wrong.push_back(SliderDef{{}, axis.limit, axis.stop, axis.motor, axis.spring, 0, axis.friction});
        for (int i = 0; i < 2; ++i) {
            const AxisDef first = i == 0 ? axis : AxisDef{}, second = i == 1 ? axis : AxisDef{};
            wrong.push_back(CylindricalDef{{}, first, second});
            wrong.push_back(UniversalDef{{}, first, second});
            wrong.push_back(PlaneDef{{}, first, second});
            wrong.push_back(SixDofDef{{}, first, second});
        }
        wrong.push_back(ScrewDef{{}, 0.1f, axis});
    }
    wrong.push_back(ScrewDef{{}, kNan});
    wrong.push_back(DistanceDef{{}, Range{2, 1}});
    wrong.push_back(DistanceDef{{}, Range{-1, 1}});
    wrong.push_back(BallDef{.swingLimit = 0.0f});
    wrong.push_back(BallDef{.swingLimit = kNan});
    wrong.push_back(BallDef{.swingLimit = 1.0f, .swingEllipse = SwingEllipse{1, 1}});
    wrong.push_back(BallDef{.swingEllipse = SwingEllipse{0, 1}});
    wrong.push_back(BallDef{.swingPyramid = SwingPyramid{{1, -1}, {-1, 1}}});
    wrong.push_back(BallDef{.reach = ReachPolygon{}});
    wrong.push_back(BallDef{.twistLimit = Range{1, -1}});
    wrong.push_back(BallDef{.target = {0, 0, 0, 0}});
    wrong.push_back(PathDef{});
    PathDef doubled;
    doubled.curve.count = 3;
    doubled.curve.points[1] = doubled.curve.points[2] = {1, 0, 0};
    wrong.push_back(doubled);
    return wrong;
}

void badDefinitions(Trial& trial) {
    World world;
    const BodyDef def = solidBody(Sphere{0.5f}, {}, 1, {});
    const BodyId body = world.create(def), gone = world.create(def);
    world.destroy(gone);
    Dice dice;
    int asked = 0, accepted = 0;
    const auto ask = [&](JointDef joint, const std::function<void(JointBodies&)>& spoil) {
        std::visit(
            [&](auto& each) {
                each.bodies.b = body;
                if (spoil) spoil(each.bodies);
            },
            joint);
        ++asked;
        if (!isRefused(world, joint)) ++accepted;
    };
    for (const JointType& type : jointTypes())
        for (const auto& spoil : wrongEnds(body, gone)) ask(type.draw(dice).def, spoil);
    for (const JointDef& joint : wrongJoints()) ask(joint, {});
    trial.expectAtLeast("asked", asked, 250, "1");
    trial.expectAtMost("without one clear error", accepted, 0, "1");
}

// ---- all kinds, in motion, with drives: the same bits from a state saved half way, and however it is computed

void drive(Dice& dice, JointDef& def) {
    const auto set = [&](auto& axis) {
        axis.motor = Motor{dice.between(-3, 3), 0.5f};
        axis.spring = Spring{20, 0.5f};
    };
    std::visit(
        [&](auto& joint) {
            if constexpr (requires { joint.motor; }) set(joint);
            if constexpr (requires { joint.turn; }) set(joint.turn);
            if constexpr (requires { joint.travel; }) set(joint.travel);
            if constexpr (requires { joint.second; }) set(joint.first), set(joint.second);
            if constexpr (requires { joint.swingY; }) {
                for (AxisDef* axis : {&joint.twist, &joint.swingY, &joint.x})
                    if (!axis->limit || axis->limit->lower < axis->limit->upper) set(*axis);
            }
            if constexpr (requires { joint.twistSpring; }) joint.spring = Spring{5, 0.1f};
        },
        def);
}

Scene drivenJoints() {
    Scene scene;
    Dice dice;
    int place = 0;
    for (const bool two : {false, true})
        for (const JointType& type : jointTypes())
            for (int i = 0; i < 10; ++i) {
                Drawn drawn = type.draw(dice);
                if (i % 2 == 1) drive(dice, drawn.def);
                addJoint(scene, dice, drawn, {4.0 * place++, 0, 0}, two);
            }
    return scene;
}

void restored(Trial& trial) {
    constexpr int kSteps = 120;
    const Scene scene = drivenJoints();
    std::set<std::uint64_t> hashes;
    const auto run = [&](int threads, int lanes, bool restores) {
        WorldConfig config;
        config.tasks = threads > 1 ? threadTasks(threads) : serialTasks();
        config.lanes = lanes;
        World world({}, config);
        const SceneInstance instance(scene, world);
        std::vector<std::byte> half;
        for (int i = 0; i < kSteps; ++i) {
            if (i == kSteps / 2 && restores) {
                half.resize(world.saveSize());
                world.save(half);
            }
            world.step(trial.dt());
        }
        if (restores) {
            world.restore(half);
            for (int i = kSteps / 2; i < kSteps; ++i) world.step(trial.dt());
        }
        hashes.insert(world.hash());
    };
    run(1, 0, true);
    for (const int lanes : {4, 8, 16}) run(1, lanes, false);
    for (const int threads : {2, 4}) run(threads, 0, false);
    trial.expectNear("different hashes", static_cast<double>(hashes.size()), 1, 0, "1");
}

}  // namespace joint_checks_cases
}  // namespace

Family jointChecks() {
    using namespace joint_checks_cases;
    return {"joint_checks",
            {
                {"elliptic cone", ellipse, Kind::ragtopOnly},
                {"reach polygon", polygon, Kind::ragtopOnly},
                {"tendon over two hinges", tendon, Kind::ragtopOnly},
                {"bad definitions", badDefinitions, Kind::ragtopOnly},
                {"all kinds, restored half way", restored, Kind::ragtopOnly},
            }};
}

}  // namespace ragtop::stability
