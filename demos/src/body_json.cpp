#include "body_json.h"

#include <fmt/format.h>

#include "json_text.h"

namespace ragtop::demos {
namespace {

std::string place(const Vec3& p) { return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", p.x, p.y, p.z); }

}  // namespace

std::string bodyJson(const Character& character, const Anatomy& anatomy, const RagdollDef& ragdoll) {
    const auto nameOfBone = [&](int bone) {
        return bone < 0 ? "null" : jsonString(character.skeleton.bones[static_cast<std::size_t>(bone)].name);
    };
    const std::string roles = jsonList("roles", anatomy.segments, [&](const Segment& s) {
        return fmt::format("{{\"bone\": {}, \"index\": {}, \"role\": {}, \"side\": {}, \"confidence\": {:.3f}}}",
                           nameOfBone(s.bone), s.bone, jsonString(nameOf(s.role)), jsonString(nameOf(s.side)),
                           s.confidence);
    });
    const std::string bones = jsonList("bones", character.skeleton.bones, [&](const Bone& bone) {
        return fmt::format("{{\"name\": {}, \"parent\": {}, \"position\": {}}}", jsonString(bone.name), bone.parent,
                           place(bone.bind.position));
    });
    const std::string parts = jsonList("parts", ragdoll.parts, [&](const RagdollPart& part) {
        const double volume = static_cast<double>(massOf(part.shape, 1.0f).mass);
        return fmt::format("{{\"bone\": {}, \"role\": {}, \"mass\": {:.9g}, \"density\": {:.6g}}}",
                           nameOfBone(part.bone), jsonString(nameOf(part.role)), part.mass,
                           static_cast<double>(part.mass) / volume);
    });
    std::vector<std::string> warnings = character.warnings;
    if (!ragdoll.note.empty() && ragdoll.note != anatomy.note) warnings.push_back(ragdoll.note);
    const std::string warned = jsonList("warnings", warnings, [](const std::string& text) { return jsonString(text); });
    return fmt::format(
        "{{\n    \"plan\": {},\n    \"confidence\": {:.3f},\n    \"metersPerUnit\": {:.9g},\n    \"height\": {:.9g},\n"
        "{},\n{},\n{},\n{}\n  }}",
        jsonString(nameOf(anatomy.plan)), anatomy.confidence, character.metersPerUnit, character.height, roles, bones,
        parts, warned);
}

}  // namespace ragtop::demos
