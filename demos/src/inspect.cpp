#include "inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "body_json.h"
#include "json_text.h"
#include "ragtop/character.h"
#include "ragtop/find_asset.h"
#include "ragtop/gltf_ragdoll.h"
#include "ragtop/mesh_file.h"
#include "ragtop/ragdoll_file.h"
#include "ragtop/robot.h"
#include "ragtop/scene.h"
#include "ragtop/start_overlaps.h"
#include "ragtop/vehicle_file.h"
#include "robot_json.h"

namespace ragtop::demos {
namespace {

namespace fs = std::filesystem;

/// Half of the widest difference of values.
template <class Values, class Get>
double spread(const Values& values, Get get) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end(),
                                                 [&](const auto& a, const auto& b) { return get(a) < get(b); });
    return static_cast<double>(get(*high) - get(*low));
}

std::string inspectVehicle(const fs::path& path) {
    const VehicleDef car = loadVehicle(path);
    std::string text = fmt::format("vehicle \"{}\": {} kg, {} wheels, {} chassis shapes\n", car.name, car.chassis.mass,
                                   car.wheels.size(), car.chassis.shapes.size());
    text += fmt::format("  wheelbase {:.3f} m, track {:.3f} m\n",
                        spread(car.wheels, [](const WheelDef& w) { return w.position.z; }),
                        spread(car.wheels, [](const WheelDef& w) { return w.position.x; }));
    const auto strongest =
        std::max_element(car.engine.torqueCurve.begin(), car.engine.torqueCurve.end(),
                         [](const TorquePoint& a, const TorquePoint& b) { return a.torque < b.torque; });
    if (strongest != car.engine.torqueCurve.end()) {
        text += fmt::format("  engine up to {} N m at {} rpm, limiter {} rpm\n", strongest->torque, strongest->rpm,
                            car.engine.limiterRpm);
    }
    text += fmt::format("  {} gears, {}, final drive {}\n", car.gearbox.ratios.size(),
                        car.gearbox.automatic ? "automatic" : "manual", car.gearbox.finalDrive);
    for (const WheelDef& w : car.wheels) {
        text += fmt::format(
            "  wheel {}: at ({:.3f}, {:.3f}, {:.3f}) m, radius {} m, {} kg, drive {}, steer {}, spring {}\n", w.name,
            w.position.x, w.position.y, w.position.z, w.radius, w.mass, w.driveShare, w.steerFactor,
            w.suspension.stiffness ? fmt::format("{} N/m", *w.suspension.stiffness)
                                   : fmt::format("{} Hz", w.suspension.frequency));
    }
    return text;
}

std::string inspectScene(const fs::path& path) {
    const Scene scene = loadScene(path);
    static constexpr const char* kShapes[] = {"spheres", "capsules",      "boxes",    "hulls",
                                              "meshes",  "height fields", "compounds"};
    std::map<std::size_t, int> shapes;
    int dynamic = 0, masonry = 0;
    for (const SceneBody& body : scene.bodies) {
        dynamic += body.def.type == BodyType::dynamic ? 1 : 0;
        masonry += body.masonry ? 1 : 0;
        for (const ShapeDef& shape : body.def.shapes) ++shapes[shape.geometry.index()];
    }
    std::string text = fmt::format("scene \"{}\": {} s in steps of {:.6g} s\n", scene.name, scene.duration, scene.step);
    text += fmt::format("  {} bodies, {} of them dynamic, {} masonry; {} joints\n", scene.bodies.size(), dynamic,
                        masonry, scene.joints.size());
    for (const auto& [kind, count] : shapes) text += fmt::format("  {} {}\n", count, kShapes[kind]);
    for (const SceneVehicle& v : scene.vehicles) {
        text += fmt::format("  vehicle \"{}\": {}, {} kg, {} m/s\n", v.name, v.def.name, v.def.chassis.mass,
                            v.placement.speed);
    }
    std::map<const RagdollDef*, int> ragdolls;
    for (const SceneRagdoll& r : scene.ragdolls) ++ragdolls[r.def.get()];
    for (const auto& [def, count] : ragdolls) {
        float mass = 0;
        for (const RagdollPart& part : def->parts) mass += part.mass;
        text += fmt::format("  {} ragdolls of {} parts, {} joints, {:.6g} kg\n", count, def->parts.size(),
                            def->joints.size(), mass);
    }
    for (const SceneRobot& r : scene.robots) {
        text += fmt::format("  robot \"{}\": {} bodies, {} joints, {:.6g} kg, {}\n", r.name, r.robot->bodies.size(),
                            r.robot->joints.size(), r.robot->mass, r.holding ? "holding" : "limp");
    }
    for (const std::string& warning : scene.warnings) text += "  warning: " + warning + "\n";
    for (const std::string& warning : startOverlaps(scene)) text += "  warning: " + warning + "\n";
    return text;
}

std::string inspectMesh(const fs::path& path) {
    const Shape shape = loadMesh(path);
    std::string text = fmt::format("mesh {}\n", path.string());
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
        Vec3 lower = mesh->vertices()[0], upper = lower;
        for (const Vec3& v : mesh->vertices()) lower = min(lower, v), upper = max(upper, v);
        text += fmt::format("  {} vertices, {} triangles, {} without area left out\n", mesh->vertices().size(),
                            mesh->triangles().size(), mesh->degenerateCount());
        text += fmt::format("  size {:.4g} × {:.4g} × {:.4g}, as it is in the file\n", upper.x - lower.x,
                            upper.y - lower.y, upper.z - lower.z);
    }
    return text;
}

/// As text, and as a member of a JSON object where there is more to tell than lines.
struct Inspected {
    std::string text, json;
};

Inspected inspectRobot(const fs::path& path) {
    const Robot robot = loadRobot(path);
    return {describeAsset(robot), "\"robot\": " + robotJson(robot)};
}

/// A model whose nodes move by physics is a ragdoll, one with bones a character, one without a mesh.
Inspected inspectModel(const fs::path& path) {
    if (hasGltfRagdoll(path)) {
        const GltfRagdoll read = loadGltfRagdoll(path);
        std::string text = path.string() + "\n" + describeAsset(read.ragdoll);
        for (const std::string& warning : read.warnings) text += "  warning   " + warning + "\n";
        return {text, {}};
    }
    std::string why;
    try {
        const Character character = loadCharacter(path);
        const RagdollDef ragdoll = makeRagdoll(character);
        return {describeAsset(character) + describeAsset(ragdoll),
                "\"body\": " + bodyJson(character, recognise(character.skeleton), ragdoll)};
    } catch (const AssetError& error) {
        // What could not be imported once is not tried again, which would take as long.
        if (std::string(error.what()).find("has no bones") == std::string::npos) throw;
        why = "nothing is skinned or moves as a skeleton";
    } catch (const std::invalid_argument& error) {  // bones that make no ragdoll
        why = error.what();
    }
    try {
        return {inspectMesh(path) + "  no body   " + why + "\n", {}};
    } catch (const AssetError& error) {
        if (std::string(error.what()).find("has no triangles") == std::string::npos) throw;
        throw AssetError(path.string(), "", "has no triangles, and is no body: " + why);
    }
}

Inspected inspectAny(const std::string& asset) {
    if (asset.ends_with(".car.json")) return {inspectVehicle(asset), {}};
    if (asset.ends_with(".ragdoll.json")) return {describeAsset(loadRagdoll(asset)), {}};
    const auto scenes = shippedScenes();
    if (asset.ends_with(".json") || std::find(scenes.begin(), scenes.end(), asset) != scenes.end()) {
        return {inspectScene(findScene(asset)), {}};
    }
    const fs::path path = findAsset(asset);
    if (path.extension() == ".urdf" || path.extension() == ".xml") return inspectRobot(path);
    return inspectModel(path);
}

}  // namespace

std::string inspect(const std::string& asset) { return inspectAny(asset).text; }

std::string inspectAsJson(const std::string& asset) {
    Inspected found = inspectAny(asset);
    if (found.json.empty()) {
        std::vector<std::string> lines;
        std::istringstream text(found.text);
        for (std::string line; std::getline(text, line);) lines.push_back(line);
        found.json = jsonList("lines", lines, [](const std::string& line) { return jsonString(line); }).substr(4);
    }
    return fmt::format("{{\n  \"asset\": {},\n  {}\n}}\n", jsonString(asset), found.json);
}

}  // namespace ragtop::demos
