#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "asset_reference.h"
#include "described_file.h"
#include "joint_json.h"
#include "ragdoll_extent.h"
#include "ragtop/scene.h"
#include "scene_file.h"
#include "scene_generators.h"
#include "tuning_json.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;
using Chain = std::vector<fs::path>;

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides, Chain& chain);

/// Turns one file into a Scene; each part is read where its place in the file is still known.
class SceneBuilder {
public:
    SceneBuilder(const JsonDocument& document, Chain& chain) : file_(document), chain_(chain) { readValue(file_, in_); }

    Scene build() && {
        scene_.settings = in_.settings;
        scene_.step = in_.step;
        scene_.duration = in_.duration;
        scene_.description = in_.description;
        if (in_.camera) scene_.camera = in_.camera->camera;
        scene_.materials = in_.materials;
        include();
        forEach(in_.bodies, "bodies", [&](const BodyInFile& b, const JsonValue& at) { add(b, poseOf(b.place), at); });
        forEach(in_.repeat, "repeat", [&](const RepeatInFile& r, const JsonValue& at) {
            for (const Pose& pose : posesOf(r.grid, poseOf(r.body.place))) add(r.body, pose, at.at("body"));
        });
        generate(in_.walls, "walls", addWall);
        generate(in_.houses, "houses", addHouse);
        generate(in_.towers, "towers", addTower);
        generate(in_.stairs, "stairs", addStairs);
        forEach(in_.roads, "roads", [&](const RoadInFile& r, const JsonValue& at) { add(r, at); });
        forEach(in_.joints, "joints", [&](const SceneJointInFile& j, const JsonValue& at) { add(j, at); });
        forEach(in_.couplings, "couplings", [&](const CouplingInFile& c, const JsonValue& at) { add(c, at); });
        forEach(in_.animated, "animated", [&](const AnimatedInFile& a, const JsonValue& at) { add(a, at); });
        forEach(in_.vehicles, "vehicles", [&](const VehicleInFile& v, const JsonValue& at) { add(v, at); });
        forEach(in_.ragdolls, "ragdolls", [&](const RagdollInScene& r, const JsonValue& at) { add(r, at); });
        if (file_.has("tuning")) readTuning(file_.at("tuning"), scene_);
        return std::move(scene_);
    }

private:
    template <class T, class Add>
    void forEach(const std::vector<T>& all, const char* key, Add addOne) {
        for (std::size_t i = 0; i < all.size(); ++i) addOne(all[i], file_.at(key).at(i));
    }

    template <class T, class Generator>
    void generate(const std::vector<T>& all, const char* key, Generator make) {
        forEach(all, key, [&](const T& one, const JsonValue& at) {
            const std::size_t first = scene_.bodies.size();
            make(one, material(one, at), scene_.bodies);
            const auto color = colorOf(one, at);
            for (std::size_t i = first; i < scene_.bodies.size(); ++i) {
                scene_.bodies[i].material = one.material;
                scene_.bodies[i].color = color;
            }
        });
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
            for (SceneCoupling& coupling : other.couplings)
                for (std::size_t& joint : coupling.joints) joint += scene_.joints.size();
            append(scene_.couplings, std::move(other.couplings));
            for (SceneAnimation& animation : other.animated) {
                animation.body += offset;
                if (animation.carrier >= 0) animation.carrier += offset;
            }
            append(scene_.animated, std::move(other.animated));
            adoptMaterials(other);
            append(scene_.bodies, std::move(other.bodies));
            append(scene_.joints, std::move(other.joints));
            for (SceneVehicle& vehicle : other.vehicles) {
                if (vehicle.driver) vehicle.driver->road += scene_.roads.size();
            }
            append(scene_.roads, std::move(other.roads));
            append(scene_.vehicles, std::move(other.vehicles));
            append(scene_.ragdolls, std::move(other.ragdolls));
            append(scene_.warnings, std::move(other.warnings));
            append(scene_.files, std::move(other.files));
        }
    }

    /// Materials of an included scene keep their names, with its own before them where others have them already.
    void adoptMaterials(Scene& other) {
        for (const auto& [name, material] : other.materials) {
            const auto [known, isNew] = scene_.materials.try_emplace(name, material);
            if (isNew || known->second == material) continue;
            const std::string longer = other.name + "/" + name;
            scene_.materials[longer] = material;
            for (SceneBody& body : other.bodies) {
                if (body.material == name) body.material = longer;
            }
        }
    }

    /// A document that the scene refers to.
    JsonDocument referencedDocument(const JsonValue& reference) {
        JsonDocument document = loadExtended(referencedFile(reference));
        scene_.files.insert(scene_.files.end(), document.files().begin(), document.files().end());
        return document;
    }

    template <class T>
    Material material(const T& in, const JsonValue& at) const {
        if (in.material.empty()) return {};
        if (const auto found = in_.materials.find(in.material); found != in_.materials.end()) return found->second;
        std::vector<std::string> names;
        for (const auto& item : in_.materials) names.push_back(item.first);
        failName(at.at("material"), names, "materials");
    }

    template <class T>
    static std::optional<Color> colorOf(const T& in, const JsonValue& at) {
        if (in.color.empty()) return {};
        Color color = 0;
        const char* first = in.color.data() + 1;
        const char* last = in.color.data() + in.color.size();
        const bool shaped = in.color.size() == 7 && in.color[0] == '#';
        if (!shaped || std::from_chars(first, last, color, 16).ptr != last) {
            at.at("color").fail("is " + shown(at.at("color").json()) + ", must be like \"#8a9a86\"");
        }
        return color;
    }

    [[noreturn]] static void failName(const JsonValue& at, const std::vector<std::string>& names, const char* what) {
        const std::string near = nearestName(at.json().get<std::string>(), names);
        at.fail(fmt::format("is {}, must be the name of one of the {} {}{}", shown(at.json()), names.size(), what,
                            near.empty() ? "" : "; did you mean \"" + near + "\"?"));
    }

    void add(const BodyInFile& in, const Pose& pose, const JsonValue& at) {
        SceneBody body{in.name, in.def, in.masonry, in.material, colorOf(in, at)};
        body.def.type = in.type;
        body.def.pose = pose;
        body.def.shapes.push_back({.geometry = *in.shape,
                                   .density = in.density,
                                   .material = material(in, at),
                                   .filter = in.filter,
                                   .sensor = in.sensor});
        if (std::holds_alternative<HeightField>(*in.shape) && in.type == BodyType::dynamic) {
            at.at("shape").fail("is a surface without volume, must be on a body of type \"fixed\" or \"kinematic\"");
        }
        if (const std::string wrong = whyInvalid(body.def); !wrong.empty()) at.fail("is no usable body: " + wrong);
        scene_.bodies.push_back(std::move(body));
    }

    void add(const RoadInFile& in, const JsonValue& at) {
        const std::size_t least = in.closed ? 3 : 2;
        if (in.points.size() < least) {
            at.at("points").fail(fmt::format("has {} points, must have {} or more", in.points.size(), least));
        }
        SceneRoad road;
        SceneBody body = roadBody(in, material(in, at), road);
        body.material = in.material;
        body.color = colorOf(in, at);
        if (const std::string wrong = whyInvalid(body.def); !wrong.empty()) at.fail("is no usable road: " + wrong);
        scene_.bodies.push_back(std::move(body));
        scene_.roads.push_back(std::move(road));
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
        std::visit(
            [&](auto& kind) {
                kind.bodies.frameA = frameIn(joint.bodyA, in.anchor, rotation);
                kind.bodies.frameB = frameIn(joint.bodyB, in.anchorB.value_or(in.anchor), rotation);
                kind.bodies.collide = in.collide;
                kind.bodies.breakForce = in.breakForce.value_or(kNoForceLimit);
                kind.bodies.breakTorque = in.breakTorque.value_or(kNoForceLimit);
            },
            joint.def);
        scene_.joints.push_back(std::move(joint));
    }

    std::size_t jointNamed(const CoupledInFile& part, const JsonValue& at) const {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < scene_.joints.size(); ++i) {
            if (scene_.joints[i].name == part.joint) return i;
            if (!scene_.joints[i].name.empty()) names.push_back(scene_.joints[i].name);
        }
        failName(at.at("joint"), names, "named joints");
    }

    void add(const CouplingInFile& in, const JsonValue& at) {
        if (in.parts.empty() || in.parts.size() > CouplingDef::kMostParts)
            at.at("parts").fail(
                fmt::format("has {} parts, must have 1 to {}", in.parts.size(), CouplingDef::kMostParts));
        SceneCoupling coupling{in.name, {}, {}};
        for (std::size_t i = 0; i < in.parts.size(); ++i) {
            coupling.joints.push_back(jointNamed(in.parts[i], at.at("parts").at(i)));
            coupling.def.parts[i] = {{}, in.parts[i].coordinate, in.parts[i].ratio};
        }
        coupling.def.count = static_cast<int>(in.parts.size());
        coupling.def.sum = in.sum;
        scene_.couplings.push_back(std::move(coupling));
    }

    void add(const AnimatedInFile& in, const JsonValue& at) {
        SceneAnimation animation{bodyNamed(in.body, at, "body"), bodyNamed(in.carrier, at, "carrier"), in.def};
        for (const KeyInFile& key : in.keys) animation.def.keys.push_back({key.time, {key.position, key.rotation}});
        if (const std::string why = whyInvalid(animation.def); !why.empty()) at.fail("is not usable: " + why);
        scene_.animated.push_back(std::move(animation));
    }

    void add(const VehicleInFile& in, const JsonValue& at) {
        SceneVehicle vehicle{in.name, readVehicle(referencedDocument(at.at("file"))), in.placement, {}, {}};
        for (std::size_t i = 0; i < in.script.size(); ++i) {
            const double before = i == 0 ? 0 : in.script[i - 1].time;
            if (in.script[i].time < before) {
                at.at("script").at(i).fail(
                    fmt::format("has the time {}, must not be before {} s, that of the action before it",
                                in.script[i].time, before));
            }
            vehicle.script.push_back({in.script[i].time, in.script[i].input});
        }
        if (in.driver) vehicle.driver = driverOf(*in.driver, at.at("driver"));
        if (in.driver && !in.script.empty()) at.at("driver").fail("goes without a \"script\"");
        scene_.vehicles.push_back(std::move(vehicle));
    }

    SceneDriver driverOf(const DriverInFile& in, const JsonValue& at) const {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < scene_.roads.size(); ++i) {
            if (scene_.roads[i].name == in.road) return {i, in.speed};
            names.push_back(scene_.roads[i].name);
        }
        failName(at.at("road"), names, "roads");
    }

    std::shared_ptr<const RagdollDef> definition(const RagdollInScene& in, const JsonValue& at) {
        if (in.file.empty() == in.character.empty()) at.fail("must have either a \"file\" or a \"character\"");
        if (!in.file.empty()) {
            if (at.has("options"))
                at.at("options").fail("goes with a \"character\" only, a file says everything itself");
            return std::make_shared<RagdollDef>(readRagdoll(referencedDocument(at.at("file"))));
        }
        return std::make_shared<RagdollDef>(ragdollFromCharacter(at.at("character"), in.options, scene_.warnings));
    }

    void add(const RagdollInScene& in, const JsonValue& at) {
        const auto def = definition(in, at);
        const fs::path character = in.character.empty() ? fs::path() : assetFile(at.at("character"));
        if (!character.empty()) scene_.files.push_back(character);
        auto poses = posesOf(in.grid, poseOf(in.place));
        // The origin of a person is between the feet; tumbling turns about the middle.
        const Vec3 middle = middleOf(*def), upright = rotate(poseOf(in.place).rotation, middle);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            if (in.standing) poses[i].position.y -= static_cast<double>(lowestPointOf(*def, poses[i].rotation));
            if (in.grid.tumble) poses[i].position = poses[i].position + (upright - rotate(poses[i].rotation, middle));
            const std::string name =
                poses.size() == 1 || in.name.empty() ? in.name : fmt::format("{} {}", in.name, i + 1);
            scene_.ragdolls.push_back({name, def, poses[i], in.velocity, character});
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
    schema["properties"]["tuning"] = tuningSchema();
    return schema;
}

constexpr std::string_view kTuning = "tuning.";

/// A bare name of a setting stands for its path; what follows "tuning." is one key.
void setOverride(JsonDocument& document, const SceneOverride& one, const Json& value) {
    const std::string origin = "--set " + one.path + "=" + one.value;
    if (one.path.starts_with(kTuning)) return document.set({"tuning", one.path.substr(kTuning.size())}, value, origin);
    const bool isSetting = writeValue(WorldSettings{}).contains(one.path);
    document.set(isSetting ? "settings." + one.path : one.path, value, origin);
}

Json parseOverride(const std::string& text) {
    Json value = Json::parse(text, nullptr, false);
    return value.is_discarded() ? Json(text) : value;
}

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides, Chain& chain) {
    JsonDocument document = loadExtended(path);
    chain.push_back(fs::weakly_canonical(path));
    for (const SceneOverride& one : overrides) setOverride(document, one, parseOverride(one.value));
    validate(document, sceneSchema());
    Scene scene = SceneBuilder(document, chain).build();
    if (const std::string wrong = whyInvalid(scene.settings); !wrong.empty()) {
        document.fail("/settings", "is not usable: " + wrong);
    }
    scene.name = path.stem().string();
    scene.files.insert(scene.files.begin(), document.files().begin(), document.files().end());
    chain.pop_back();
    return scene;
}

}  // namespace

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides) {
    Chain chain;
    return loadScene(path, overrides, chain);
}

}  // namespace ragtop
