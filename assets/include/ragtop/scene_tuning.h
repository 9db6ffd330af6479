#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/scene.h"
#include "ragtop/tuning.h"

/// What of a scene may change while it runs, by paths that begin with
///
///     settings                  settings.substeps
///     materials.<name>          materials.brick.friction
///     joints.<name>             joints.door.limit.upper
///     vehicles.<name>           vehicles.car.wheels.front left.suspension.stiffness
///     ragdolls.<name>           ragdolls.person.joints.left forearm.friction, ragdolls.person.parts.head.mass
///     robots.<name>             robots.arm.joints.elbow.spring.damping
///     cloths.<name>             cloths.cape.wind
///
/// What has no name of its own goes by its number. A joint of a ragdoll is called after the part that it carries. The
/// ragdolls, or robots, made from one entry of a scene file are tuned together.
namespace ragtop {

class World;

/// A value and the path of what has it.
using TunedValue = std::pair<std::string, TuneValue>;

/// A value that cannot be; what() names its path, the value and what is allowed.
class TuneError : public std::invalid_argument {
public:
    TuneError(std::string path, const std::string& message) : std::invalid_argument(message), path_(std::move(path)) {}
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

std::vector<TunableField> tunablesOf(const Scene& scene);

/// Whether two scenes differ in nothing but the values of their tunables, names and texts, so that one can become the
/// other while it runs.
bool sameStructure(const Scene& a, const Scene& b);

/// Parts of a scene that were tuned; indices of its joints, vehicles, ragdolls, robots and cloths.
struct TunedParts {
    bool settings = false;
    std::vector<std::string> materials{};
    std::vector<std::size_t> joints{}, vehicles{}, ragdolls{}, robots{}, cloths{};
};

/// Sets values, all or none. Throws TuneError.
TunedParts tune(Scene& scene, std::span<const TunedValue> values);

/// What a scene became in a world; in the order of the scene, and empty where nothing is to be tuned.
struct RunningScene {
    World* world = nullptr;
    std::vector<BodyId> bodies{};
    std::vector<JointId> joints{};
    std::vector<Vehicle*> vehicles{};
    std::vector<Ragdoll*> ragdolls{};
    std::vector<const RobotIds*> robots{};
    std::vector<Cloth*> cloths{};
};
/// Makes what runs as the scene says, between steps; it keeps its state.
void apply(const Scene& scene, const TunedParts& parts, const RunningScene& to);

/// Writes a scene file that `extends` another one and lists these values; folders that are missing are made. Throws
/// AssetError.
void saveTuning(const std::filesystem::path& file, const std::filesystem::path& scene,
                std::span<const TunedValue> values);

}  // namespace ragtop
