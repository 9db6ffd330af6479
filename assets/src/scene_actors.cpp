#include "scene_actors.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "ragtop/body_pose.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

template <class Timed>
void needRising(const std::vector<Timed>& in, std::size_t i, const JsonValue& at, const char* what) {
    const double before = i == 0 ? 0 : in[i - 1].time;
    at.at(i).attempt([&] {
        if (in[i].time < before && !at.at(i).holdsWrong() && !at.at(i - 1).holdsWrong())
            at.at(i).fail(fmt::format("has the time {}, must not be before {} s, that of the {} before it", in[i].time,
                                      before, what));
    });
}

/// The place of a name among others; fails, and says what was meant, where it is none of them.
std::size_t oneOf(const std::vector<std::string>& names, const std::string& name, const char* what,
                  const JsonValue& at) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::string near = nearestName(name, names);
    at.fail(fmt::format("is {}, must name one of the {} {}{}", shown(at.json()), names.size(), what,
                        near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

}  // namespace

std::vector<DriverAction> scriptOf(const std::vector<ActionInFile>& in, const JsonValue& at) {
    std::vector<DriverAction> script;
    for (std::size_t i = 0; i < in.size(); ++i) {
        needRising(in, i, at, "action");
        script.push_back({in[i].time, in[i].input});
    }
    return script;
}

/// In a world of its own, which it takes to ask.
void needStanding(const RagdollDef& def, const JsonValue& at) {
    at.attempt([&] {
        try {
            World world;
            const Ragdoll ragdoll(world, def, standing(BodyAxes(def)));
            const Puppet puppet(world, ragdoll);
        } catch (const std::invalid_argument& error) {
            at.fail(fmt::format("is true, must be false for this body: {}", error.what()));
        }
    });
}

void needParts(const RagdollDef& def, const std::vector<PartAngles>& pose, const JsonValue& at) {
    try {
        const BodyAxes axes(def);
        for (std::size_t i = 0; i < pose.size(); ++i) {
            if (axes.find(pose[i].role, pose[i].side) < 0)
                at.at(i).fail("is " + shown(at.at(i).json()) +
                              ", must have the role and side of a part of the ragdoll");
        }
    } catch (const std::invalid_argument& error) {
        at.fail(std::string("goes with a body that can stand only: ") + error.what());
    }
}

/// With numbers of joints that are not made yet.
void needUsable(const SceneCoupling& coupling, const JsonValue& at) {
    CouplingDef def = coupling.def;
    for (std::size_t i = 0; i < coupling.joints.size(); ++i)
        def.parts[i].joint = {static_cast<std::uint32_t>(coupling.joints[i]), 1};
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) at.fail("is not usable: " + wrong);
}

int partNamed(const RagdollDef& def, const std::string& name, const JsonValue& at) {
    std::vector<std::string> names;
    for (const RagdollPart& part : def.parts) names.push_back(part.name);
    return static_cast<int>(oneOf(names, name, "parts of the ragdoll", at));
}

ScenePart partOfScene(const Scene& scene, const std::string& name, const LeftOut& left, const JsonValue& at) {
    const std::size_t slash = name.find('/');
    const std::string owner = name.substr(0, slash);
    std::vector<ScenePart> owners;
    const auto find = [&](const auto& all, ScenePart::Owner kind) {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].name == owner) owners.push_back({kind, static_cast<int>(i), 0});
    };
    if (slash == std::string::npos) {
        find(scene.vehicles, ScenePart::Owner::vehicle);
        if (owners.empty()) return {};
    } else {
        find(scene.ragdolls, ScenePart::Owner::ragdoll);
        find(scene.robots, ScenePart::Owner::robot);
    }
    if (owners.size() != 1) {
        if (left.mayHave(LeftOut::kBodies, owner)) throw Faults::Consequence();
        at.fail(
            fmt::format("is {}, must be a body, a vehicle, or a part of a ragdoll or robot, whose name is its alone",
                        shown(at.json())));
    }
    ScenePart part = owners[0];
    const auto index = static_cast<std::size_t>(part.index);
    if (part.owner == ScenePart::Owner::ragdoll) {
        part.part = partNamed(*scene.ragdolls[index].def, name.substr(slash + 1), at);
    } else if (part.owner == ScenePart::Owner::robot) {
        const Robot& robot = *scene.robots[index].robot;
        std::vector<std::string> names;
        for (const RobotLink& link : robot.links) names.push_back(link.name);
        part.part = robot.links[oneOf(names, name.substr(slash + 1), "links of the robot", at)].body;
    }
    return part;
}

std::vector<SceneBlow> blowsOf(const std::vector<BlowInFile>& in, const RagdollDef& def, const JsonValue& at) {
    std::vector<SceneBlow> blows;
    for (std::size_t i = 0; i < in.size(); ++i) {
        needRising(in, i, at, "blow");
        SceneBlow blow{in[i].time, 0, in[i].impulse};
        at.at(i).attempt("part", [&](const JsonValue& name) { blow.part = partNamed(def, in[i].part, name); });
        blows.push_back(blow);
    }
    return blows;
}

Pose placeOf(const Scene& scene, const ScenePart& part) {
    const auto index = static_cast<std::size_t>(part.index), one = static_cast<std::size_t>(part.part);
    switch (part.owner) {
        case ScenePart::Owner::ragdoll: {
            const SceneRagdoll& ragdoll = scene.ragdolls[index];
            if (!ragdoll.isPosed()) return ragdoll.placement * ragdoll.def->parts[one].bind;
            const auto bone = static_cast<std::size_t>(ragdoll.def->parts[one].bone);
            return standing(BodyAxes(*ragdoll.def), ragdoll.placement, ragdoll.pose)[bone];
        }
        case ScenePart::Owner::robot:
            return scene.robots[index].placement * scene.robots[index].robot->bodies[one].pose;
        case ScenePart::Owner::vehicle: {
            const VehiclePlacement& place = scene.vehicles[index].placement;
            return {place.position, rotationAbout({0, 1, 0}, place.heading)};
        }
        case ScenePart::Owner::none:
            break;
    }
    return {};
}

}  // namespace ragtop
