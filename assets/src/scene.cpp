#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "asset_reference.h"
#include "described_file.h"
#include "joint_json.h"
#include "ragdoll_extent.h"
#include "ragtop/ragdoll_file.h"
#include "ragtop/scene.h"
#include "ragtop/vehicle_file.h"
#include "scene_file.h"
#include "scene_generators.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;
using Chain = std::vector<fs::path>;

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides, Chain& chain);

/// Turns one file into a Scene; each part is read where its place in the file is still known.
class SceneBuilder {
public:
    SceneBuilder(const JsonDocument& document, Chain& chain) : file_(document), chain_(chain) {
        readValue(file_, in_);
    }

    Scene build() && {
        scene_.settings = in_.settings;
        scene_.step = in_.step;
        scene_.duration = in_.duration;
        include();
        forEach(in_.bodies, "bodies", [&](const BodyInFile& b, const JsonValue& at) { add(b, poseOf(b.place), at); });
        forEach(in_.repeat, "repeat", [&](const RepeatInFile& r, const JsonValue& at) {
            for (const Pose& pose : posesOf(r.grid, poseOf(r.body.place))) add(r.body, pose, at.at("body"));
        });
        forEach(in_.walls, "walls", [&](const auto& w, const auto& at) { addWall(w, material(w, at), scene_.bodies); });
        forEach(in_.houses, "houses", [&](const auto& h, const auto& at) { addHouse(h, material(h, at), scene_.bodies); });
        forEach(in_.towers, "towers", [&](const auto& t, const auto& at) { addTower(t, material(t, at), scene_.bodies); });
        forEach(in_.stairs, "stairs", [&](const auto& s, const auto& at) { addStairs(s, material(s, at), scene_.bodies); });
        forEach(in_.joints, "joints", [&](const SceneJointInFile& j, const JsonValue& at) { add(j, at); });
        forEach(in_.vehicles, "vehicles", [&](const VehicleInFile& v, const JsonValue& at) { add(v, at); });
        forEach(in_.ragdolls, "ragdolls", [&](const RagdollInScene& r, const JsonValue& at) { add(r, at); });
        return std::move(scene_);
    }

private:
    template <class T, class Add>
    void forEach(const std::vector<T>& all, const char* key, Add addOne) {
        for (std::size_t i = 0; i < all.size(); ++i) addOne(all[i], file_.at(key).at(i));
    }

    template <class T>
    static void append(std::vector<T>& to, std::vector<T>&& from) {
        std::move(from.begin(), from.end(), std::back_inserter(to));
    }

    void include() {
        for (std::size_t i = 0; i < in_.include.size(); ++i) {
            const JsonValue reference = file_.at("include").at(i);
            const fs::path path = referencedFile(reference);
            if (std::find(chain_.begin(), chain_.end(), fs::weakly_canonical(path)) != chain_.end()) {
                reference.fail("is " + shown(reference.json()) + ", must not lead back to the scene itself");
            }
            Scene other = loadScene(path, {}, chain_);
            const int offset = static_cast<int>(scene_.bodies.size());
            for (SceneJoint& joint : other.joints) {
                if (joint.bodyA >= 0) joint.bodyA += offset;
                if (joint.bodyB >= 0) joint.bodyB += offset;
            }
            append(scene_.bodies, std::move(other.bodies));
            append(scene_.joints, std::move(other.joints));
            append(scene_.vehicles, std::move(other.vehicles));
            append(scene_.ragdolls, std::move(other.ragdolls));
            append(scene_.warnings, std::move(other.warnings));
        }
    }

    template <class T>
    Material material(const T& in, const JsonValue& at) const {
        if (in.material.empty()) return {};
        if (const auto found = in_.materials.find(in.material); found != in_.materials.end()) return found->second;
        std::vector<std::string> names;
        for (const auto& item : in_.materials) names.push_back(item.first);
        failName(at.at("material"), names, "materials");
    }

    [[noreturn]] static void failName(const JsonValue& at, const std::vector<std::string>& names, const char* what) {
        const std::string near = nearestName(at.json().get<std::string>(), names);
        at.fail(fmt::format("is {}, must be the name of one of the {} {}{}", shown(at.json()), names.size(), what,
                            near.empty() ? "" : "; did you mean \"" + near + "\"?"));
    }

    void add(const BodyInFile& in, const Pose& pose, const JsonValue& at) {
        SceneBody body{in.name, in.def, in.masonry};
        body.def.type = in.type;
        body.def.pose = pose;
        body.def.shapes.push_back({.geometry = *in.shape,
                                   .density = in.density,
                                   .material = material(in, at),
                                   .filter = in.filter,
                                   .sensor = in.sensor});
        const bool surface = std::holds_alternative<TriangleMesh>(*in.shape) || std::holds_alternative<HeightField>(*in.shape);
        if (surface && in.type == BodyType::dynamic) {
            at.at("shape").fail("is a surface without volume, must be on a body of type \"fixed\" or \"kinematic\"");
        }
        if (const std::string wrong = whyInvalid(body.def); !wrong.empty()) at.fail("is no usable body: " + wrong);
        scene_.bodies.push_back(std::move(body));
    }

    int bodyNamed(const std::string& name, const JsonValue& joint, const char* key) const {
        if (name.empty()) return -1;
        std::vector<std::string> names;
        for (const SceneBody& body : scene_.bodies) {
            if (body.name == name) return static_cast<int>(&body - scene_.bodies.data());
            if (!body.name.empty()) names.push_back(body.name);
        }
        failName(joint.at(key), names, "named bodies");
    }

    /// The joint's frame in a body, or in the world for −1.
    Frame frameIn(int body, const DVec3& anchor, const Quat& rotation) const {
        const Pose pose = body < 0 ? Pose{} : scene_.bodies[static_cast<std::size_t>(body)].def.pose;
        return relative(pose, Pose{anchor, rotation});
    }

    void add(const SceneJointInFile& in, const JsonValue& at) {
        SceneJoint joint{in.name, bodyNamed(in.a, at, "a"), bodyNamed(in.b, at, "b"), readJointKind(at)};
        if (joint.bodyA == joint.bodyB) at.fail("joins a body with itself, \"a\" and \"b\" must differ");
        if (!(length(in.axis) > 0)) at.at("axis").fail("is [0, 0, 0], must have a direction");
        const Quat rotation = rotationBetween({1, 0, 0}, normalized(in.axis));
        std::visit([&](auto& kind) {
            kind.bodies.frameA = frameIn(joint.bodyA, in.anchor, rotation);
            kind.bodies.frameB = frameIn(joint.bodyB, in.anchorB.value_or(in.anchor), rotation);
            kind.bodies.collide = in.collide;
        }, joint.def);
        scene_.joints.push_back(std::move(joint));
    }

    void add(const VehicleInFile& in, const JsonValue& at) {
        SceneVehicle vehicle{in.name, loadVehicle(referencedFile(at.at("file"))), in.placement, {}};
        for (std::size_t i = 0; i < in.script.size(); ++i) {
            const double before = i == 0 ? 0 : in.script[i - 1].time;
            if (in.script[i].time < before) {
                at.at("script").at(i).fail(fmt::format("has the time {}, must not be before {} s, that of the action before it",
                                                       in.script[i].time, before));
            }
            vehicle.script.push_back({in.script[i].time, in.script[i].input});
        }
        scene_.vehicles.push_back(std::move(vehicle));
    }

    std::shared_ptr<const RagdollDef> definition(const RagdollInScene& in, const JsonValue& at) {
        if (in.file.empty() == in.character.empty()) at.fail("must have either a \"file\" or a \"character\"");
        if (!in.file.empty()) {
            if (at.has("options")) at.at("options").fail("goes with a \"character\" only, a file says everything itself");
            return std::make_shared<RagdollDef>(loadRagdoll(referencedFile(at.at("file"))));
        }
        return std::make_shared<RagdollDef>(ragdollFromCharacter(at.at("character"), in.options, scene_.warnings));
    }

    void add(const RagdollInScene& in, const JsonValue& at) {
        const auto def = definition(in, at);
        auto poses = posesOf(in.grid, poseOf(in.place));
        // The origin of a person is between the feet; tumbling turns about the middle.
        const Vec3 middle = middleOf(*def), upright = rotate(poseOf(in.place).rotation, middle);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            if (in.standing) poses[i].position.y -= static_cast<double>(lowestPointOf(*def, poses[i].rotation));
            if (in.grid.tumble) poses[i].position = poses[i].position + (upright - rotate(poses[i].rotation, middle));
            const std::string name = poses.size() == 1 || in.name.empty() ? in.name : fmt::format("{} {}", in.name, i + 1);
            scene_.ragdolls.push_back({name, def, poses[i], in.velocity});
        }
    }

    JsonValue file_;
    Chain& chain_;
    SceneInFile in_;
    Scene scene_;
};

Json sceneSchema() {
    Json schema = objectSchema(SceneInFile{});
    addJointKinds(schema["properties"]["joints"]["items"]);
    return schema;
}

/// A bare name of a setting stands for its path.
std::string fullPath(const std::string& path) {
    const Json settings = writeValue(WorldSettings{});
    return settings.contains(path) ? "settings." + path : path;
}

Json parseOverride(const std::string& text) {
    Json value = Json::parse(text, nullptr, false);
    return value.is_discarded() ? Json(text) : value;
}

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides, Chain& chain) {
    JsonDocument document = loadExtended(path);
    chain.push_back(fs::weakly_canonical(path));
    for (const SceneOverride& one : overrides) {
        document.set(fullPath(one.path), parseOverride(one.value), "--set " + one.path + "=" + one.value);
    }
    validate(document, sceneSchema());
    Scene scene = SceneBuilder(document, chain).build();
    if (const std::string wrong = whyInvalid(scene.settings); !wrong.empty()) {
        document.fail("/settings", "is not usable: " + wrong);
    }
    scene.name = path.stem().string();
    chain.pop_back();
    return scene;
}

}  // namespace

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides) {
    Chain chain;
    return loadScene(path, overrides, chain);
}

}  // namespace ragtop
