#include <cmath>
#include <limits>

#include "import_support.h"
#include "ragtop/robot.h"
#include "ragtop/world.h"

// Robots with one element each that matters, beside the closed form of their motion. Files are Z up, worlds Y up.
namespace ragtop {
namespace {

constexpr double kStep = 1.0 / 240;
constexpr float kG = 9.81f;

/// Places after a time of constant acceleration are off by at most half a step's share of the speed that was gained.
constexpr double drift(double acceleration, double seconds) { return 0.5 * acceleration * seconds * kStep; }

std::string link(const std::string& name, double mass, const std::string& inner = "", double moment = 0.02,
                 const std::string& center = "") {
    const std::string i = std::to_string(moment);
    return "<link name='" + name + "'><inertial>" + center + "<mass value='" + std::to_string(mass) +
           "'/><inertia ixx='" + i + "' iyy='" + i + "' izz='" + i + "' ixy='0' ixz='0' iyz='0'/></inertial>" + inner +
           "</link>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& inner) {
    return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
           "'/>" + inner + "</joint>\n";
}

std::string robotXml(const std::string& inner) { return "<robot name='r'><link name='world'/>\n" + inner + "</robot>"; }

/// A link of `mass` kg on one joint of the world.
std::string oneJoint(const std::string& type, const std::string& inner, double mass = 1, double moment = 0.02,
                     const std::string& center = "") {
    return robotXml(link("l", mass, "", moment, center) + joint("j", type, "world", "l", inner));
}

const std::string kWide = "<limit lower='-100' upper='100' effort='0' velocity='0'/>";

/// A robot in a world, from the text of its description.
class RobotLaw : public testing::Test {
protected:
    void build(const std::string& text, const Vec3& gravity = {0, -kG, 0}, const RobotOptions& options = {}) {
        const TemporaryFile file("law.urdf", text);
        robot = loadRobot(file.path(), options);
        world = World(WorldSettings{.gravity = gravity, .sleeping = false});
        ids = makeRobot(world, robot, {}, options);
    }
    BodyId body(const std::string& name) const {
        for (std::size_t i = 0; i < robot.bodies.size(); ++i)
            if (robot.bodies[i].name == name) return ids.bodies[i];
        throw std::out_of_range(name);
    }
    JointId jointOf(const std::string& name) const {
        return ids.joints.at(static_cast<std::size_t>(robot.findJoint(name)));
    }
    float at(const std::string& name) const { return world.state(jointOf(name)).coordinate; }
    float speed(const std::string& name) const { return world.state(jointOf(name)).speed; }
    void run(double seconds) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) world.step(kStep);
    }
    void push(const std::string& name, const Vec3& force, double seconds) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) {
            world.applyForce(body(name), force, world.centerOfMass(body(name)));
            world.step(kStep);
        }
    }
    void drive(std::vector<float> to, double seconds) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) {
            driveRobot(world, robot, ids, to, kStep);
            world.step(kStep);
        }
    }

    Robot robot;
    World world;
    RobotIds ids;
};

TEST_F(RobotLaw, HingesSwingWithTheirPeriod) {
    // I = 0.02 + 1·0.5², T = 2π √(I/(m g d)) (1 + θ²/16).
    build(oneJoint("revolute", "<origin rpy='0 0.1 0'/><axis xyz='0 1 0'/>" + kWide, 1, 0.02,
                   "<origin xyz='0 0 -0.5'/>"));
    const double period = 2 * 3.14159265 * std::sqrt(0.27 / (9.81 * 0.5)) * (1 + 0.01 / 16);
    double last = 0, crossing = 0;
    for (int i = 1; crossing == 0; ++i) {
        world.step(kStep);
        const double angle = static_cast<double>(at("j")) + 0.1;
        if (i > 1 && last > 0 && angle <= 0) crossing = (i - 1 + last / (last - angle)) * kStep;
        last = angle;
        ASSERT_LT(i, 1000);
    }
    EXPECT_NEAR(crossing, period / 4, 1e-3 * period);
}

TEST_F(RobotLaw, SlidersFallFreely) {
    build(oneJoint("prismatic", "<axis xyz='0 0 -1'/>" + kWide));
    run(1);
    EXPECT_NEAR(at("j"), 0.5f * kG, drift(kG, 1));
    EXPECT_NEAR(speed("j"), kG, 1e-3f);
}

TEST_F(RobotLaw, RangesEndMotion) {
    build(oneJoint("prismatic", "<axis xyz='0 0 1'/><limit lower='-0.25' upper='1' effort='0' velocity='0'/>"));
    run(2);
    EXPECT_NEAR(at("j"), -0.25f, 1e-4f);
}

TEST_F(RobotLaw, AxesNeedNoUnitLengthAndTurnWithTheirOrigin) {
    // z of a joint that is turned by a quarter about y is x of the file.
    build(oneJoint("prismatic", "<origin xyz='1 2 3' rpy='0 1.5707963 0'/><axis xyz='0 0 4'/>" + kWide), {0, 0, 0});
    push("l", {2, 0, 0}, 1);
    EXPECT_NEAR(at("j"), 1, drift(2, 1));
    EXPECT_NEAR(world.pose(body("l")).position.x, 2, drift(2, 1));
    EXPECT_NEAR(world.pose(body("l")).position.y, 3, 1e-4);
    EXPECT_NEAR(world.pose(body("l")).position.z, -2, 1e-4);
}

TEST_F(RobotLaw, DampingLetsSpeedDecay) {
    build(oneJoint("prismatic", "<axis xyz='1 0 0'/>" + kWide + "<dynamics damping='3'/>", 2));
    world.setVelocity(body("l"), {4, 0, 0}, {});
    run(1);
    EXPECT_NEAR(speed("j"), 4 * std::exp(-1.5), 4e-3);
    EXPECT_NEAR(at("j"), 4 / 1.5 * (1 - std::exp(-1.5)), 4e-3);
}

TEST_F(RobotLaw, FrictionIsADryForce) {
    // Stops after v²/(2 F/m) = 1 m.
    build(oneJoint("prismatic", "<axis xyz='1 0 0'/>" + kWide + "<dynamics friction='4'/>", 2));
    world.setVelocity(body("l"), {2, 0, 0}, {});
    run(1.5);
    EXPECT_NEAR(at("j"), 1, drift(2, 1));
    EXPECT_NEAR(speed("j"), 0, 1e-4);
    push("l", {3.9f, 0, 0}, 0.5);
    EXPECT_NEAR(at("j"), 1, drift(2, 1));
}

TEST_F(RobotLaw, FrictionOfHingesIsATorque) {
    // ω²/(2 τ/I) = 1 rad.
    build(oneJoint("continuous", "<axis xyz='0 0 1'/><dynamics friction='0.5'/>", 1, 0.25));
    world.setVelocity(body("l"), {}, {0, 2, 0});
    run(1.5);
    EXPECT_NEAR(at("j"), 1, drift(2, 1));
}

TEST_F(RobotLaw, EffortBoundsTheDrive) {
    // 15 N against a weight of 9.81 N: a = 5.19 m/s².
    build(oneJoint("prismatic", "<axis xyz='0 0 1'/><limit lower='-9' upper='9' effort='15' velocity='0'/>"));
    drive({9}, 0.5);
    EXPECT_NEAR(at("j"), 0.5 * (15 - 9.81) * 0.25, drift(5.19, 0.5));
    EXPECT_NEAR(speed("j"), (15 - 9.81) * 0.5, 5e-3);
}

TEST_F(RobotLaw, EffortTooWeakSinks) {
    build(oneJoint("prismatic", "<axis xyz='0 0 1'/><limit lower='-9' upper='9' effort='5' velocity='0'/>"));
    drive({0}, 0.5);
    EXPECT_NEAR(speed("j"), -(9.81 - 5) * 0.5, 5e-3);
}

TEST_F(RobotLaw, VelocityCapsTheDrive) {
    build(oneJoint("revolute", "<axis xyz='0 0 1'/><limit lower='-9' upper='9' effort='50' velocity='1.5'/>"));
    drive({8}, 2);
    EXPECT_NEAR(speed("j"), 1.5, 1e-4);
    EXPECT_NEAR(at("j"), 3, 0.02);
    drive({8}, 4);
    EXPECT_NEAR(at("j"), 8, 1e-4);
}

TEST_F(RobotLaw, FollowersWeighOnTheirLeader) {
    // F = (m₁ + 2² m₂) a.
    build(
        robotXml(link("l", 1) + link("m", 0.5) + joint("j", "prismatic", "world", "l", "<axis xyz='1 0 0'/>" + kWide) +
                 joint("k", "prismatic", "world", "m",
                       "<axis xyz='0 1 0'/>" + kWide + "<mimic joint='j' multiplier='2' offset='0.3'/>")),
        {0, 0, 0});
    EXPECT_NEAR(robot.joints[1].home, 0.3, 1e-6);
    push("l", {6, 0, 0}, 1);
    EXPECT_NEAR(at("j"), 0.5 * 6 / 3, drift(2, 1));
    EXPECT_NEAR(at("k"), 2 * at("j") + 0.3f, 1e-4);
}

TEST_F(RobotLaw, FollowingHingesTurnTheOtherWay) {
    build(robotXml(link("l", 1, "", 0.1) + link("m", 1, "", 0.4) +
                   joint("j", "continuous", "world", "l", "<axis xyz='0 0 1'/>") +
                   joint("k", "continuous", "world", "m", "<axis xyz='0 0 1'/><mimic joint='j' multiplier='-0.5'/>")),
          {0, 0, 0});
    // α = τ/(I₁ + I₂/4) = 5 rad/s², 2.5 rad and many turns after some seconds.
    for (int i = 0; i < 240; ++i) {
        world.applyTorque(body("l"), {0, 1, 0});
        world.step(kStep);
    }
    EXPECT_NEAR(at("j"), 2.5, drift(5, 1));
    run(3);
    EXPECT_NEAR(at("j"), 17.5, 0.05);
    EXPECT_NEAR(at("k"), -0.5f * at("j"), 1e-3);
}

TEST_F(RobotLaw, FollowersOfFollowersMultiply) {
    const std::string mimic = "<axis xyz='1 0 0'/>" + kWide + "<mimic multiplier='3' joint=";
    build(robotXml(link("l", 1) + link("m", 1) + link("n", 1) +
                   joint("j", "prismatic", "world", "l", "<axis xyz='1 0 0'/>" + kWide) +
                   joint("k", "prismatic", "world", "m", mimic + "'j'/>") +
                   joint("i", "prismatic", "world", "n", mimic + "'k'/>")),
          {0, 0, 0});
    push("l", {91, 0, 0}, 0.5);
    EXPECT_NEAR(at("j"), 0.125, drift(1, 0.5));
    EXPECT_NEAR(at("i"), 9 * at("j"), 1e-3);
}

TEST_F(RobotLaw, AMultiplierOfZeroLocks) {
    build(robotXml(link("l", 1) + link("m", 1) + joint("j", "prismatic", "world", "l", "<axis xyz='1 0 0'/>" + kWide) +
                   joint("k", "prismatic", "world", "m",
                         "<axis xyz='0 0 1'/>" + kWide + "<mimic joint='j' multiplier='0' offset='0.2'/>")));
    run(1);
    EXPECT_NEAR(at("k"), 0.2, 1e-4);
}

TEST_F(RobotLaw, SafetyIsASoftEnd) {
    // Stiffness 20 · 30 N/m: rests m g/600 beyond the soft end.
    build(oneJoint(
        "prismatic",
        "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='0' velocity='0'/>"
        "<safety_controller soft_lower_limit='-0.5' soft_upper_limit='0.5' k_position='20' k_velocity='30'/>"));
    run(4);
    EXPECT_NEAR(at("j"), -0.5 - 9.81 / 600, 1e-4);
}

TEST_F(RobotLaw, BeyondSafetyTheRangeStillEnds) {
    build(
        oneJoint("prismatic",
                 "<axis xyz='0 0 1'/><limit lower='-0.6' upper='1' effort='0' velocity='0'/>"
                 "<safety_controller soft_lower_limit='-0.5' soft_upper_limit='0.5' k_position='1' k_velocity='5'/>"));
    run(4);
    EXPECT_NEAR(at("j"), -0.6, 1e-4);
}

TEST_F(RobotLaw, PlanarJointsMoveInTheirPlane) {
    build(oneJoint("planar", "<origin xyz='0 0 5'/><axis xyz='1 0 0'/>"));
    world.setVelocity(body("l"), {0, 0, -1}, {2, 0, 0});
    push("l", {50, 0, 0}, 0.5);
    const Pose pose = world.pose(body("l"));
    EXPECT_NEAR(pose.position.x, 0, 1e-4);
    EXPECT_NEAR(pose.position.y, 5 - 0.5 * 9.81 * 0.25, drift(kG, 0.5));
    EXPECT_NEAR(pose.position.z, -0.5, 1e-3);
    EXPECT_NEAR(world.angularVelocity(body("l")).x, 2, 1e-3);
    EXPECT_TRUE(robot.warnings.empty()) << robot.warnings.front();
}

TEST_F(RobotLaw, FloatingJointsFlyFreely) {
    build(oneJoint("floating", "<origin xyz='0 0 5'/>"));
    world.setVelocity(body("l"), {3, 0, 0}, {1, 2, 3});
    run(0.5);
    EXPECT_NEAR(world.pose(body("l")).position.x, 1.5, 1e-3);
    EXPECT_NEAR(world.pose(body("l")).position.y, 5 - 0.5 * 9.81 * 0.25, drift(kG, 0.5));
}

TEST_F(RobotLaw, ContinuousJointsCountTheirTurns) {
    build(oneJoint("continuous", "<axis xyz='0 0 1'/>"), {0, 0, 0});
    world.setVelocity(body("l"), {}, {0, 20, 0});
    run(4);
    EXPECT_NEAR(at("j"), 80, 0.05);
}

TEST_F(RobotLaw, RangesOfManyTurnsEndThere) {
    build(oneJoint("revolute", "<axis xyz='0 0 1'/><limit lower='-3' upper='12.5' effort='0' velocity='0'/>"),
          {0, 0, 0});
    world.setVelocity(body("l"), {}, {0, 10, 0});
    run(2);
    EXPECT_NEAR(at("j"), 12.5, 1e-3);
}

TEST_F(RobotLaw, HomeIsWithinTheRange) {
    build(oneJoint("revolute", "<axis xyz='0 0 1'/><limit lower='7' upper='9' effort='0' velocity='0'/>"), {0, 0, 0});
    EXPECT_FLOAT_EQ(robot.joints[0].home, 7);
    run(0.5);
    EXPECT_NEAR(at("j"), 7, 1e-3);
    EXPECT_LT(length(world.angularVelocity(body("l"))), 1e-3f);
}

TEST_F(RobotLaw, HomeHeedsThoseThatFollow) {
    const std::string wide = "<axis xyz='1 0 0'/><limit effort='0' velocity='0' ";
    build(
        robotXml(link("l", 1) + link("m", 1) + joint("j", "prismatic", "world", "l", wide + "lower='-1' upper='1'/>") +
                 joint("k", "prismatic", "world", "m",
                       wide + "lower='0.5' upper='2'/><mimic joint='j' multiplier='-2' offset='0.1'/>")),
        {0, 0, 0});
    EXPECT_NEAR(robot.joints[0].home, -0.2, 1e-6);
    EXPECT_NEAR(robot.joints[1].home, 0.5, 1e-6);
    run(0.2);
    EXPECT_NEAR(at("j"), -0.2, 1e-4);
    EXPECT_NEAR(at("k"), 0.5, 1e-4);
}

TEST_F(RobotLaw, SphericalJointsSwingAnyWay) {
    // A conical pendulum: ω² = g/(L cos θ), with moments that vanish beside m L².
    const double angle = 0.3, spin = std::sqrt(9.81 / std::cos(angle));
    build(robotXml(link("l", 1, "", 1e-4, "<origin xyz='0 0 -1'/>") +
                   joint("j", "spherical", "world", "l", "<origin rpy='0 -0.3 0'/>")));
    const float radius = static_cast<float>(std::sin(angle));
    const float rate = static_cast<float>(spin);
    const float sign = world.centerOfMass(body("l")).x > 0 ? 1.0f : -1.0f;
    world.setVelocity(body("l"), {0, 0, -sign * rate * radius}, {0, rate, 0});
    run(2 * 3.14159265 / spin);
    EXPECT_NEAR(world.centerOfMass(body("l")).x, static_cast<double>(sign * radius), 0.02);
    EXPECT_NEAR(world.centerOfMass(body("l")).y, -std::cos(angle), 0.01);
}

TEST_F(RobotLaw, SphericalJointsHaveFrictionAndDamping) {
    // Iω' = −c ω − τ about one axis: ω = (ω₀ + τ/c) e^{−ct/I} − τ/c.
    build(robotXml(link("l", 1, "", 0.5) +
                   joint("j", "spherical", "world", "l", "<dynamics damping='0.25' friction='0.1'/>")),
          {0, 0, 0});
    world.setVelocity(body("l"), {}, {0, 3, 0});
    run(1);
    EXPECT_NEAR(world.angularVelocity(body("l")).y, (3 + 0.4) * std::exp(-0.5) - 0.4, 0.01);
}

TEST_F(RobotLaw, InertiaTurnsWithItsOrigin) {
    // Moments 1, 2, 3 turned by a quarter about x: 2 about z.
    build(robotXml("<link name='l'><inertial><origin rpy='1.5707963 0 0'/><mass value='1'/><inertia ixx='1' iyy='2' "
                   "izz='3' ixy='0' ixz='0' iyz='0'/></inertial></link>" +
                   joint("j", "continuous", "world", "l", "<axis xyz='0 0 1'/>")),
          {0, 0, 0});
    for (int i = 0; i < 240; ++i) {
        world.applyTorque(body("l"), {0, 1, 0});
        world.step(kStep);
    }
    EXPECT_NEAR(speed("j"), 0.5, 1e-3);
}

TEST_F(RobotLaw, FixedLinksSwingAsOne) {
    // Two kilograms at 0.5 m and 1 m: I = 0.25 + 1 + 0.04, m g d = g · 1.5.
    build(robotXml(link("l", 1, "", 0.02, "<origin xyz='0 0 -0.5'/>") + link("m", 1) +
                   joint("j", "continuous", "world", "l", "<origin rpy='0 0.05 0'/><axis xyz='0 1 0'/>") +
                   joint("k", "fixed", "l", "m", "<origin xyz='0 0 -1'/>")));
    const double rate = std::sqrt(9.81 * 1.5 / 1.29);
    run(3.14159265 / rate);
    EXPECT_NEAR(at("j"), -0.1, 1e-3);
}

std::string collision(const std::string& geometry, const std::string& origin = "") {
    return "<collision>" + origin + "<geometry>" + geometry + "</geometry></collision>";
}

/// Height above the ground at which the centre of a link with that shape comes to rest.
class RobotShape : public RobotLaw {
protected:
    double restingHeight(const std::string& shape, const RobotOptions& options = {}) {
        const TemporaryFile file("shape.urdf", "<robot name='r'>" + link("l", 1, shape, 0.1) + "</robot>");
        robot = loadRobot(file.path(), options);
        world = World(WorldSettings{});
        world.create(StaticBody{.shape = Box{{5, 1, 5}}, .position = {0, -1, 0}});
        ids = makeRobot(world, robot, {{0, 0.7, 0}, {}}, options);
        run(2);
        return world.pose(ids.bodies[0]).position.y;
    }
};

TEST_F(RobotShape, BoxesRestOnTheirFaces) { EXPECT_NEAR(restingHeight(collision("<box size='1 1 0.4'/>")), 0.2, 2e-3); }
TEST_F(RobotShape, SpheresRestOnTheirRadius) {
    EXPECT_NEAR(restingHeight(collision("<sphere radius='0.3'/>")), 0.3, 2e-3);
}
TEST_F(RobotShape, CylindersStandAlongZ) {
    EXPECT_NEAR(restingHeight(collision("<cylinder radius='0.5' length='0.6'/>")), 0.3, 2e-3);
}
TEST_F(RobotShape, CapsulesLieTurnedByTheirOrigin) {
    EXPECT_NEAR(restingHeight(collision("<capsule radius='0.2' length='0.6'/>", "<origin rpy='1.5707963 0 0'/>")), 0.2,
                2e-3);
}
TEST_F(RobotShape, OriginsShiftShapes) {
    EXPECT_NEAR(restingHeight(collision("<box size='1 1 0.4'/>", "<origin xyz='0 0 -0.1'/>")), 0.3, 2e-3);
}
TEST_F(RobotShape, MeshesOfPackagesAreFoundAndScaled) {
    const std::filesystem::path folder = temporaryPath("my_robot");
    std::filesystem::create_directories(folder / "meshes");
    std::ofstream(folder / "meshes" / "cube.obj")
        << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
           "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    const std::string mesh = collision("<mesh filename='package://my_robot/meshes/cube.obj' scale='1 1 0.5'/>",
                                       "<origin xyz='-.5 -.5 -.25'/>");
    EXPECT_NEAR(restingHeight(mesh, {.packageRoots = {folder.parent_path()}}), 0.25, 2e-3);
    EXPECT_TRUE(robot.warnings.empty()) << robot.warnings.front();
    EXPECT_NEAR(restingHeight(mesh, {.packageRoots = {folder}}), 0.25, 2e-3);
}

}  // namespace
}  // namespace ragtop
