#include <algorithm>
#include <cmath>

#include "import_support.h"
#include "ragtop/robot.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

std::string mjcf(const std::string& inner) { return "<mujoco model='m'>\n" + inner + "</mujoco>\n"; }
std::string world(const std::string& inner) { return "<worldbody>\n" + inner + "</worldbody>\n"; }
std::string ball(const std::string& name, const std::string& joints, const std::string& rest = "") {
    return "<body name='" + name + "'>" + joints + "<geom size='0.1' mass='1'/>" + rest + "</body>\n";
}

Robot robotOf(const std::string& text) {
    const TemporaryFile file("robot.xml", text);
    return loadRobot(file.path());
}
std::string failureOf(const std::string& text) {
    const TemporaryFile file("broken.xml", text);
    return importError(file.path(), [&] { loadRobot(file.path()); });
}
const HingeDef& hinge(const Robot& robot, const std::string& name) {
    return std::get<HingeDef>(robot.joints.at(static_cast<std::size_t>(robot.findJoint(name))).joint);
}

TEST(LoadMjcf, DefaultsReachElementsByTheirClass) {
    const Robot robot = robotOf(mjcf(
        "<compiler angle='radian'/><default><joint damping='1'/><default class='soft'><joint stiffness='5'/></default>"
        "</default>" +
        world(ball("a", "<joint name='plain'/>") +
              "<body name='b' childclass='soft'><geom size='1' mass='2'/>"
              "<joint name='child' damping='3' range='-1 2'/></body>" +
              ball("c", "<joint name='own' class='soft' limited='false' range='-1 1'/>"))));
    EXPECT_FLOAT_EQ(hinge(robot, "plain").spring->damping, 1);
    EXPECT_FLOAT_EQ(hinge(robot, "plain").spring->stiffness, 0);
    EXPECT_FLOAT_EQ(hinge(robot, "child").spring->damping, 3);
    EXPECT_FLOAT_EQ(hinge(robot, "child").spring->stiffness, 5);
    EXPECT_FLOAT_EQ(hinge(robot, "child").limit->upper, 2);
    EXPECT_FLOAT_EQ(hinge(robot, "own").spring->stiffness, 5);
    EXPECT_FALSE(hinge(robot, "own").limit);
}

TEST(LoadMjcf, CoordinatesBeginAtTheirReference) {
    const Robot robot =
        robotOf(mjcf(world(ball("a", "<joint name='j' ref='30' range='10 90' springref='60' stiffness='1'/>")) +
                     "<keyframe><key name='k' qpos='0.5'/></keyframe>"));
    const float degree = kPi / 180;
    EXPECT_NEAR(hinge(robot, "j").limit->lower, -20 * degree, 1e-6f);
    EXPECT_NEAR(hinge(robot, "j").limit->upper, 60 * degree, 1e-6f);
    EXPECT_NEAR(hinge(robot, "j").target, 30 * degree, 1e-6f);
    EXPECT_NEAR(robot.keyframes.at(0).coordinates.at(0), 0.5f - 30 * degree, 1e-6f);
}

TEST(LoadMjcf, EqualitiesHoldJointsAndBodies) {
    const Robot robot = robotOf(mjcf(
        world(ball("a", "<joint name='i' type='slide' axis='1 0 0'/>") + ball("b", "<joint name='j' type='slide'/>") +
              ball("c", "<freejoint/>") + ball("d", "<freejoint/>")) +
        "<equality><joint joint1='i' joint2='j' polycoef='0.5 2 0 0 0'/><joint joint1='j' polycoef='0.1'/>"
        "<connect body1='c' body2='d' anchor='0 0 0.5'/><weld body1='d'/></equality>"));
    ASSERT_EQ(robot.couplings.size(), 2u);
    EXPECT_TRUE(robot.couplings[0].follows);
    EXPECT_FLOAT_EQ(robot.couplings[0].coupling.parts[1].ratio, -2);
    EXPECT_FLOAT_EQ(robot.couplings[0].coupling.sum.limit->lower, 0.5f);
    EXPECT_FLOAT_EQ(robot.couplings[1].coupling.sum.limit->upper, 0.1f);
    ASSERT_EQ(robot.joints.size(), 4u);
    EXPECT_TRUE(std::holds_alternative<BallDef>(robot.joints[2].joint));
    EXPECT_TRUE(std::holds_alternative<FixedDef>(robot.joints[3].joint));
    World world(WorldSettings{.gravity = {0, 0, 0}});
    const RobotIds ids = makeRobot(world, robot);
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    EXPECT_LT(world.state(ids.joints[2]).gap, 1e-4f);
}

TEST(LoadMjcf, TendonsAreSumsOfJoints) {
    const Robot robot = robotOf(mjcf(
        world(ball("a", "<joint name='i' type='slide' ref='0.2'/>") + ball("b", "<joint name='j' type='slide'/>")) +
        "<tendon><fixed name='t' range='0 1' limited='true' stiffness='7' damping='2'>"
        "<joint joint='i' coef='2'/><joint joint='j' coef='-1'/></fixed></tendon>"));
    const CouplingDef& sum = robot.couplings.at(0).coupling;
    EXPECT_EQ(sum.count, 2);
    EXPECT_FLOAT_EQ(sum.parts[0].ratio, 2);
    EXPECT_FLOAT_EQ(sum.sum.limit->lower, -0.4f);
    EXPECT_FLOAT_EQ(sum.sum.limit->upper, 0.6f);
    EXPECT_FLOAT_EQ(sum.sum.spring->stiffness, 7);
}

TEST(LoadMjcf, ActuatorsGiveEffort) {
    const std::string two = world(ball("a", "<joint name='i'/>") + ball("b", "<joint name='j'/>"));
    const Robot robot = robotOf(mjcf(two + "<actuator><motor joint='i' gear='-40' ctrlrange='-1 0.5'/>"
                                           "<position joint='j' kp='9' forcerange='-3 5' gear='2'/></actuator>"));
    EXPECT_FLOAT_EQ(robot.joints[0].effort, 40);
    EXPECT_FLOAT_EQ(robot.joints[1].effort, 10);
}

TEST(LoadMjcf, EveryElementIsCounted) {
    const std::string text =
        mjcf("<option timestep='0.01'/><size njmax='9'/><visual><map/></visual>" +
             world("<light/>" + ball("a", "<joint armature='0.1'/>", "<site/><camera/>")) + "<sensor><gyro/></sensor>");
    const Robot robot = robotOf(text);
    int counted = 0, there = -1;
    for (const RobotTag& tag : robot.tags) counted += tag.applied + tag.leftOut;
    for (std::size_t i = 0; i + 1 < text.size(); ++i) there += text[i] == '<' && text[i + 1] != '/' ? 1 : 0;
    EXPECT_EQ(counted, there);
    EXPECT_TRUE(warns(robot, "1 <option> in <mujoco> left out"));
    EXPECT_TRUE(warns(robot, "1 <sensor> in <mujoco> left out"));
    EXPECT_TRUE(warns(robot, "armature of 1 joints left out"));
    EXPECT_EQ(robot.warnings.size(), 3u);
}

TEST(LoadMjcf, RefusesWhatIsWrongWithLineValueAndWhatIsAllowed) {
    const auto says = [](const std::string& text, const std::string& part) {
        const std::string failure = failureOf(text);
        EXPECT_NE(failure.find(part), std::string::npos) << failure;
    };
    const auto one = [](const std::string& inner) { return mjcf(world("<body>" + inner + "</body>")); };
    says(one("<geom size='x'/>"), ":3: geom: size is 'x', must be 1 to 3 numbers");
    says(one("<geom size='-1'/>"), "size is '-1', must be above 0 m");
    says(one("<geom type='cone' size='1'/>"), "type is 'cone', must be sphere, capsule, box");
    says(one("<geom type='box' size='1 1'/>"), "size is '1 1', must be 3 numbers or more");
    says(one("<geom size='1' class='soft'/>"), "class 'soft' does not exist");
    says(one("<geom size='1'/><joint axis='0 0 0'/>"), "axis is '0 0 0', must be a direction");
    says(one("<geom size='1'/><joint type='screw'/>"), "type is 'screw', must be free, ball, hinge or slide");
    says(one("<geom size='1'/><joint range='2 1'/>"), "range is '2 1', must be two numbers that rise");
    says(one("<geom size='1'/><joint damping='-1'/>"), "damping is '-1', must be at least 0");
    says(one("<joint/>"), "moves but has no mass");
    says(one("<geom size='1'/><body><freejoint/><geom size='1'/></body>"),
         "must be the only joint of a body of the world");
    says(one("<geom size='1' quat='0 0 0 0'/>"), "quat is '0 0 0 0', must be a rotation");
    says(one("<geom size='1' quat='1 0 0 0' euler='0 0 90'/>"), "geom: euler is '0 0 90', must be the only rotation");
    says(mjcf("<default><default class='a'/><default class='b'><default class='a'/></default></default>" + world("")),
         "default class 'a' is there twice");
    says(mjcf(world("")), ": mujoco: has neither a body nor a geom, must have one");
    says(mjcf("<compiler angle='grad'/>" + world("")), "angle is 'grad', must be degree or radian");
    says(mjcf("<compiler coordinate='global'/>" + world("")), "must be local");
    says(mjcf("<include file='../other.xml'/>"), "must be a file in the folder of the description");
    says(mjcf(world("") + "<equality><joint joint1='knee'/></equality>"),
         "joint1 is 'knee', must be the name of a joint");
    says(mjcf(world("") + "<contact><exclude body1='a' body2='b'/></contact>"), "must be the name of a body");
    says(mjcf(world(ball("a", "<joint name='i'/>")) + "<keyframe><key qpos='1 2'/></keyframe>"), "qpos is '1 2'");
}

/// The file that is wrong is the included one.
std::string failureInside(const std::string& text) {
    const TemporaryFile file("outer.xml", text);
    try {
        loadRobot(file.path());
    } catch (const AssetError& error) {
        return error.what();
    }
    return {};
}

TEST(LoadMjcf, IncludedFilesAreNamed) {
    const TemporaryFile inner("inner.xml", "<mujocoinclude><include file='inner.xml'/></mujocoinclude>");
    const std::string ring = failureInside(mjcf("<include file='inner.xml'/>"));
    EXPECT_NE(
        ring.find("inner.xml:1: include file is 'inner.xml', must be one of at most 64 files that are included once"),
        std::string::npos)
        << ring;
    EXPECT_NE(failureInside(mjcf("<include file='absent.xml'/>")).find("absent.xml: no such file"), std::string::npos);
}

}  // namespace
}  // namespace ragtop
