#pragma once

#include <string>

#include "import_support.h"
#include "ragtop/scene.h"
#include "ragtop/world.h"

namespace ragtop {

/// The scene of a file with these members.
inline Scene sceneOfMembers(const std::string& members) {
    const TemporaryFile file("members_of_test.json", "{" + members + "}");
    return loadScene(file.path());
}

/// What loading it says; empty where nothing is wrong.
inline std::string faultOfMembers(const std::string& members) {
    try {
        sceneOfMembers(members);
    } catch (const AssetError& error) {
        return error.what();
    }
    return {};
}

/// A scene in a world of its own, driven as the program drives it.
struct ScenePlay {
    explicit ScenePlay(const Scene& of) : scene(of), world(scene.settings), instance(scene, world) {}

    void until(double time) {
        while (world.time() < time - 0.5 * scene.step) {
            instance.drive(world.time());
            world.step(scene.step);
        }
    }
    const Scene& scene;
    World world;
    SceneInstance instance;
};

}  // namespace ragtop
