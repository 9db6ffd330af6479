#include <gmock/gmock.h>

#include <cmath>

#include "import_support.h"
#include "ragtop/robot.h"
#include "ragtop/world.h"

// What descriptions say that no robot can be: told, or refused with its line, and never passed over.
namespace ragtop {
namespace {

using testing::HasSubstr;

const std::string kMoments = "ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'";

/// Two links; the second one has these moments, and `more` beside them; the joint has this type and inner elements.
std::string urdfOf(const std::string& moments, const std::string& more, const std::string& type,
                   const std::string& inner) {
    return "<robot name='r'>\n<link name='a'><inertial><mass value='2'/><inertia " + kMoments +
           "/></inertial></link>\n<link name='b'><inertial><mass value='3'/><inertia " + moments + "/></inertial>" +
           more + "</link>\n<joint name='j' type='" + type + "'><parent link='a'/><child link='b'/>" + inner +
           "</joint>\n</robot>\n";
}
std::string urdfWith(const std::string& moments, const std::string& more = "") {
    return urdfOf(moments, more, "continuous", "");
}

Robot robotIn(const std::string& text, const char* name = "losses.urdf") {
    const TemporaryFile file(name, text);
    return loadRobot(file.path());
}

std::string failureIn(const std::string& text, const char* name = "losses.urdf") {
    const TemporaryFile file(name, text);
    return importError(file.path(), [&] { loadRobot(file.path()); });
}

TEST(RobotLosses, OneOutermostElementIsAllThereIs) {
    const std::string sound = urdfWith(kMoments);
    const std::string second = ":6: has something beside its outermost element, must have nothing";
    EXPECT_THAT(failureIn(sound + sound), HasSubstr(second));
    EXPECT_THAT(failureIn(sound + "words"), HasSubstr(second));
    EXPECT_THAT(failureIn(sound + "</robot>"), HasSubstr(second));
    const std::string mjcf = "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>\n";
    EXPECT_THAT(failureIn(mjcf + mjcf, "losses.xml"), HasSubstr(":2: has something beside its outermost element"));
    EXPECT_EQ(failureIn("<?xml version='1.0'?>\n<!-- <robot/> -->\n" + sound + "<!-- end -->\n\n"), "");
}

TEST(RobotLosses, ElementsAndAttributesThatNobodyReadsAreToldOnce) {
    const std::string limits = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
    const Robot twice = robotIn(urdfOf(kMoments,
                                       "<collision><geometry><sphere radius='1'/><box size='1 1 1'/></geometry>"
                                       "<geometry><sphere radius='2'/></geometry></collision>",
                                       "revolute", limits + "<limit lower='-9' upper='9' effort='1' velocity='1'/>"));
    EXPECT_TRUE(warns(twice, "1 <limit> in <joint> left out: another one comes before it"));
    EXPECT_TRUE(warns(twice, "1 <box> in <geometry> left out: another one comes before it"));
    EXPECT_TRUE(warns(twice, "1 <geometry> in <collision> left out: another one comes before it"));
    EXPECT_EQ(std::get<HingeDef>(twice.joints[0].joint).limit->upper, 1);
    ASSERT_EQ(twice.bodies[1].shapes.size(), 1u);
    EXPECT_EQ(std::get<Sphere>(twice.bodies[1].shapes[0].geometry).radius, 1);

    const Robot endless = robotIn(urdfOf(kMoments, "", "continuous", limits));
    EXPECT_TRUE(warns(endless, "2 ends of continuous joints left out: these have none"));
    const Robot misspelled =
        robotIn(urdfOf(kMoments, "", "revolute", "<limit uper='1' lower='-1' effort='1' velocity='1'/>"));
    EXPECT_TRUE(warns(misspelled, "1 attribute 'uper' of <limit> left out: not supported"));
    EXPECT_TRUE(robotIn(urdfOf(kMoments, "", "revolute", limits)).warnings.empty());
}

TEST(RobotLosses, AttributesOfMjcfThatNobodyReadsAreToldOnce) {
    const Robot robot = robotIn(
        "<mujoco><default><geom condim='4'/></default><worldbody><body><freejoint/>"
        "<geom size='1' solimp='0.9 0.9 1' rgba='1 0 0 1'/><geom size='1' condim='3'/>"
        "</body></worldbody></mujoco>",
        "losses.xml");
    EXPECT_THAT(robot.warnings, testing::ElementsAre("attributes left out: 2 condim of <geom>, 1 solimp of <geom>"));
}

TEST(RobotLosses, MomentsBelowZeroAboutSomeAxisAreRefused) {
    EXPECT_THAT(failureIn(urdfWith("ixx='1' iyy='1' izz='1' ixy='1.1' ixz='0' iyz='0'")),
                HasSubstr(":3: link 'b': inertia has the moments xx 1, yy 1, zz 1, xy 1.1, xz 0, yz 0, which are below "
                          "0 about some axis, must be at least 0 about all"));
    EXPECT_THAT(failureIn(urdfWith("ixx='0' iyy='0' izz='0' ixy='1' ixz='0' iyz='0'")), HasSubstr("below 0 about"));
    EXPECT_THAT(failureIn("<mujoco><worldbody><body><freejoint/>\n<inertial mass='1' pos='0 0 0' "
                          "fullinertia='1 1 1 0 1.1 0'/></body></worldbody></mujoco>",
                          "losses.xml"),
                HasSubstr(":2: inertial: has the moments"));
}

/// A rod, a point, a point in a box: all of them turn in a world.
TEST(RobotLosses, WhatHasNoInertiaIsGivenSomeAndToldSo) {
    const std::string none = "ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'";
    const Robot rod = robotIn(urdfWith("ixx='1' iyy='1' izz='0' ixy='0' ixz='0' iyz='0'"));
    EXPECT_TRUE(warns(rod, "1 link has no inertia about some axis, taken as a little thicker, such as 'b'"));
    EXPECT_NEAR(rod.bodies[1].mass.inertia.cz.z, 1e-3, 1e-9);
    EXPECT_NEAR(rod.bodies[1].mass.inertia.cx.x, 1.001, 1e-6);
    const Robot point = robotIn(urdfWith(none));
    EXPECT_TRUE(warns(point, "taken as a ball of water, such as 'b'"));
    const double radius = std::cbrt(3 * 3 / (4 * 3.14159265 * 1000));
    EXPECT_NEAR(point.bodies[1].mass.inertia.cy.y, 0.4 * 3 * radius * radius, 1e-6);
    const Robot box = robotIn(urdfWith(none, "<collision><geometry><box size='1 2 3'/></geometry></collision>"));
    EXPECT_TRUE(warns(box, "taken as its shapes, such as 'b'"));
    EXPECT_NEAR(box.bodies[1].mass.inertia.cz.z, 3.0 * (1 + 4) / 12, 1e-5);
    for (const Robot& robot : {rod, point, box}) {
        EXPECT_EQ(robot.mass, 5);
        World world;
        makeRobot(world, robot);
        for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
        EXPECT_EQ(world.validate(), "");
    }
}

TEST(RobotLosses, ShapesThatCannotBeAreLeftOutWithAWarning) {
    for (const char* geometry : {"<sphere radius='1e-9'/>", "<sphere radius='1e30'/>", "<box size='1 1e-9 1'/>",
                                 "<capsule radius='1e-9' length='0'/>"}) {
        const Robot robot =
            robotIn(urdfWith(kMoments, std::string("<collision><geometry>") + geometry + "</geometry></collision>"));
        EXPECT_TRUE(warns(robot, "link 'b': collision left out: ")) << geometry;
        EXPECT_TRUE(robot.bodies[1].shapes.empty()) << geometry;
    }
}

TEST(RobotLosses, MeshesOutsideOfTheFolderAboveAndOfPackagesAreNotRead) {
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
    const std::filesystem::path top = temporaryPath("robots"), folder = top / "one" / "urdf";
    std::filesystem::create_directories(folder);
    for (const char* place : {"far.obj", "one/near.obj", "one/urdf/own.obj"}) std::ofstream(top / place) << triangle;
    const auto read = [&](const std::string& mesh, const RobotOptions& options = {}) {
        const std::filesystem::path file = folder / "robot.urdf";
        std::ofstream(file) << urdfWith(kMoments,
                                        "<collision><geometry><mesh filename='" + mesh + "'/></geometry></collision>");
        return loadRobot(file, options);
    };
    for (const char* mesh : {"own.obj", "../near.obj", "package://any/own.obj", "package://any/far.obj"})
        EXPECT_EQ(read(mesh).bodies[1].shapes.size(), 1u) << mesh;
    const std::string far = (top / "far.obj").string();
    for (const std::string& mesh : {std::string("../../far.obj"), far, "file://" + far,
                                    std::string("package://any/../../../../../../../../etc/passwd")}) {
        const Robot robot = read(mesh);
        EXPECT_TRUE(robot.bodies[1].shapes.empty()) << mesh;
        EXPECT_TRUE(warns(robot, "1 collision meshes are left out, as they lie neither in the folder above")) << mesh;
    }
    EXPECT_EQ(read(far, {.packageRoots = {top}}).bodies[1].shapes.size(), 1u);
    EXPECT_TRUE(warns(read("absent.obj"), "1 collision meshes are absent and left out"));
    std::filesystem::remove_all(top);
}

}  // namespace
}  // namespace ragtop
