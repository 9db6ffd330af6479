#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "asset_reference.h"
#include "described_file.h"
#include "import_text.h"
#include "joint_json.h"
#include "left_out.h"
#include "ragdoll_extent.h"
#include "ragtop/scene.h"
#include "scene_actors.h"
#include "scene_cloth.h"
#include "scene_file.h"
#include "scene_generators.h"
#include "scene_merge.h"
#include "tuning_json.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;
using Chain = std::vector<fs::path>;

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides, Chain chain);

/// Turns one file into a Scene; each part is read where its place in the file is still known. Parts that are wrong are
/// left out and noted, for the others to complain too.
class SceneBuilder {
public:
    SceneBuilder(const JsonDocument& document, const Chain& chain, Faults& faults)
        : file_(document, &faults), chain_(chain) {
        readValue(file_, in_);
        for (const auto& item : file_.json().items()) {
            if (file_.at(item.key()).isWrong()) left_.noteMember(item.key(), item.value());
        }
    }

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
            for (const Pose& pose : posesOf(r.grid, poseOf(r.body.place), at)) add(r.body, pose, at.at("body"));
        });
        generate(in_.walls, "walls", addWall);
        generate(in_.houses, "houses", addHouse);
        generate(in_.towers, "towers", addTower);
        generate(in_.stairs, "stairs", addStairs);
        forEach(in_.roads, "roads", [&](const RoadInFile& r, const JsonValue& at) { add(r, at); });
        forEach(in_.ragdolls, "ragdolls", [&](const RagdollInScene& r, const JsonValue& at) { add(r, at); });
        forEach(in_.robots, "robots", [&](const RobotInScene& r, const JsonValue& at) { add(r, at); });
        forEach(in_.vehicles, "vehicles", [&](const VehicleInFile& v, const JsonValue& at) { add(v, at); });
        forEach(in_.cloths, "cloths", [&](const ClothInScene& c, const JsonValue& at) { add(c, at); });
        forEach(in_.joints, "joints", [&](const SceneJointInFile& j, const JsonValue& at) { add(j, at); });
        forEach(in_.couplings, "couplings", [&](const CouplingInFile& c, const JsonValue& at) { add(c, at); });
        forEach(in_.animated, "animated", [&](const AnimatedInFile& a, const JsonValue& at) { add(a, at); });
        if (file_.has("settings")) file_.at("settings").attempt([&] { check(file_.at("settings")); });
        const auto isThere = [&](const std::string& path) { return isWhole(path); };
        if (file_.has("tuning") && !file_.at("tuning").isWrong())
            file_.at("tuning").attempt([&] { readTuning(file_.at("tuning"), scene_, isThere); });
        return std::move(scene_);
    }

private:
    void check(const JsonValue& settings) const {
        const std::string wrong = whyInvalid(scene_.settings);
        if (!wrong.empty() && !settings.holdsWrong()) settings.fail("is not usable: " + wrong);
    }

    /// Whether all that the file has of what a path of a tuning begins with is in the scene.
    bool isWhole(const std::string& path) const {
        const std::string first = path.substr(0, path.find('.'));
        return !left_.isAnything() && (!file_.has(first) || !file_.at(first).holdsWrong());
    }

    /// What is wrong about a part was told; it is not looked at further.
    static void needRight(const JsonValue& part) {
        if (part.holdsWrong()) throw Faults::Consequence();
    }

    static bool isWrong(const JsonValue& at, const char* key) { return at.has(key) && at.at(key).holdsWrong(); }

    std::size_t size() const { return scene_.bodies.size() + scene_.ragdolls.size() + scene_.robots.size(); }

    void needFew(const JsonValue& at) const {
        if (size() > kMostBodies)
            at.fail(fmt::format("brings the scene to {} bodies, ragdolls and robots, at most {} are allowed", size(),
                                kMostBodies));
    }

    template <class T, class Add>
    void forEach(const std::vector<T>& all, const char* key, Add addOne) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            const JsonValue at = file_.at(key).at(i);
            if (size() > kMostBodies) return;
            if (!at.isWrong()) at.attempt([&] { addOne(all[i], at), needFew(at); });
            if (at.holdsWrong()) left_.note(key, at.json());
        }
    }

    template <class T, class Generator>
    void generate(const std::vector<T>& all, const char* key, Generator make) {
        forEach(all, key, [&](const T& one, const JsonValue& at) {
            const std::size_t first = scene_.bodies.size();
            const Material surface = material(one, at);
            const auto color = colorOf(one, at);
            needRight(at);
            make(one, surface, scene_.bodies);
            for (std::size_t i = first; i < scene_.bodies.size(); ++i) {
                scene_.bodies[i].material = one.material;
                scene_.bodies[i].color = color;
            }
        });
    }

    void include() {
        for (std::size_t i = 0; i < in_.include.size(); ++i) {
            const JsonValue reference = file_.at("include").at(i);
            if (!reference.isWrong()) reference.attempt([&] { include(reference); });
            if (reference.isWrong()) left_.note("include", reference.json());
        }
    }

    void include(const JsonValue& reference) {
        const fs::path path = referencedFile(reference);
        if (std::find(chain_.begin(), chain_.end(), fs::weakly_canonical(path)) != chain_.end()) {
            reference.fail("is " + shown(reference.json()) + ", must not lead back to the scene itself");
        }
        if (chain_.size() >= kLongestChain)
            reference.fail(fmt::format("follows {} others, the most allowed", chain_.size()));
        Scene other = loadScene(path, {}, chain_);
        appendScene(std::move(other), scene_);
    }

    /// A document that the scene refers to.
    JsonDocument referencedDocument(const JsonValue& reference) {
        JsonDocument document = loadExtended(referencedFile(reference));
        scene_.files.insert(scene_.files.end(), document.files().begin(), document.files().end());
        return document;
    }

    template <class T>
    Material material(const T& in, const JsonValue& at) const {
        Material surface;
        if (in.material.empty()) return surface;
        at.attempt("material", [&](const JsonValue& name) {
            const auto found = in_.materials.find(in.material);
            if (found == in_.materials.end()) failName(name, namesIn(in_.materials), "materials");
            surface = found->second;
        });
        return surface;
    }

    static std::vector<std::string> namesIn(const std::map<std::string, Material>& materials) {
        std::vector<std::string> names;
        for (const auto& item : materials) names.push_back(item.first);
        return names;
    }

    template <class T>
    static std::optional<Color> colorOf(const T& in, const JsonValue& at) {
        if (in.color.empty()) return {};
        Color color = 0;
        at.attempt("color", [&](const JsonValue& text) {
            const char* first = in.color.data() + 1;
            const char* last = in.color.data() + in.color.size();
            const bool shaped = in.color.size() == 7 && in.color[0] == '#';
            if (!shaped || std::from_chars(first, last, color, 16).ptr != last)
                text.fail("is " + shown(text.json()) + ", must be like \"#8a9a86\"");
        });
        return color;
    }

    [[noreturn]] void failName(const JsonValue& at, const std::vector<std::string>& names, const char* kind) const {
        const std::string name = at.json().get<std::string>();
        if (left_.mayHave(kind, name)) throw Faults::Consequence();
        const std::string near = nearestName(name, names);
        at.fail(fmt::format("is {}, must be the name of one of the {} {}{}", shown(at.json()), names.size(), kind,
                            near.empty() ? "" : "; did you mean \"" + near + "\"?"));
    }

    void add(const BodyInFile& in, const Pose& pose, const JsonValue& at) {
        SceneBody body{in.name, in.def, in.masonry, in.material, colorOf(in, at)};
        const Material surface = material(in, at);
        needRight(at);
        body.def.type = in.type;
        body.def.pose = pose;
        body.def.shapes.push_back({.geometry = *in.shape,
                                   .density = in.density,
                                   .material = surface,
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
        at.attempt("points", [&](const JsonValue& points) {
            if (in.points.size() < least)
                points.fail(fmt::format("has {} points, must have {} or more", in.points.size(), least));
        });
        const Material surface = material(in, at);
        const auto color = colorOf(in, at);
        needRight(at);
        SceneRoad road;
        SceneBody body = roadBody(in, surface, road);
        body.material = in.material;
        body.color = color;
        if (const std::string wrong = whyInvalid(body.def); !wrong.empty()) at.fail("is no usable road: " + wrong);
        scene_.bodies.push_back(std::move(body));
        scene_.roads.push_back(std::move(road));
    }

    /// −1 for the world, which has no name.
    int bodyNamed(const std::string& name, const JsonValue& at, const char* key) const {
        int index = -1;
        if (name.empty()) return index;
        at.attempt(key, [&](const JsonValue& value) {
            index = static_cast<int>(theOne(scene_.bodies, value, LeftOut::kBodies));
        });
        return index;
    }

    struct Hold {
        int body = -1;
        ScenePart part{};
    };

    /// A body, a part, or the world, which has no name.
    Hold holdNamed(const std::string& name, const JsonValue& at, const char* key) const {
        Hold hold;
        if (name.empty()) return hold;
        const auto isIt = [&](const SceneBody& body) { return body.name == name; };
        const bool isBody = std::any_of(scene_.bodies.begin(), scene_.bodies.end(), isIt);
        at.attempt(key, [&](const JsonValue& value) {
            if (!isBody) hold.part = partOfScene(scene_, name, left_, value);
            if (!hold.part) hold.body = static_cast<int>(theOne(scene_.bodies, value, LeftOut::kBodies));
        });
        return hold;
    }

    /// The index of the only thing of the name that `at` holds.
    template <class T>
    std::size_t theOne(const std::vector<T>& all, const JsonValue& at, const char* kind) const {
        const std::string name = at.json().get<std::string>();
        const auto isIt = [&](const T& one) { return one.name == name; };
        const auto found = std::find_if(all.begin(), all.end(), isIt);
        const auto right = static_cast<std::size_t>(std::count_if(found, all.end(), isIt));
        const std::size_t count = right + left_.count(kind, name);
        if (count > 1)
            at.fail(fmt::format("is {}, must be the name of one thing alone; it is that of {} of the {}",
                                shown(at.json()), count, kind));
        if (right == 1) return static_cast<std::size_t>(found - all.begin());
        std::vector<std::string> names;
        for (const T& one : all)
            if (!one.name.empty()) names.push_back(one.name);
        failName(at, names, kind);
    }

    /// The joint's frame in what holds it.
    Frame frameIn(const Hold& hold, const DVec3& anchor, const Quat& rotation) const {
        Pose pose;
        if (hold.body >= 0) pose = scene_.bodies[static_cast<std::size_t>(hold.body)].def.pose;
        if (hold.part) pose = placeOf(scene_, hold.part);
        return relative(pose, Pose{anchor, rotation});
    }

    void add(const SceneJointInFile& in, const JsonValue& at) {
        const Hold a = holdNamed(in.a, at, "a"), b = holdNamed(in.b, at, "b");
        SceneJoint joint{in.name, a.body, b.body, {}, a.part, b.part};
        at.attempt("axis", [&](const JsonValue& axis) {
            if (!(length(in.axis) > 0)) axis.fail("is [0, 0, 0], must have a direction");
        });
        at.attempt([&] { joint.def = readJointKind(at); });
        const bool hasWrongEnd = at.holdsUnknown() || isWrong(at, "a") || isWrong(at, "b");
        if (in.a == in.b && !hasWrongEnd)
            at.attempt([&] { at.fail("joins a body with itself, \"a\" and \"b\" must differ"); });
        needRight(at);
        const Quat rotation = rotationBetween({1, 0, 0}, normalized(in.axis));
        std::visit(
            [&](auto& kind) {
                kind.bodies.frameA = frameIn(a, in.anchor, rotation);
                kind.bodies.frameB = frameIn(b, in.anchorB.value_or(in.anchor), rotation);
                kind.bodies.collide = in.collide;
                kind.bodies.breakForce = in.breakForce.value_or(kNoForceLimit);
                kind.bodies.breakTorque = in.breakTorque.value_or(kNoForceLimit);
            },
            joint.def);
        if (const std::string wrong = whyInvalidKind(joint.def); !wrong.empty()) at.fail("is not usable: " + wrong);
        if (turnsOften(joint.def))
            scene_.warnings.push_back(fmt::format("joint {} may turn more than once round: its angles are radians",
                                                  in.name.empty() ? at.pointer() : "\"" + in.name + "\""));
        scene_.joints.push_back(std::move(joint));
    }

    void add(const CouplingInFile& in, const JsonValue& at) {
        at.attempt("parts", [&](const JsonValue& parts) {
            if (in.parts.empty() || in.parts.size() > CouplingDef::kMostParts)
                parts.fail(fmt::format("has {} parts, must have 1 to {}", in.parts.size(), CouplingDef::kMostParts));
        });
        SceneCoupling coupling{in.name, {}, {}};
        for (std::size_t i = 0; i < in.parts.size(); ++i) {
            at.at("parts").at(i).attempt("joint", [&](const JsonValue& joint) {
                coupling.joints.push_back(theOne(scene_.joints, joint, LeftOut::kJoints));
            });
        }
        needRight(at);
        for (std::size_t i = 0; i < in.parts.size(); ++i)
            coupling.def.parts[i] = {{}, in.parts[i].coordinate, in.parts[i].ratio};
        coupling.def.count = static_cast<int>(in.parts.size());
        coupling.def.sum = in.sum;
        needUsable(coupling, at);
        scene_.couplings.push_back(std::move(coupling));
    }

    void add(const AnimatedInFile& in, const JsonValue& at) {
        SceneAnimation animation{bodyNamed(in.body, at, "body"), bodyNamed(in.carrier, at, "carrier"), in.def};
        for (const KeyInFile& key : in.keys) animation.def.keys.push_back({key.time, {key.position, key.rotation}});
        at.attempt("keys", [&](const JsonValue& keys) {
            if (const std::string why = whyInvalid(animation.def); !why.empty()) keys.fail("is not usable: " + why);
        });
        needRight(at);
        scene_.animated.push_back(std::move(animation));
    }

    void add(const VehicleInFile& in, const JsonValue& at) {
        SceneVehicle vehicle{in.name, {}, in.placement, {}, {}};
        at.attempt("file", [&](const JsonValue& file) { vehicle.def = readVehicle(referencedDocument(file)); });
        if (!in.script.empty()) vehicle.script = scriptOf(in.script, at.at("script"));
        if (in.driver) {
            at.attempt("driver", [&](const JsonValue& driver) {
                if (!in.script.empty()) driver.fail("goes without a \"script\"");
                const std::size_t road = theOne(scene_.roads, driver.at("road"), LeftOut::kRoads);
                vehicle.driver = SceneDriver{road, in.driver->speed};
            });
        }
        needRight(at);
        scene_.vehicles.push_back(std::move(vehicle));
    }

    std::shared_ptr<const RagdollDef> definition(const RagdollInScene& in, const JsonValue& at) {
        if (in.file.empty() && in.character.empty() && at.holdsUnknown()) throw Faults::Consequence();
        if (in.file.empty() == in.character.empty()) at.fail("must have either a \"file\" or a \"character\"");
        std::shared_ptr<const RagdollDef> def;
        if (!in.file.empty()) {
            at.attempt("options", [&](const JsonValue& options) {
                options.fail("goes with a \"character\" only, a file says everything itself");
            });
            at.attempt("file", [&](const JsonValue& file) {
                def = std::make_shared<RagdollDef>(readRagdoll(referencedDocument(file)));
            });
        } else {
            at.attempt("character", [&](const JsonValue& character) {
                def = std::make_shared<RagdollDef>(ragdollFromCharacter(character, in.options, scene_.warnings));
            });
        }
        return def;
    }

    /// Of an optional entry whose file is not there nothing is made, nor of what refers to it.
    void needFile(bool optional, const JsonValue& at, const char* key) {
        if (!optional || !at.has(key) || at.at(key).isWrong()) return;
        const std::string why = whyAbsent(at.at(key));
        if (why.empty()) return;
        scene_.warnings.push_back("left out, since it is optional: " + why);
        throw Faults::Consequence();
    }

    void add(const RagdollInScene& in, const JsonValue& at) {
        needFile(in.optional, at, in.character.empty() ? "file" : "character");
        std::shared_ptr<const RagdollDef> def;
        at.attempt([&] { def = definition(in, at); });
        needRight(at);
        const fs::path character = in.character.empty() ? fs::path() : assetFile(at.at("character"));
        if (!character.empty()) scene_.files.push_back(character);
        const std::vector<SceneBlow> blows =
            in.blows.empty() ? std::vector<SceneBlow>{} : blowsOf(in.blows, *def, at.at("blows"));
        if (in.puppet) needStanding(*def, at.at("puppet"));
        if (!in.pose.empty()) at.attempt("pose", [&](const JsonValue& pose) { needParts(*def, in.pose, pose); });
        needRight(at);
        auto poses = posesOf(in.grid, poseOf(in.place), at);
        // The origin of a person is between the feet; tumbling turns about the middle.
        const Vec3 middle = middleOf(*def), upright = rotate(poseOf(in.place).rotation, middle);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            if (in.standing && !in.puppet && in.pose.empty())
                poses[i].position.y -= static_cast<double>(lowestPointOf(*def, poses[i].rotation));
            if (in.grid.tumble) poses[i].position = poses[i].position + (upright - rotate(poses[i].rotation, middle));
            const std::string name = memberName(in.name, i, poses.size());
            scene_.ragdolls.push_back({name, def, poses[i], in.puppet, in.pose, blows, in.velocity, character});
        }
    }

    void add(const RobotInScene& in, const JsonValue& at) {
        needFile(in.optional, at, "file");
        std::shared_ptr<const Robot> robot;
        at.attempt("file", [&](const JsonValue& file) {
            robot = std::make_shared<const Robot>(robotFromFile(file, scene_.warnings));
            scene_.files.push_back(assetFile(file));
        });
        needRight(at);
        auto poses = posesOf(in.grid, poseOf(in.place), at);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            if (in.standing) poses[i].position.y -= static_cast<double>(lowestPointOf(*robot, poses[i].rotation));
            scene_.robots.push_back(
                {memberName(in.name, i, poses.size()), robot, poses[i], in.holding, in.selfCollision});
        }
    }

    void add(const ClothInScene& in, const JsonValue& at) {
        SceneCloth cloth{in.name, {}, poseOf(in.place), {}, in.wind, in.velocity, colorOf(in, at)};
        at.attempt([&] { cloth.def = clothOf(in, at); });
        needRight(at);
        for (std::size_t i = 0; i < in.holds.size(); ++i) {
            const JsonValue hold = at.at("holds").at(i);
            const Hold to = holdNamed(in.holds[i].to, hold, "to");
            hold.attempt([&] {
                for (const int point : heldPoints(in, in.holds[i], cloth.def.points.size(), hold))
                    cloth.holds.push_back({point, to.body, to.part});
            });
        }
        needRight(at);
        scene_.cloths.push_back(std::move(cloth));
    }

    /// Of one in a grid.
    static std::string memberName(const std::string& name, std::size_t i, std::size_t count) {
        return count == 1 || name.empty() ? name : fmt::format("{} {}", name, i + 1);
    }

    JsonValue file_;
    const Chain& chain_;
    LeftOut left_;
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
    Json value = parsedOrDiscarded(text);
    return value.is_discarded() ? Json(text) : value;
}

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides, Chain chain) {
    JsonDocument document = loadExtended(path);
    chain.push_back(fs::weakly_canonical(path));
    for (const SceneOverride& one : overrides) setOverride(document, one, parseOverride(one.value));
    static const DocumentSchema schema(sceneSchema());
    Faults faults(document);
    findFaults(document, schema, faults);
    if (!document.root().is_object()) faults.throwIfAny();
    Scene scene = SceneBuilder(document, chain, faults).build();
    faults.throwIfAny();
    scene.warnings = counted(scene.warnings);
    scene.name = path.stem().string();
    scene.files.insert(scene.files.begin(), document.files().begin(), document.files().end());
    return scene;
}

}  // namespace

Scene loadScene(const fs::path& path, std::span<const SceneOverride> overrides) {
    return loadScene(path, overrides, Chain{});
}

}  // namespace ragtop
