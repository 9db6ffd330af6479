#include <utility>

#include "described_file.h"
#include "gltf/physics_document.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

Json& ragtopExtras(Json& of) { return of["extras"]["ragtop"]; }

/// The merge patch [RFC 7396] that makes `to` of `from`; null where they are equal. Of objects without null members.
Json patchOf(const Json& from, const Json& to) {
    if (!from.is_object() || !to.is_object()) return from == to ? Json() : to;
    Json patch = Json::object();
    for (const auto& [key, value] : from.items())
        if (!to.contains(key)) patch[key] = nullptr;
    for (const auto& [key, value] : to.items()) {
        if (!from.contains(key)) {
            patch[key] = value;
        } else if (Json inner = patchOf(from[key], value); !inner.is_null()) {
            patch[key] = std::move(inner);
        }
    }
    return patch.empty() ? Json() : patch;
}

struct List {
    const char *name, *extra;
    std::vector<int> RagdollFromGltf::*nodes;
};
/// Lists of a ragdoll file, and the name of what `extras` of their nodes say.
constexpr List kLists[] = {{"parts", "part", &RagdollFromGltf::parts},
                           {"joints", "joint", &RagdollFromGltf::joints},
                           {"bones", "bone", &RagdollFromGltf::bones}};

}  // namespace

RagdollFromGltf readGltfRagdoll(const JsonDocument& gltf, const MeshPoints& points) {
    RagdollFromGltf read = readGltfPhysics(gltf, points);
    Json ragdoll = writeRagdoll(read.def);
    const auto extra = [](const Json& of, const char* name) {
        const Json::json_pointer at("/extras/ragtop/" + std::string(name));
        return of.contains(at) ? of.at(at) : Json();
    };
    bool changed = false;
    for (const List& list : kLists)
        for (std::size_t i = 0; i < (read.*list.nodes).size(); ++i) {
            const Json patch =
                extra(gltf.root().at("nodes").at(static_cast<std::size_t>((read.*list.nodes)[i])), list.extra);
            if (!patch.is_object() || patch.empty()) continue;
            ragdoll[list.name][i].merge_patch(patch);
            changed = true;
        }
    // Parts may have other names now.
    for (std::size_t i = 0; i < read.def.ignored.size(); ++i) {
        const RagdollPair& pair = read.def.ignored[i];
        for (const auto& [key, part] : {std::pair{"a", pair.first}, {"b", pair.second}})
            ragdoll["ignored"][i][key] = ragdoll["parts"][static_cast<std::size_t>(part)]["name"];
    }
    if (const Json note = extra(gltf.root(), "note"); note.is_string()) ragdoll["note"] = note, changed = true;
    if (!changed) return read;
    const std::string name = JsonValue(gltf).place().file + " with its extras";
    read.def = readRagdoll(JsonDocument::parse(ragdoll.dump(), name));
    return read;
}

void addExtras(Json& gltf, const RagdollDef& def, const std::string& file, const MeshPoints& points) {
    const RagdollFromGltf read = readGltfPhysics(JsonDocument::parse(gltf.dump(), file), points);
    const Json said = writeRagdoll(read.def), wanted = writeRagdoll(def);
    for (const List& list : kLists)
        for (std::size_t i = 0; i < (read.*list.nodes).size(); ++i) {
            Json patch = patchOf(said[list.name][i], wanted[list.name][i]);
            if (!patch.is_null())
                ragtopExtras(gltf["nodes"][static_cast<std::size_t>((read.*list.nodes)[i])])[list.extra] =
                    std::move(patch);
        }
    if (!def.note.empty()) ragtopExtras(gltf)["note"] = def.note;
}

}  // namespace ragtop
