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

/// With numbers of joints that are not made yet.
void needUsable(const SceneCoupling& coupling, const JsonValue& at) {
    CouplingDef def = coupling.def;
    for (std::size_t i = 0; i < coupling.joints.size(); ++i)
        def.parts[i].joint = {static_cast<std::uint32_t>(coupling.joints[i]), 1};
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) at.fail("is not usable: " + wrong);
}

int partNamed(const RagdollDef& def, const std::string& name, const JsonValue& at) {
    const auto found =
        std::find_if(def.parts.begin(), def.parts.end(), [&](const RagdollPart& part) { return part.name == name; });
    if (found != def.parts.end()) return static_cast<int>(found - def.parts.begin());
    std::vector<std::string> names;
    for (const RagdollPart& part : def.parts) names.push_back(part.name);
    const std::string near = nearestName(name, names);
    at.fail(fmt::format("is {}, must name one of the {} parts of the ragdoll{}", shown(at.json()), names.size(),
                        near.empty() ? "" : "; did you mean \"" + near + "\"?"));
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

Pose placeOf(const SceneRagdoll& ragdoll, int part) {
    const RagdollPart& one = ragdoll.def->parts[static_cast<std::size_t>(part)];
    if (!ragdoll.puppet) return ragdoll.placement * one.bind;
    return standing(BodyAxes(*ragdoll.def), ragdoll.placement)[static_cast<std::size_t>(one.bone)];
}

}  // namespace ragtop
