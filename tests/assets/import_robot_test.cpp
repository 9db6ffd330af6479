#include <algorithm>

#include "import_support.h"
#include "ragtop/robot.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

const RobotJoint& joint(const Robot& robot, const std::string& name) {
    for (const RobotJoint& each : robot.joints)
        if (each.name == name) return each;
    throw std::out_of_range(name);
}

/// A link of 2 kg and one of 1 kg a metre above it, with `inner` in the joint between them.
std::string twoLinks(const std::string& type, const std::string& inner, const std::string& geometry = "") {
    return "<robot name='r'>\n"
           "<link name='base'><inertial><mass value='2'/>"
           "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\n"
           "<link name='arm'><inertial><origin xyz='0 0 0.5'/><mass value='1'/>"
           "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>" +
           geometry +
           "</link>\n"
           "<joint name='j' type='" +
           type + "'><parent link='base'/><child link='arm'/><origin xyz='0 0 1'/>\n" + inner + "</joint>\n</robot>\n";
}

TEST(LoadRobot, UnitreeHumanoidsHaveTheirMasses) {
    RAGTOP_SAMPLE(g1, "robots/g1_29dof.urdf");
    RAGTOP_SAMPLE(h1, "robots/h1.urdf");
    const Robot small = loadRobot(g1), big = loadRobot(h1);
    EXPECT_NEAR(small.mass, 35.1, 0.351);
    EXPECT_NEAR(big.mass, 51.6, 0.516);
    EXPECT_EQ(small.joints.size(), 29u);
    EXPECT_EQ(small.bodies.size(), 30u);
    EXPECT_TRUE(warns(small, "meshes are absent"));
    // Z of the file is up: the torso is above the ankles in y.
    const auto height = [&](const std::string& name) {
        for (const RobotLink& link : small.links)
            if (link.name == name)
                return (small.bodies[static_cast<std::size_t>(link.body)].pose * link.inBody).position.y;
        return 0.0f;
    };
    EXPECT_GT(height("torso_link"), height("left_ankle_roll_link") + 0.5f);
}

TEST(LoadRobot, AMissingLinkIsRefusedWithItsLine) {
    RAGTOP_SAMPLE(file, "robots/g1_dual_arm.urdf");
    const std::string text = importError(file, [&] { loadRobot(file); });
    const std::string expected = "urdf:181: joint 'imu_in_pelvis_joint': parent link 'pelvis' does not exist";
    EXPECT_NE(text.find(expected), std::string::npos) << text;
}

TEST(LoadRobot, MapsLimitsEffortDampingAndFriction) {
    const TemporaryFile file("hinge.urdf", twoLinks("revolute",
                                                    "<axis xyz='0 1 0'/><limit lower='-0.5' upper='1.5' effort='20' "
                                                    "velocity='3'/><dynamics damping='0.7' friction='0.2'/>"));
    const Robot robot = loadRobot(file.path());
    ASSERT_EQ(robot.bodies.size(), 2u);
    const auto& hinge = std::get<HingeDef>(joint(robot, "j").joint);
    EXPECT_FLOAT_EQ(hinge.limit->lower, -0.5f);
    EXPECT_FLOAT_EQ(hinge.limit->upper, 1.5f);
    EXPECT_FLOAT_EQ(hinge.friction, 0.2f);
    EXPECT_FLOAT_EQ(hinge.spring->damping, 0.7f);
    EXPECT_EQ(hinge.spring->stiffness, 0.0f);
    EXPECT_FALSE(hinge.motor.has_value());
    EXPECT_FLOAT_EQ(joint(robot, "j").effort, 20);
    EXPECT_FLOAT_EQ(joint(robot, "j").velocity, 3);
    EXPECT_TRUE(robot.warnings.empty()) << robot.warnings[0];
    // y of the file lies in the plane; a metre along its z is a metre up.
    const Frame world = robot.bodies[0].pose * hinge.bodies.frameA;
    EXPECT_LT(length(rotate(world.rotation, {1, 0, 0}) - Vec3{0, 0, -1}), 1e-6f);
    EXPECT_LT(length(world.position - Vec3{0, 1, 0}), 1e-6f);
    const Frame other = robot.bodies[1].pose * hinge.bodies.frameB;
    EXPECT_LT(length(other.position - world.position), 1e-6f);
}

TEST(LoadRobot, FixedLinksBecomeOneBody) {
    const TemporaryFile file("fixed.urdf", twoLinks("fixed", ""));
    const Robot robot = loadRobot(file.path());
    ASSERT_EQ(robot.bodies.size(), 1u);
    EXPECT_EQ(robot.links.size(), 2u);
    EXPECT_FLOAT_EQ(robot.bodies[0].mass.mass, 3);
    // (2·0 + 1·1.5) / 3 up the z axis of the file; 1 + 1 + 2·0.25 + 1·1 about x by parallel axes.
    EXPECT_NEAR(robot.bodies[0].mass.center.z, 0.5f, 1e-6f);
    EXPECT_NEAR(robot.bodies[0].mass.inertia.cx.x, 3.5f, 1e-5f);
    EXPECT_NEAR(robot.bodies[0].mass.inertia.cz.z, 2.0f, 1e-5f);
}

TEST(LoadRobot, ContinuousPrismaticAndSphericalJoints) {
    const TemporaryFile wheel("wheel.urdf", twoLinks("continuous", "<axis xyz='1 0 0'/>"));
    EXPECT_FALSE(std::get<HingeDef>(loadRobot(wheel.path()).joints[0].joint).limit.has_value());
    const std::string limit = "<limit lower='0' upper='2' effort='5' velocity='1'/>";
    const TemporaryFile rail("rail.urdf", twoLinks("prismatic", limit));
    EXPECT_FLOAT_EQ(std::get<SliderDef>(loadRobot(rail.path()).joints[0].joint).limit->upper, 2);
    const TemporaryFile ball("ball.urdf", twoLinks("spherical", ""));
    EXPECT_TRUE(std::holds_alternative<BallDef>(loadRobot(ball.path()).joints[0].joint));
}

TEST(LoadRobot, ShapesStandWhereTheFileSays) {
    const TemporaryFile file(
        "shapes.urdf",
        twoLinks("fixed", "",
                 "<collision><origin xyz='1 0 0'/><geometry><sphere radius='0.1'/></geometry></collision>"
                 "<collision><geometry><cylinder radius='0.2' length='0.6'/></geometry></collision>"
                 "<collision><origin xyz='0 2 0'/><geometry><capsule radius='0.1' length='0.4'/></geometry></collision>"
                 "<collision><geometry><mesh filename='absent.stl'/></geometry></collision>"));
    const Robot robot = loadRobot(file.path());
    const auto& shapes = robot.bodies[0].shapes;
    ASSERT_EQ(shapes.size(), 3u);
    EXPECT_LT(length(shapes[0].frame.position - Vec3{1, 0, 1}), 1e-6f);
    // The prism has the cylinder's volume, π 0.2² 0.6.
    EXPECT_NEAR(massOf(shapes[1].geometry, 1.0f).mass, 0.0753982f, 1e-5f);
    EXPECT_FLOAT_EQ(std::get<Capsule>(shapes[2].geometry).halfHeight, 0.2f);
    EXPECT_LT(length(rotate(shapes[2].frame.rotation, {0, 1, 0}) - Vec3{0, 0, 1}), 1e-6f);
    EXPECT_TRUE(warns(robot, "absent.stl"));
}

/// Each a kilogram, one fixed to the other.
std::string fixedLinks(int count) {
    std::string text = "<robot name='chain'>\n";
    for (int i = 0; i < count; ++i) {
        const std::string name = "l" + std::to_string(i);
        text += "<link name='" + name +
                "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
                "iyz='0'/></inertial></link>\n";
        if (i > 0)
            text += "<joint name='j" + std::to_string(i) + "' type='fixed'><parent link='l" + std::to_string(i - 1) +
                    "'/><child link='" + name + "'/></joint>\n";
    }
    return text + "</robot>\n";
}

TEST(LoadRobot, LongChainsAreOneBody) {
    const TemporaryFile file("chain.urdf", fixedLinks(10000));
    const Robot robot = loadRobot(file.path());
    EXPECT_EQ(robot.bodies.size(), 1u);
    EXPECT_EQ(robot.links.size(), 10000u);
    EXPECT_NEAR(robot.mass, 10000, 1);
}

TEST(LoadRobot, DeepNestingIsRefusedWithItsLimit) {
    std::string deep = "<robot name='r'>\n";
    for (int i = 0; i < 200000; ++i) deep += "<a>";
    const TemporaryFile file("deep.urdf", deep);
    const std::string text = importError(file.path(), [&] { loadRobot(file.path()); });
    EXPECT_NE(text.find(":2: nests elements deeper than 64 levels, the most allowed"), std::string::npos) << text;
    const TemporaryFile quotes("quotes.urdf", "<?xml version='1.0'?><!-- <a><a> -->" +
                                                  twoLinks("fixed", "<origin xyz='0 0 0' note=\"<a><a>\"/>"));
    EXPECT_EQ(loadRobot(quotes.path()).links.size(), 2u);
}

TEST(LoadRobot, LooksNeverDecideWhetherItLoads) {
    const TemporaryFile file(
        "looks.urdf", twoLinks("fixed", "",
                               "<visual><geometry><box size='1 1 1'/></geometry><material><color rgba='1 0 0 1'/>"
                               "</material></visual>"
                               "<visual><geometry><box size='1 1'/></geometry></visual><visual/>"));
    const Robot robot = loadRobot(file.path());
    EXPECT_EQ(robot.links.size(), 2u);
    EXPECT_TRUE(warns(robot, "2 visuals or materials are faulty")) << robot.warnings.size();
    EXPECT_TRUE(warns(robot, "line 3: link 'arm': material has no name"));
}

TEST(LoadRobot, KeepsRangesOfSeveralTurns) {
    const TemporaryFile file("turns.urdf",
                             twoLinks("revolute", "<limit lower='-12' upper='20' effort='1' velocity='0'/>"));
    const Robot robot = loadRobot(file.path());
    const auto& hinge = std::get<HingeDef>(robot.joints[0].joint);
    EXPECT_FLOAT_EQ(hinge.limit->lower, -12);
    EXPECT_FLOAT_EQ(hinge.limit->upper, 20);
    EXPECT_TRUE(robot.warnings.empty()) << robot.warnings[0];
}

TEST(LoadRobot, TellsWhatAnotherFormatLooksLike) {
    const TemporaryFile file("other.xml", "<!-- a robot -->\n<sdf version='1.6'><model/></sdf>");
    const std::string text = importError(file.path(), [&] { loadRobot(file.path()); });
    EXPECT_NE(text.find("begins with <sdf>, must begin with <robot> (URDF) or <mujoco> (MJCF); it looks like SDFormat"),
              std::string::npos)
        << text;
}

const RobotTag& tag(const Robot& robot, const std::string& name) {
    for (const RobotTag& each : robot.tags)
        if (each.tag == name) return each;
    throw std::out_of_range(name);
}

TEST(LoadRobot, EveryElementIsAppliedOrLeftOutAndCounted) {
    std::string text = twoLinks("revolute",
                                "<axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/>"
                                "<calibration rising='0'/><safety_controller k_velocity='1' k_position='1'/>",
                                "<visual><geometry><box size='1 1 1'/></geometry></visual><sensor/>");
    text.insert(text.rfind("</robot>"),
                "<transmission name='t'><joint name='j'/></transmission>"
                "<link name='tool'/><joint name='k' type='fixed'><parent link='arm'/><child link='tool'/>"
                "<axis xyz='1 0 0'/></joint><gazebo/><gazebo><plugin/></gazebo>");
    const TemporaryFile file("tags.urdf", text);
    const Robot robot = loadRobot(file.path());
    int counted = 0;
    for (const RobotTag& each : robot.tags) counted += each.applied + each.leftOut;
    const auto begins = [&](std::size_t i) { return text[i] == '<' && text[i + 1] != '/'; };
    int there = -1;  // the robot itself
    for (std::size_t i = 0; i + 1 < text.size(); ++i) there += begins(i) ? 1 : 0;
    EXPECT_EQ(counted, there);
    EXPECT_EQ(tag(robot, "axis").applied, 1);
    EXPECT_EQ(tag(robot, "axis").leftOut, 1);
    EXPECT_EQ(tag(robot, "gazebo").leftOut, 2);
    EXPECT_EQ(tag(robot, "joint").applied, 2);
    EXPECT_EQ(tag(robot, "joint").leftOut, 1);
    EXPECT_EQ(tag(robot, "box").leftOut, 1);
    EXPECT_TRUE(warns(robot, "1 <transmission> in <robot> left out: not supported"));
    EXPECT_TRUE(warns(robot, "2 <gazebo> in <robot> left out"));
    EXPECT_TRUE(warns(robot, "1 <calibration> in <joint> left out"));
    EXPECT_TRUE(warns(robot, "1 <axis> of fixed joints left out: it has no meaning there"));
}

TEST(LoadRobot, RefusesFollowersOfNobody) {
    const auto failure = [](const std::string& mimic) {
        const TemporaryFile file("mimic.urdf", twoLinks("continuous", mimic));
        return importError(file.path(), [&] { loadRobot(file.path()); });
    };
    const std::string nobody = failure("<mimic joint='knee'/>");
    EXPECT_NE(nobody.find(":5: joint 'j': mimic joint is 'knee', must be one of the robot's joints"), std::string::npos)
        << nobody;
    EXPECT_NE(failure("<mimic joint='j'/>").find("joint 'j': mimics itself"), std::string::npos);
    std::string ring = twoLinks("continuous", "<mimic joint='k'/>");
    ring.insert(ring.rfind("</robot>"),
                "<link name='tip'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
                "iyz='0'/></inertial></link><joint name='k' type='continuous'><parent link='arm'/><child link='tip'/>"
                "<mimic joint='j'/></joint>");
    const TemporaryFile file("ring.urdf", ring);
    const std::string text = importError(file.path(), [&] { loadRobot(file.path()); });
    EXPECT_NE(text.find("follows itself through others"), std::string::npos) << text;
    const TemporaryFile other("number.urdf", ring.replace(ring.find("joint='k'"), 9, "joint='k' multiplier='x'"));
    const std::string number = importError(other.path(), [&] { loadRobot(other.path()); });
    EXPECT_NE(number.find("multiplier is 'x', must be a number"), std::string::npos) << number;
}

TEST(LoadRobot, MacrosAreToBeExpandedFirst) {
    const TemporaryFile file("macro.urdf",
                             "<robot name='r' xmlns:xacro='x'>\n<xacro:property name='a' value='1'/></robot>");
    const std::string text = importError(file.path(), [&] { loadRobot(file.path()); });
    EXPECT_NE(text.find(":2: has <xacro:property>, which is for xacro: expand it first"), std::string::npos) << text;
}

TEST(LoadRobot, LoopsAndGiantsAreRefusedInOneLine) {
    const std::string mass =
        "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>";
    const TemporaryFile loop("loop.urdf", "<robot name='r'><link name='a" + mass + "<link name='b" + mass +
                                              "<link name='c" + mass +
                                              "<joint name='i' type='fixed'><parent link='b'/><child link='c'/></joint>"
                                              "<joint name='j' type='fixed'><parent link='c'/><child link='b'/></joint>"
                                              "</robot>");
    const std::string text = importError(loop.path(), [&] { loadRobot(loop.path()); });
    EXPECT_NE(text.find("2 links do not hang on the root 'a': their joints form a loop"), std::string::npos) << text;
    const TemporaryFile ring("whole_ring.urdf",
                             "<robot name='r'>\n<link name='a'/><link name='b'/>"
                             "<joint name='i' type='fixed'><parent link='a'/><child link='b'/></joint>"
                             "<joint name='j' type='fixed'><parent link='b'/><child link='a'/></joint>"
                             "</robot>");
    const std::string rootless = importError(ring.path(), [&] { loadRobot(ring.path()); });
    EXPECT_NE(rootless.find(":1: each of its 2 links is the child of a joint, must have one that is not"),
              std::string::npos)
        << rootless;
    const TemporaryFile nameless("nameless.urdf", "<robot>\n<link name='a'/></robot>");
    const std::string name = importError(nameless.path(), [&] { loadRobot(nameless.path()); });
    EXPECT_NE(name.find(":1: robot has no name, must have one"), std::string::npos) << name;
    const TemporaryFile giant("giant.urdf", std::string(40 << 20, ' '));
    const std::string size = importError(giant.path(), [&] { loadRobot(giant.path()); });
    EXPECT_NE(size.find("is 41943040 bytes long, must be at most 33554432"), std::string::npos) << size;
}

TEST(LoadRobot, RefusesBadNumbersWithLineValueAndRange) {
    const auto failure = [](const std::string& text) {
        const TemporaryFile file("bad.urdf", text);
        return importError(file.path(), [&] { loadRobot(file.path()); });
    };
    const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    const std::string sound = twoLinks("revolute", "<limit lower='-1' upper='1' effort='1' velocity='1'/>");
    EXPECT_EQ(failure(sound), "");
    const std::string mass = failure(replaced(sound, "value='2'", "value='abc'"));
    EXPECT_NE(mass.find(".urdf:2: link 'base': mass value is 'abc', must be a number"), std::string::npos) << mass;
    EXPECT_NE(failure(replaced(sound, "value='2'", "value='-2'")).find("must be at least 0 kg"), std::string::npos);
    EXPECT_NE(failure(replaced(sound, "value='2'", "value='nan'")), "");
    EXPECT_NE(failure(replaced(sound, "value='2'", "value='1e99'")), "");
    EXPECT_NE(failure(replaced(sound, "value='2'", "value=''")), "");
    EXPECT_NE(failure(replaced(sound, "value='2'", "kg='2'")).find("mass has no value"), std::string::npos);
    EXPECT_NE(failure(replaced(sound, "xyz='0 0 1'", "xyz='0 0'")).find("must be 3 numbers"), std::string::npos);
    EXPECT_NE(failure(replaced(sound, "lower='-1'", "lower='3'")).find("must be at most upper"), std::string::npos);
    EXPECT_NE(failure(replaced(sound, "type='revolute'", "type='elastic'")).find("must be revolute"),
              std::string::npos);
    EXPECT_NE(failure(replaced(sound, "child link='arm'", "child link='leg'")).find("'leg' does not exist"),
              std::string::npos);
    EXPECT_NE(failure(replaced(sound, "link name='arm'", "link name='base'")).find("twice"), std::string::npos);
    EXPECT_NE(failure(replaced(sound, "</robot>", "")), "");
    EXPECT_NE(failure(""), "");
    EXPECT_NE(failure("<robot name='r'/>"), "");
    EXPECT_NE(failure("<sdf/>").find("<robot>"), std::string::npos);
    EXPECT_NE(importError("absent.urdf", [] { loadRobot("absent.urdf"); }).find("no such file"), std::string::npos);
    const std::string weightless =
        "<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' "
        "izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link><link name='b'/><joint name='j' "
        "type='continuous'><parent link='a'/><child link='b'/></joint></robot>";
    EXPECT_NE(failure(weightless).find("link 'b' moves but has no mass"), std::string::npos);
}

TEST(MakeRobot, StandsInAWorldAtRest) {
    RAGTOP_SAMPLE(file, "robots/g1_29dof.urdf");
    const Robot robot = loadRobot(file);
    World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
    const RobotIds ids = makeRobot(world, robot, {{0, 1, 0}, {}});
    EXPECT_EQ(ids.bodies.size(), robot.bodies.size());
    EXPECT_EQ(ids.joints.size(), robot.joints.size());
    for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
    for (const JointId id : ids.joints) EXPECT_LT(world.state(id).gap, 1e-4f);
    for (const BodyId id : ids.bodies) EXPECT_LT(length(world.linearVelocity(id)), 1e-2f);
}

TEST(DescribeAsset, NamesTheRobotsMassAndLinks) {
    const TemporaryFile file("fixed.urdf", twoLinks("fixed", ""));
    const std::string text = describeAsset(loadRobot(file.path()));
    EXPECT_NE(text.find("3.000 kg"), std::string::npos) << text;
    EXPECT_NE(text.find("2 in 1 bodies"), std::string::npos) << text;
}

}  // namespace
}  // namespace ragtop
