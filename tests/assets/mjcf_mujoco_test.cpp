#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "import_support.h"
#include "ragtop/robot.h"
#include "ragtop/world.h"

// Robots of MJCF beside MuJoCo, which reads the same files.
namespace ragtop {
namespace {

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

Model loadModel(const std::filesystem::path& path) {
    char error[1000] = "";
    Model model(mj_loadXML(path.c_str(), nullptr, error, sizeof error), mj_deleteModel);
    if (!model) throw std::runtime_error(error);
    return model;
}

/// MuJoCo's z is up; ours is y.
Vec3 upright(const double* v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[2]), static_cast<float>(-v[1])};
}

std::filesystem::path ownRobot(const std::string& name) {
    return std::filesystem::path(RAGTOP_SOURCE_DIR) / "tests" / "data" / "robots" / name;
}

/// Where libmujoco-samples puts it.
const std::filesystem::path kHumanoid = "/usr/share/mujoco/model/humanoid/humanoid.xml";

struct Speed {
    Vec3 linear, angular;  ///< of the body's centre
};

/// Velocities of all bodies of a robot at home, from that of the first body that flies and the rates of the joints.
std::vector<Speed> speedsOf(const Robot& robot, const Speed& root, const std::vector<float>& rates) {
    std::vector<Speed> speeds(robot.bodies.size());
    std::vector<bool> hangs(robot.bodies.size(), false);
    const auto centerOf = [&](int body) {
        const RobotBody& of = robot.bodies[static_cast<std::size_t>(body)];
        return transformPoint(of.pose, of.mass.center);
    };
    for (std::size_t j = 0; j < robot.joints.size(); ++j) hangs[static_cast<std::size_t>(robot.joints[j].child)] = true;
    for (std::size_t i = 0; i < speeds.size(); ++i)
        if (!robot.bodies[i].anchored && !hangs[i]) speeds[i] = root;
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
        const RobotJoint& joint = robot.joints[j];
        const auto& def = std::get<HingeDef>(joint.joint);
        const Frame at = robot.bodies[static_cast<std::size_t>(joint.parent)].pose * def.bodies.frameA;
        const Vec3 turn = rates[j] * rotate(at.rotation, {1, 0, 0});
        const Speed& parent = speeds[static_cast<std::size_t>(joint.parent)];
        const Vec3 center = centerOf(joint.child);
        speeds[static_cast<std::size_t>(joint.child)] = {
            parent.linear + cross(parent.angular, center - centerOf(joint.parent)) + cross(turn, center - at.position),
            parent.angular + turn};
    }
    return speeds;
}

class AsMujoco : public testing::TestWithParam<std::filesystem::path> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(GetParam())) GTEST_SKIP() << "no " << GetParam();
    }
};

TEST_P(AsMujoco, HasTheSameMassAndCentre) {
    const Model model = loadModel(GetParam());
    const Data data(mj_makeData(model.get()), mj_deleteData);
    mj_forward(model.get(), data.get());
    const Robot robot = loadRobot(GetParam());
    double mass = 0;
    DVec3 sum;
    for (const RobotBody& body : robot.bodies) {
        if (body.anchored) continue;
        mass += static_cast<double>(body.mass.mass);
        sum = sum + static_cast<double>(body.mass.mass) * DVec3(transformPoint(body.pose, body.mass.center));
    }
    const double expected = model->body_subtreemass[1];
    EXPECT_NEAR(mass, expected, 1e-6 * expected);
    EXPECT_NEAR(robot.mass, expected, 1e-6 * expected);
    EXPECT_LT(length(toVec3((1 / mass) * sum) - upright(data->subtree_com + 3)), 1e-6f);
    EXPECT_EQ(static_cast<int>(robot.joints.size()), model->njnt - 1);
}

/// How a robot flies: without contacts, limits and rotors.
struct Flight {
    unsigned seed = 7;     ///< of the rates of the joints
    bool springs = false;  ///< and dampers, as in the file
    int rate = 240;        ///< steps per second
};

/// How far joints are off after a second of free flight, degrees: MuJoCo by Runge-Kutta at half a millisecond.
double largestDifference(const std::filesystem::path& file, const Flight& flight) {
    const Model model = loadModel(file);
    model->opt.timestep = 0.0005;
    model->opt.integrator = mjINT_RK4;
    model->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_ACTUATION;
    for (int i = 0; i < model->nv; ++i) {
        model->dof_armature[i] = 0;
        if (!flight.springs) model->dof_damping[i] = 0;
    }
    for (int i = 0; i < model->njnt; ++i)
        if (!flight.springs) model->jnt_stiffness[i] = 0;
    mj_setConst(model.get(), Data(mj_makeData(model.get()), mj_deleteData).get());
    const Data data(mj_makeData(model.get()), mj_deleteData);

    Robot robot = loadRobot(file);
    std::mt19937 random(flight.seed);
    std::vector<float> rates;
    for (RobotJoint& joint : robot.joints) {
        std::get<HingeDef>(joint.joint).limit.reset();
        if (!flight.springs) std::get<HingeDef>(joint.joint).spring.reset();
        rates.push_back(4 * (static_cast<float>(random()) / 4294967296.0f - 0.5f));
    }
    for (RobotBody& body : robot.bodies) body.shapes.clear();
    // Of a free joint the angular velocity is in the axes of the body.
    const double linear[3] = {0.3, 0.2, 1}, angular[3] = {0.5, -0.4, 0.6};
    double turned[3], back[4];
    mju_negQuat(back, data->qpos + 3);
    mju_rotVecQuat(turned, angular, back);
    std::copy(linear, linear + 3, data->qvel);
    std::copy(turned, turned + 3, data->qvel + 3);
    std::vector<int> places;
    for (std::size_t j = 0; j < rates.size(); ++j) {
        const int id = mj_name2id(model.get(), mjOBJ_JOINT, robot.joints[j].name.c_str());
        EXPECT_GE(id, 0) << robot.joints[j].name;
        if (id < 0) return 180;
        data->qvel[model->jnt_dofadr[id]] = static_cast<double>(rates[j]);
        places.push_back(model->jnt_qposadr[id]);
    }

    World world(WorldSettings{.sleeping = false});
    const RobotIds ids = makeRobot(world, robot);
    // The velocity of the root is that of its origin; ours is that of its centre.
    std::size_t root = 0;
    while (robot.bodies[root].anchored) ++root;
    const Vec3 arm = rotate(robot.bodies[root].pose.rotation, robot.bodies[root].mass.center);
    const Speed start{upright(linear) + cross(upright(angular), arm), upright(angular)};
    const std::vector<Speed> speeds = speedsOf(robot, start, rates);
    for (std::size_t i = 0; i < speeds.size(); ++i)
        if (!robot.bodies[i].anchored) world.setVelocity(ids.bodies[i], speeds[i].linear, speeds[i].angular);
    for (int i = 0; i < 2000; ++i) mj_step(model.get(), data.get());
    for (int i = 0; i < flight.rate; ++i) world.step(1.0 / flight.rate);
    double worst = 0;
    for (std::size_t j = 0; j < places.size(); ++j) {
        const double off = static_cast<double>(world.state(ids.joints[j]).coordinate) - data->qpos[places[j]];
        worst = std::max(worst, std::abs(off));
    }
    return worst * 180 / 3.14159265;
}

/// A body between two hinges takes s = 1e-5 of the mass. Where the hinge between two others stands at 85 degrees, it
/// adds s / cos² = 0.13 % to what resists the difference of these, whose rates differ by up to 4 rad/s.
TEST_P(AsMujoco, FliesWithTheSameAngles) {
    for (const unsigned seed : {7u, 8u, 9u, 10u}) EXPECT_LT(largestDifference(GetParam(), {.seed = seed}), 0.5) << seed;
}

/// Its dampers stop light links within milliseconds, much less than a substep of 60 Hz.
TEST_P(AsMujoco, FliesWithTheSameAnglesOnSpringsAndDampers) {
    for (const unsigned seed : {7u, 8u, 9u, 10u})
        for (const int rate : {60, 240})
            EXPECT_LT(largestDifference(GetParam(), {.seed = seed, .springs = true, .rate = rate}), 0.5)
                << seed << ", " << rate << " Hz";
}

std::string nameOf(const testing::TestParamInfo<std::filesystem::path>& info) { return info.param.stem().string(); }

INSTANTIATE_TEST_SUITE_P(Files, AsMujoco, testing::Values(ownRobot("figure.xml"), kHumanoid), nameOf);

}  // namespace
}  // namespace ragtop
