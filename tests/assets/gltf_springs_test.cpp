#include <nlohmann/json.hpp>

#include "import_support.h"
#include "ragtop/character.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

/// The tailed human of the rigs with springs on its tail.
std::string withSprings(double stiffness, double drag, double gravity, int beyond = 0) {
    const fs::path rig = fs::path(RAGTOP_SOURCE_DIR) / "tests" / "data" / "rigs" / "human_tail.gltf";
    std::ifstream stream(rig);
    nlohmann::json gltf = nlohmann::json::parse(stream);
    nlohmann::json joints = nlohmann::json::array();
    int hips = -1;
    for (std::size_t i = 0; i < gltf["nodes"].size(); ++i) {
        const std::string name = gltf["nodes"][i].value("name", "");
        if (name.find("ail") != std::string::npos)
            joints.push_back({{"node", i + static_cast<std::size_t>(beyond)},
                              {"stiffness", stiffness},
                              {"dragForce", drag},
                              {"gravityPower", gravity},
                              {"hitRadius", 0.02}});
        if (name.find("ips") != std::string::npos || name.find("elvis") != std::string::npos)
            hips = static_cast<int>(i);
    }
    EXPECT_GE(joints.size(), 2u);
    nlohmann::json& vrm = gltf["extensions"]["VRMC_springBone"];
    vrm = {{"specVersion", "1.0"}, {"springs", {{{"joints", joints}}}}};
    vrm["colliders"] = {
        {{"node", std::max(hips, 0)}, {"shape", {{"sphere", {{"offset", {0, 0, 0}}, {"radius", 0.1}}}}}}};
    return gltf.dump();
}

/// The recurrence of VRM for a small swing against the oscillator that was made of it, at 60 frames a second.
TEST(GltfSprings, SwingAsVrmDoes) {
    const TemporaryFile file("tail.gltf", withSprings(0.8, 0.1, 0.2));
    const Character character = loadCharacter(file.path());
    ASSERT_FALSE(character.springs.chains.empty());
    ASSERT_EQ(character.springs.colliders.size(), 1u);
    EXPECT_EQ(whyInvalid(character.springs, character.skeleton), "");
    const SpringChain& chain = character.springs.chains.front();
    const double length = static_cast<double>(ragtop::length(chain.tip)), dt = 1.0 / 60;
    const double omega = 2 * 3.14159265358979 * static_cast<double>(chain.frequency);
    const double zeta = static_cast<double>(chain.dampingRatio), turn = omega * std::sqrt(1 - zeta * zeta);
    double before = 0.01, now = 0.01 * std::exp(-zeta * omega * dt) *
                                (std::cos(turn * dt) + zeta * omega / turn * std::sin(turn * dt));
    for (int frame = 2; frame < 60; ++frame) {
        const double next = now + 0.9 * (now - before) - dt * 0.8 / length * now;
        before = std::exchange(now, next);
        const double t = frame * dt;
        EXPECT_NEAR(
            now, 0.01 * std::exp(-zeta * omega * t) * (std::cos(turn * t) + zeta * omega / turn * std::sin(turn * t)),
            1e-5);
    }
    EXPECT_NEAR(std::tan(chain.sag), 0.25f, 1e-5f);
}

TEST(GltfSprings, OfNoNodeAreRefused) {
    const TemporaryFile file("tail.gltf", withSprings(0.8, 0.1, 0.2, 1000));
    const std::string error = importError(file.path(), [&] { loadCharacter(file.path()); });
    EXPECT_NE(error.find("/extensions/VRMC_springBone/springs/0/joints/0/node is "), std::string::npos) << error;
}

}  // namespace
}  // namespace ragtop
