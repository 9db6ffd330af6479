#include "ragtop/scene_tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "joint_json.h"
#include "ragtop/world.h"
#include "schema.h"

namespace ragtop {
namespace {

/// Names of things that are not tuned while they run: structure, and the caller's names.
bool isStructure(const TunableField& field) { return field.label == "axle" || field.label == "surface"; }

/// The name, where no other has it, else the number.
template <class T, class NameOf>
std::string keyOf(const std::vector<T>& all, std::size_t i, NameOf nameOf) {
    const std::string name = nameOf(all[i]);
    const auto count = std::count_if(all.begin(), all.end(), [&](const T& one) { return nameOf(one) == name; });
    return name.empty() || count > 1 ? std::to_string(i) : name;
}

/// Ragdolls or robots of one definition.
template <class Def>
struct Shared {
    std::string name;
    std::vector<std::size_t> members;
    Def def;
};

/// `defOf` gives the definition that one shares with others.
template <class T, class DefOf>
auto kindsOf(const std::vector<T>& all, DefOf defOf) {
    using Def = std::remove_cvref_t<decltype(*defOf(all[0]))>;
    std::vector<Shared<Def>> kinds;
    std::map<const Def*, std::size_t> known;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto [found, isNew] = known.try_emplace(defOf(all[i]).get(), kinds.size());
        if (isNew) kinds.push_back({all[i].name, {}, *defOf(all[i])});
        kinds[found->second].members.push_back(i);
    }
    // Those of a grid are called "person 1", "person 2" ...
    for (Shared<Def>& kind : kinds) {
        if (kind.members.size() > 1 && kind.name.ends_with(" 1")) kind.name.resize(kind.name.size() - 2);
    }
    return kinds;
}

/// Gives those that were tuned what they are now, one for all of a kind. `put` takes a number and the definition.
template <class Def, class Put>
void putKinds(const std::vector<Shared<Def>>& kinds, const std::vector<std::size_t>& tuned, Put put) {
    for (const Shared<Def>& kind : kinds) {
        if (std::find(tuned.begin(), tuned.end(), kind.members[0]) == tuned.end()) continue;
        const auto def = std::make_shared<const Def>(kind.def);
        for (const std::size_t i : kind.members) put(i, def);
    }
}

/// What may change of a cloth while it moves.
struct ClothTuning {
    Vec3 wind{};
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ClothTuning*) {
    visit(Tunable{"wind", "m/s", -1000, 1000, "in which it is"}, self.wind);
}

std::string whyInvalidJoints(const Robot& robot) {
    for (const RobotJoint& joint : robot.joints)
        if (const std::string why = whyInvalidKind(joint.joint); !why.empty()) return joint.name + ": " + why;
    return {};
}

/// Copies of all that may be tuned, the references to their fields, and what puts them back into the scene.
class Parts {
public:
    explicit Parts(const Scene& scene)
        : settings_(scene.settings),
          materials_(scene.materials),
          ragdolls_(kindsOf(scene.ragdolls, [](const SceneRagdoll& one) { return one.def; })),
          robots_(kindsOf(scene.robots, [](const SceneRobot& one) { return one.robot; })) {
        for (const SceneJoint& joint : scene.joints) joints_.push_back(joint.def);
        for (const SceneVehicle& vehicle : scene.vehicles) vehicles_.push_back(vehicle.def);
        for (const SceneCloth& cloth : scene.cloths) cloths_.push_back({cloth.wind});
        collect(scene);
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    std::vector<TunableRef>& refs() { return refs_; }

    /// The place of a path among refs().
    std::size_t find(const std::string& path) const {
        const auto found = index_.find(path);
        if (found != index_.end()) return found->second;
        std::vector<std::string> names;
        for (const TunableRef& ref : refs_) names.push_back(ref.field.path);
        const std::string near = nearestName(path, names);
        throw TuneError(path, fmt::format("\"{}\" is none of the {} tunables{}", path, names.size(),
                                          near.empty() ? "" : "; did you mean \"" + near + "\"?"));
    }

    /// Those to which these references belong. Throws TuneError where one of them is not usable as a whole.
    TunedParts checked(const std::set<std::size_t>& touched) const {
        TunedParts tuned;
        for (const Part& part : parts_) {
            const auto first = touched.lower_bound(part.first);
            if (first == touched.end() || *first >= part.first + part.count) continue;
            if (const std::string why = part.whyInvalid(); !why.empty()) {
                throw TuneError(refs_[*first].field.path, part.path + ": " + why);
            }
            part.note(tuned);
        }
        return tuned;
    }

    void commit(const TunedParts& tuned, Scene& scene) const {
        if (tuned.settings) scene.settings = settings_;
        for (const std::string& name : tuned.materials) scene.materials[name] = materials_.at(name);
        for (SceneBody& body : scene.bodies) {
            if (std::find(tuned.materials.begin(), tuned.materials.end(), body.material) == tuned.materials.end())
                continue;
            for (ShapeDef& shape : body.def.shapes) shape.material = materials_.at(body.material);
        }
        for (const std::size_t i : tuned.joints) scene.joints[i].def = joints_[i];
        for (const std::size_t i : tuned.vehicles) scene.vehicles[i].def = vehicles_[i];
        putKinds(ragdolls_, tuned.ragdolls, [&](std::size_t i, const auto& def) { scene.ragdolls[i].def = def; });
        putKinds(robots_, tuned.robots, [&](std::size_t i, const auto& def) { scene.robots[i].robot = def; });
        for (const std::size_t i : tuned.cloths) scene.cloths[i].wind = cloths_[i].wind;
    }

private:
    struct Part {
        std::string path;
        std::size_t first, count;
        std::function<std::string()> whyInvalid;
        std::function<void(TunedParts&)> note;
    };

    void collect(const Scene& scene) {
        add(
            "settings", [&](const std::string& path) { addTunables(settings_, path, "world", refs_); },
            [this] { return whyInvalid(settings_); }, [](TunedParts& tuned) { tuned.settings = true; });
        for (auto& item : materials_) {
            const std::string& name = item.first;
            Material& material = item.second;
            add(
                "materials." + name,
                [&](const std::string& path) { addTunables(material, path, "materials / " + name, refs_); },
                [&material] { return whyInvalid(material); },
                [&name](TunedParts& tuned) { tuned.materials.push_back(name); });
        }
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const std::string name = keyOf(scene.joints, i, [](const SceneJoint& joint) { return joint.name; });
            add(
                "joints." + name, [&](const std::string& path) { addJoint(joints_[i], path, "joints / " + name); },
                [this, i] { return whyInvalidKind(joints_[i]); },
                [i](TunedParts& tuned) { tuned.joints.push_back(i); });
        }
        for (std::size_t i = 0; i < vehicles_.size(); ++i) {
            const std::string name = keyOf(scene.vehicles, i, [](const SceneVehicle& vehicle) { return vehicle.name; });
            add(
                "vehicles." + name,
                [&](const std::string& path) { addVehicle(vehicles_[i], path, named("vehicle", name)); },
                [this, i] { return whyInvalid(vehicles_[i]); },
                [i](TunedParts& tuned) { tuned.vehicles.push_back(i); });
        }
        for (std::size_t i = 0; i < ragdolls_.size(); ++i) {
            const std::string name = keyOf(ragdolls_, i, [](const Shared<RagdollDef>& kind) { return kind.name; });
            add(
                "ragdolls." + name,
                [&](const std::string& path) { addRagdoll(ragdolls_[i].def, path, named("ragdoll", name)); },
                [this, i] { return whyInvalid(ragdolls_[i].def); },
                [this, i](TunedParts& tuned) {
                    const auto& members = ragdolls_[i].members;
                    tuned.ragdolls.insert(tuned.ragdolls.end(), members.begin(), members.end());
                });
        }
        for (std::size_t i = 0; i < robots_.size(); ++i) {
            const std::string name = keyOf(robots_, i, [](const Shared<Robot>& kind) { return kind.name; });
            add(
                "robots." + name,
                [&](const std::string& path) { addRobot(robots_[i].def, path, named("robot", name)); },
                [this, i] { return whyInvalidJoints(robots_[i].def); },
                [this, i](TunedParts& tuned) {
                    const auto& members = robots_[i].members;
                    tuned.robots.insert(tuned.robots.end(), members.begin(), members.end());
                });
        }
        for (std::size_t i = 0; i < cloths_.size(); ++i) {
            const std::string name = keyOf(scene.cloths, i, [](const SceneCloth& cloth) { return cloth.name; });
            add(
                "cloths." + name,
                [&](const std::string& path) { addTunables(cloths_[i], path, named("cloth", name), refs_); },
                [] { return std::string(); }, [i](TunedParts& tuned) { tuned.cloths.push_back(i); });
        }
        for (std::size_t i = 0; i < refs_.size(); ++i) index_.emplace(refs_[i].field.path, i);
    }

    /// A number alone would say too little in a list.
    static std::string named(const char* kind, const std::string& key) {
        return key.find_first_not_of("0123456789") == std::string::npos ? std::string(kind) + " " + key : key;
    }

    template <class Fill>
    void add(const std::string& path, Fill fill, std::function<std::string()> why,
             std::function<void(TunedParts&)> note) {
        const std::size_t first = refs_.size();
        fill(path);
        const auto begin = refs_.begin() + static_cast<std::ptrdiff_t>(first);
        refs_.erase(std::remove_if(begin, refs_.end(), [](const TunableRef& ref) { return isStructure(ref.field); }),
                    refs_.end());
        parts_.push_back({path, first, refs_.size() - first, std::move(why), std::move(note)});
    }

    void addVehicle(VehicleDef& def, const std::string& path, const std::string& group) {
        const std::size_t first = refs_.size();
        addTunables(def, path, group, refs_);
        const std::string looks = path + ".visual.";
        const auto begin = refs_.begin() + static_cast<std::ptrdiff_t>(first);
        refs_.erase(std::remove_if(begin, refs_.end(),
                                   [&](const TunableRef& ref) { return ref.field.path.starts_with(looks); }),
                    refs_.end());
    }

    void addRagdoll(RagdollDef& def, const std::string& path, const std::string& group) {
        const auto partName = [](const RagdollPart& part) { return part.name; };
        for (std::size_t i = 0; i < def.parts.size(); ++i) {
            const std::string name = keyOf(def.parts, i, partName);
            addTunables(def.parts[i], path + ".parts." + name, group + " / parts / " + name, refs_);
        }
        for (RagdollJoint& joint : def.joints) {
            const std::string name = keyOf(def.parts, static_cast<std::size_t>(joint.child), partName);
            addJoint(joint.joint, path + ".joints." + name, group + " / joints / " + name);
        }
    }

    void addRobot(Robot& robot, const std::string& path, const std::string& group) {
        for (std::size_t i = 0; i < robot.joints.size(); ++i) {
            const std::string name = keyOf(robot.joints, i, [](const RobotJoint& joint) { return joint.name; });
            addJoint(robot.joints[i].joint, path + ".joints." + name, group + " / joints / " + name);
        }
    }

    void addJoint(JointDef& joint, const std::string& path, const std::string& group) {
        std::visit(
            [&](auto& kind) {
                const std::size_t first = refs_.size();
                addTunables(kind, path, group, refs_);
                // Without a spring there is nothing that its target and limit would change.
                if constexpr (requires { kind.spring; }) {
                    if (kind.spring) return;
                    const auto begin = refs_.begin() + static_cast<std::ptrdiff_t>(first);
                    const auto ofSpring = [](const TunableRef& ref) {
                        const std::string& label = ref.field.label;
                        return label == "target" || label == "rest" || label == "maxSpringTorque";
                    };
                    refs_.erase(std::remove_if(begin, refs_.end(), ofSpring), refs_.end());
                }
            },
            joint);
    }

    WorldSettings settings_;
    std::map<std::string, Material> materials_;
    std::vector<JointDef> joints_;
    std::vector<VehicleDef> vehicles_;
    std::vector<Shared<RagdollDef>> ragdolls_;
    std::vector<Shared<Robot>> robots_;
    std::vector<ClothTuning> cloths_;
    std::vector<TunableRef> refs_;
    std::vector<Part> parts_;
    std::map<std::string, std::size_t> index_;
};

}  // namespace

std::vector<TunableField> tunablesOf(const Scene& scene) {
    Parts parts(scene);
    std::vector<TunableField> fields;
    for (TunableRef& ref : parts.refs()) fields.push_back(std::move(ref.field));
    return fields;
}

TunedParts tune(Scene& scene, std::span<const TunedValue> values) {
    Parts parts(scene);
    std::set<std::size_t> touched;
    for (const auto& [path, value] : values) {
        const std::size_t i = parts.find(path);
        if (const std::string why = whyInvalid(parts.refs()[i].field, value); !why.empty()) throw TuneError(path, why);
        parts.refs()[i].set(value);
        touched.insert(i);
    }
    const TunedParts tuned = parts.checked(touched);
    parts.commit(tuned, scene);
    return tuned;
}

namespace {

/// Between the bodies that it joins already.
void retune(World& world, JointId joint, JointDef def) {
    const auto bodiesOf = [](auto& kind) -> JointBodies { return kind.bodies; };
    const JointBodies bodies = std::visit(bodiesOf, world.def(joint));
    std::visit([&](auto& kind) { kind.bodies = bodies; }, def);
    world.setDef(joint, def);
}

void retune(World& world, const SceneRobot& robot, const RobotIds& ids) {
    for (std::size_t i = 0; i < ids.joints.size(); ++i)
        retune(world, ids.joints[i], robotJoint(robot.robot->joints[i], robot.options()));
}

}  // namespace

void apply(const Scene& scene, const TunedParts& parts, const RunningScene& to) {
    if (parts.settings) to.world->setSettings(scene.settings);
    for (std::size_t i = 0; i < to.bodies.size(); ++i) {
        const std::string& material = scene.bodies[i].material;
        if (std::find(parts.materials.begin(), parts.materials.end(), material) == parts.materials.end()) continue;
        for (const ShapeId shape : to.world->shapes(to.bodies[i])) {
            to.world->setMaterial(shape, scene.materials.at(material));
        }
    }
    for (const std::size_t i : parts.joints) retune(*to.world, to.joints[i], scene.joints[i].def);
    for (const std::size_t i : parts.vehicles) to.vehicles[i]->setDef(scene.vehicles[i].def);
    for (const std::size_t i : parts.ragdolls) to.ragdolls[i]->setDef(*scene.ragdolls[i].def);
    for (const std::size_t i : parts.robots) retune(*to.world, scene.robots[i], *to.robots[i]);
    for (const std::size_t i : parts.cloths) to.cloths[i]->setWind(scene.cloths[i].wind);
}

}  // namespace ragtop
