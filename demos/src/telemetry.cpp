#include "telemetry.h"

#include <fmt/format.h>

#include <string>

#include "ragtop/telemetry.h"

namespace ragtop::demos {
namespace {

/// A name that does not break the columns.
std::string column(const std::string& name, const std::string& fallback) {
    std::string text = name.empty() ? fallback : name;
    for (char& c : text) {
        if (c == ',' || c == '"' || c == '\n' || c == ' ') c = '_';
    }
    return text;
}

}  // namespace

Telemetry::Telemetry(const std::filesystem::path& path, const Scene& scene, const SceneInstance& instance)
    : out_(path) {
    if (!out_) throw AssetError(path.string() + ": cannot be written");
    out_ << "time_s,step_ms,energy_j,contacts,awake_bodies";
    for (std::size_t i = 0; i < instance.vehicles.size(); ++i) {
        const std::string car = column(scene.vehicles[i].name, "vehicle" + std::to_string(i));
        const auto head = [&](const std::string& of) {
            return [&, of](const TelemetryChannel& channel, double) {
                out_ << fmt::format(",{}.{} [{}]", of, channel.name, channel.unit);
            };
        };
        const VehicleTelemetry& now = instance.vehicles[i].telemetry();
        forEachChannel(now, head(car));
        const auto& wheels = instance.vehicles[i].def().wheels;
        for (std::size_t w = 0; w < wheels.size(); ++w)
            forEachChannel(now.wheels[w], head(car + "." + column(wheels[w].name, "wheel" + std::to_string(w))));
    }
    out_ << "\n";
}

void Telemetry::add(const World& world, const SceneInstance& instance, double msOfStep) {
    const StepStats stats = world.stats();
    out_ << fmt::format("{:.6g},{:.4f},{:.7g},{},{}", world.time(), msOfStep, world.energy(), stats.contacts,
                        stats.awakeBodies);
    for (const Vehicle& vehicle : instance.vehicles) {
        const VehicleTelemetry& car = vehicle.telemetry();
        const auto put = [&](const TelemetryChannel&, double value) { out_ << fmt::format(",{:.6g}", value); };
        forEachChannel(car, put);
        for (const WheelTelemetry& wheel : car.wheels) forEachChannel(wheel, put);
    }
    out_ << "\n";
}

}  // namespace ragtop::demos
