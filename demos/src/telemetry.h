#pragma once

#include <filesystem>
#include <fstream>

#include "ragtop/scene.h"
#include "ragtop/world.h"

namespace ragtop::demos {

/// Writes one line per step: time, cost, energy, contacts, and what each vehicle and its wheels do.
class Telemetry {
public:
    /// Throws AssetError when the file cannot be written.
    Telemetry(const std::filesystem::path& path, const Scene& scene, const SceneInstance& instance);
    void add(const World& world, const SceneInstance& instance, double msOfStep);

private:
    std::ofstream out_;
};

}  // namespace ragtop::demos
