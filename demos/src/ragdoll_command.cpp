#include "ragdoll_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "borrowed_clips.h"
#include "json_text.h"
#include "ragtop/asset_error.h"
#include "ragtop/gltf_ragdoll.h"
#include "ragtop/pose.h"
#include "ragtop/ragdoll_file.h"

namespace ragtop::demos {
namespace {

std::string line(const RagdollFigure& figure) {
    return fmt::format("{:6} {:34} {:>11.4g} {} {:<8.4g} {}{}\n", figure.test, figure.name, figure.value,
                       figure.atLeast ? ">=" : "<=", figure.bound, figure.passes() ? "ok" : "FAILS",
                       figure.passes() || figure.where.empty() ? "" : "  (" + figure.where + ")");
}

std::string toJson(const RagdollCommand& command, const RagdollSubject& subject,
                   const std::vector<RagdollFigure>& figures) {
    std::string lines;
    for (const RagdollFigure& figure : figures)
        lines += fmt::format(
            "{}\n    {{\"test\": {}, \"name\": {}, \"value\": {}, \"{}\": {}, \"passes\": {}, \"where\": {}}}",
            lines.empty() ? "" : ",", jsonString(figure.test), jsonString(figure.name), jsonNumber(figure.value),
            figure.atLeast ? "least" : "most", jsonNumber(figure.bound), figure.passes(), jsonString(figure.where));
    const std::string body = subject.body.empty() ? "" : "  \"body\": " + subject.body + ",\n";
    return fmt::format("{{\n  \"asset\": {},\n{}  \"hz\": {},\n  \"seeds\": {},\n  \"figures\": [{}\n  ]\n}}\n",
                       jsonString(subject.name), body, jsonNumber(command.trial.hz), command.trial.seeds, lines);
}

/// What is tested afterwards is what the files say together.
void write(RagdollSubject& subject, const std::string& out) {
    const auto* fitted = std::get_if<RagdollDef>(&subject.def);
    if (!fitted) throw AssetError(out + ": is not written: " + subject.name + " is a robot, must be a character");
    if (out.ends_with(".gltf") || out.ends_with(".glb"))
        saveGltfRagdoll(*fitted, out);
    else
        subject.def = saveEditableRagdoll(*fitted, out);
    fmt::print("{}: {} parts\n", out, std::get<RagdollDef>(subject.def).parts.size());
}

void borrow(RagdollSubject& subject, const std::string& other) {
    const auto* def = std::get_if<RagdollDef>(&subject.def);
    if (!def) throw AssetError(subject.name + ": is a robot, must be a character or a ragdoll to borrow clips");
    if (subject.skeleton.bones.empty()) subject.skeleton = skeletonOf(*def);
    std::vector<Clip> clips = borrowClips(other, *def);
    subject.clips.insert(subject.clips.begin(), std::make_move_iterator(clips.begin()),
                         std::make_move_iterator(clips.end()));
}

}  // namespace

bool testRagdoll(const RagdollCommand& command) {
    RagdollSubject subject = loadRagdollSubject(command.asset);
    subject.holding = command.holding;
    if (!command.clips.empty()) borrow(subject, command.clips);
    if (command.out) write(subject, *command.out);
    std::vector<RagdollFigure> figures;
    for (const RagdollTest& test : ragdollTests()) {
        const bool asked = std::find(command.tests.begin(), command.tests.end(), test.name) != command.tests.end();
        if (!asked && (command.out || !command.tests.empty())) continue;
        for (RagdollFigure& figure : test.run(subject, command.trial)) {
            fmt::print("{}", line(figure));
            figures.push_back(std::move(figure));
        }
        std::fflush(stdout);
    }
    if (command.json) {
        std::ofstream file(*command.json);
        file << toJson(command, subject, figures);
        if (!file.flush()) throw AssetError(*command.json + ": cannot be written");
    }
    return std::all_of(figures.begin(), figures.end(), [](const RagdollFigure& figure) { return figure.passes(); });
}

}  // namespace ragtop::demos
