#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "json.h"
#include "ragtop/math.h"
#include "ragtop/tuning.h"

/// What a page may ask for (docs/serve.md). Positions are relative to the scene's origin.
namespace ragtop::live {

struct PlayCommand {};
struct PauseCommand {};
struct StepCommand {
    int count = 1;
};
struct SeekCommand {
    std::uint64_t step = 0;
};
struct RestartCommand {};
struct SpeedCommand {
    double factor = 1;
};
struct LoadCommand {
    std::string scene;
};
struct ScenesCommand {};
struct ShowCommand {
    std::vector<std::pair<std::string, bool>> options;  ///< some of showNames()
};
struct GrabCommand {
    std::uint32_t node = 0;
    Vec3 point, target;
};
struct DragCommand {
    Vec3 target;
};
struct ReleaseCommand {};
struct ShootCommand {
    Vec3 origin, direction;
    float speed = 30, radius = 0.2f;
};
struct DriveCommand {
    std::size_t vehicle = 0;
    std::optional<float> throttle, brake, steer, handbrake;
    std::optional<std::optional<int>> gear;
};
struct ResetVehicleCommand {
    std::size_t vehicle = 0;
};
struct PickCommand {
    std::optional<std::uint32_t> node;
};
struct TuneCommand {
    std::string path;
    TuneValue value;
};
struct UntuneCommand {
    std::string path;
};
struct SaveTuningCommand {
    std::string name = "tuned";
};
struct LoadTuningCommand {
    std::string name;
};
struct HashCommand {};

using Command = std::variant<PlayCommand, PauseCommand, StepCommand, SeekCommand, RestartCommand, SpeedCommand,
                             LoadCommand, ScenesCommand, ShowCommand, GrabCommand, DragCommand, ReleaseCommand,
                             ShootCommand, DriveCommand, ResetVehicleCommand, PickCommand, TuneCommand, UntuneCommand,
                             SaveTuningCommand, LoadTuningCommand, HashCommand>;

/// A message as it was understood: a command, or what is wrong with it.
struct Message {
    std::optional<std::int64_t> id;
    std::string verb;  ///< what it asks to do; empty when that is unknown
    std::optional<Command> command;
    std::string error;

    /// What is wrong with it, after what it asks for.
    std::string explained(const std::string& wrong) const;
};

/// Reads one message. Never throws; unknown names and members, wrong types and numbers out of range are errors that
/// name what is wrong, its value and what is allowed.
Message readMessage(std::string_view text);

/// The switches of debug drawing.
const std::vector<std::string>& showNames();

}  // namespace ragtop::live
