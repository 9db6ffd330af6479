#include "ragtop/ragdoll_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>
#include <system_error>

#include "described_file.h"
#include "joint_json.h"
#include "role_names.h"

namespace ragtop {

namespace {

struct BoneInFile {
    std::string name, parent, part;
    Frame inPart;
};
struct PartInFile {
    RagdollPart part{};
    std::string bone;
};
struct JointInFile {
    std::string parent, child;
    Frame frameA, frameB;
    bool collide = false;
    std::optional<float> breakForce, breakTorque;
};
struct PairInFile {
    std::string a, b;
};
struct RagdollInFile {
    int version = 1;
    std::string note;
    std::vector<BoneInFile> bones;
    std::vector<PartInFile> parts;
    std::vector<JointInFile> joints;
    bool selfCollision = true;
    std::vector<PairInFile> ignored;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BoneInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "parent", .meaning = "an earlier bone; the root has none"}, self.parent);
    visit(Tunable{.name = "part", .meaning = "the part that carries it"}, self.part);
    visit(Tunable{.name = "inPart", .meaning = "the bone in the bone of its part"}, self.inPart);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PartInFile*) {
    visit(Tunable{.name = "name"}, self.part.name);
    visit(Tunable{.name = "role"}, self.part.role);
    visit(Tunable{.name = "side"}, self.part.side);
    visit(Tunable{.name = "bone", .meaning = "the bone it moves with"}, self.bone);
    visit(Tunable{.name = "bind", .meaning = "that bone at rest, in model space"}, self.part.bind);
    visit(Tunable{.name = "shape"}, self.part.shape);
    visit(Tunable{.name = "frame", .meaning = "the shape in the bone"}, self.part.frame);
    describe(visit, self.part, static_cast<const RagdollPart*>(nullptr));
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const JointInFile*) {
    visit(Tunable{.name = "parent", .meaning = "name of a part"}, self.parent);
    visit(Tunable{.name = "child", .meaning = "name of a part"}, self.child);
    visit(Tunable{.name = "frameA", .meaning = "the joint in the parent's bone; x is hinge and twist axis"},
          self.frameA);
    visit(Tunable{.name = "frameB", .meaning = "the joint in the child's bone"}, self.frameB);
    visit(Tunable{.name = "collide", .meaning = "do the two parts collide with each other?"}, self.collide);
    visit(Tunable{"breakForce", "N", 1e-6, 1e12, "force beyond which it breaks"}, self.breakForce);
    visit(Tunable{"breakTorque", "N m", 1e-6, 1e12, "torque beyond which it breaks"}, self.breakTorque);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PairInFile*) {
    visit(Tunable{.name = "a", .meaning = "name of a part"}, self.a);
    visit(Tunable{.name = "b", .meaning = "name of another"}, self.b);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RagdollInFile*) {
    visit(Tunable{.name = "version", .minimum = 1, .maximum = 1}, self.version);
    visit(Tunable{.name = "note"}, self.note);
    visit(Tunable{.name = "bones"}, self.bones);
    visit(Tunable{.name = "parts"}, self.parts);
    visit(Tunable{.name = "joints"}, self.joints);
    visit(Tunable{.name = "selfCollision", .meaning = "do parts collide that are neither joined nor ignored?"},
          self.selfCollision);
    visit(Tunable{.name = "ignored", .meaning = "pairs of parts that pass through each other"}, self.ignored);
}

std::vector<const char*> requiredFields(const BoneInFile*) { return {"name", "part"}; }
std::vector<const char*> requiredFields(const PartInFile*) { return {"name", "bone", "shape", "mass"}; }
std::vector<const char*> requiredFields(const JointInFile*) { return {"parent", "child"}; }
std::vector<const char*> requiredFields(const PairInFile*) { return {"a", "b"}; }
std::vector<const char*> requiredFields(const RagdollInFile*) { return {"bones", "parts", "joints"}; }

Json ragdollSchema() {
    Json schema = objectSchema(RagdollInFile{});
    addJointKinds(schema["properties"]["joints"]["items"]);
    return schema;
}

/// The index of the first thing of that name in `all`; `from` is the value that holds the name.
template <class T, class Name>
int indexOf(const JsonValue& from, const std::vector<T>& all, Name name, const char* what) {
    const std::string wanted = from.json().get<std::string>();
    std::vector<std::string> names;
    for (const T& one : all) {
        if (name(one) == wanted) return static_cast<int>(names.size());
        names.push_back(name(one));
    }
    const std::string near = nearestName(wanted, names);
    from.fail(fmt::format("is {}, must be the name of one of the {} {}{}", shown(from.json()), names.size(), what,
                          near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

/// Whether all that is in a list has a name that can be read.
bool hasNames(const JsonValue& file, const char* key) {
    if (!file.has(key) || file.at(key).isWrong()) return false;
    for (std::size_t i = 0; i < file.at(key).size(); ++i) {
        const JsonValue one = file.at(key).at(i);
        if (!one.has("name") || one.at("name").isWrong()) return false;
    }
    return true;
}

/// Fills a RagdollDef from what is right in a file; names are looked up among all that is there.
class RagdollReader {
public:
    RagdollReader(const JsonValue& file, const RagdollInFile& in)
        : file_(file), in_(in), bonesNamed_(hasNames(file, "bones")), partsNamed_(hasNames(file, "parts")) {}

    RagdollDef read() && {
        def_.note = in_.note;
        for (std::size_t i = 0; i < in_.bones.size(); ++i) addBone(in_.bones[i], file_.at("bones").at(i));
        for (std::size_t i = 0; i < in_.parts.size(); ++i) addPart(in_.parts[i], file_.at("parts").at(i));
        for (std::size_t i = 0; i < in_.joints.size(); ++i) addJoint(in_.joints[i], file_.at("joints").at(i));
        def_.selfCollision = in_.selfCollision;
        for (std::size_t i = 0; i < in_.ignored.size(); ++i) {
            const JsonValue at = file_.at("ignored").at(i);
            RagdollPair& pair = def_.ignored.emplace_back();
            findPart(at, "a", pair.first);
            findPart(at, "b", pair.second);
        }
        return std::move(def_);
    }

private:
    void addBone(const BoneInFile& in, const JsonValue& at) {
        RagdollBone bone{in.name, -1, -1, in.inPart};
        if (!in.parent.empty()) findBone(at, "parent", "earlier bones", bone.parent);
        findPart(at, "part", bone.part);
        def_.bones.push_back(std::move(bone));
    }

    void addPart(const PartInFile& in, const JsonValue& at) {
        RagdollPart part = in.part;
        findBone(at, "bone", "bones", part.bone);
        def_.parts.push_back(std::move(part));
    }

    void addJoint(const JointInFile& in, const JsonValue& at) {
        RagdollJoint joint;
        findPart(at, "parent", joint.parent);
        findPart(at, "child", joint.child);
        at.attempt([&] {
            joint.joint = readJointKind(at);
            if (turnsOften(joint.joint)) at.fail("turns more than once round, must not: its angles are radians");
        });
        std::visit(
            [&](auto& kind) {
                kind.bodies.frameA = in.frameA;
                kind.bodies.frameB = in.frameB;
                kind.bodies.collide = in.collide;
                kind.bodies.breakForce = in.breakForce.value_or(kNoForceLimit);
                kind.bodies.breakTorque = in.breakTorque.value_or(kNoForceLimit);
            },
            joint.joint);
        def_.joints.push_back(std::move(joint));
    }

    void findBone(const JsonValue& at, const char* key, const char* what, int& index) const {
        at.attempt(key, [&](const JsonValue& name) {
            if (!bonesNamed_) throw Faults::Consequence();
            index = indexOf(
                name, def_.bones, [](const RagdollBone& bone) { return bone.name; }, what);
        });
    }

    void findPart(const JsonValue& at, const char* key, int& index) const {
        at.attempt(key, [&](const JsonValue& name) {
            if (!partsNamed_) throw Faults::Consequence();
            index = indexOf(
                name, in_.parts, [](const PartInFile& part) { return part.part.name; }, "parts");
        });
    }

    JsonValue file_;
    const RagdollInFile& in_;
    bool bonesNamed_, partsNamed_;
    RagdollDef def_;
};

}  // namespace

RagdollDef readRagdoll(const JsonDocument& document) {
    static const DocumentSchema schema(ragdollSchema());
    Faults faults(document);
    findFaults(document, schema, faults);
    const JsonValue file(document, &faults);
    RagdollInFile in;
    readValue(file, in);
    RagdollDef def = RagdollReader(file, in).read();
    faults.throwIfAny();
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) failInvalid(document, wrong);
    return def;
}

RagdollDef loadRagdoll(const std::filesystem::path& path) { return readRagdoll(loadExtended(path)); }

Json writeRagdoll(const RagdollDef& def) {
    RagdollInFile out;
    out.note = def.note;
    out.selfCollision = def.selfCollision;
    const auto part = [&](int i) { return def.parts[static_cast<std::size_t>(i)].name; };
    const auto bone = [&](int i) { return i < 0 ? std::string() : def.bones[static_cast<std::size_t>(i)].name; };
    for (const RagdollBone& b : def.bones) out.bones.push_back({b.name, bone(b.parent), part(b.part), b.inPart});
    for (const RagdollPart& p : def.parts) out.parts.push_back({p, bone(p.bone)});
    for (const RagdollPair& pair : def.ignored) out.ignored.push_back({part(pair.first), part(pair.second)});
    for (const RagdollJoint& j : def.joints) {
        const JointBodies& bodies =
            std::visit([](const auto& kind) -> const JointBodies& { return kind.bodies; }, j.joint);
        const auto bound = [](float most) { return most < kNoForceLimit ? std::optional(most) : std::nullopt; };
        out.joints.push_back({part(j.parent), part(j.child), bodies.frameA, bodies.frameB, bodies.collide,
                              bound(bodies.breakForce), bound(bodies.breakTorque)});
    }
    Json json = writeValue(out);
    for (std::size_t i = 0; i < def.joints.size(); ++i) writeJointKind(def.joints[i].joint, json["joints"][i]);
    return json;
}

void saveRagdoll(const RagdollDef& def, const std::filesystem::path& path) {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) {
        throw AssetError(path.string() + ": is not written, the ragdoll is not usable: " + wrong);
    }
    writeJson(writeRagdoll(def), path);
}

RagdollDef saveEditableRagdoll(const RagdollDef& fitted, const std::filesystem::path& path) {
    constexpr std::string_view kEnd = ".ragdoll.json";
    const std::string name = path.filename().string();
    if (!name.ends_with(kEnd) || name.size() == kEnd.size())
        throw AssetError(path.string() + ": must end with " + std::string(kEnd));
    const std::string base = name.substr(0, name.size() - kEnd.size()) + ".fitted" + std::string(kEnd);
    saveRagdoll(fitted, path.parent_path() / base);
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
        std::ofstream out(path, std::ios::binary);
        out << "// Changes to " << base << ", which is written anew whenever the model is imported; these stay.\n"
            << "// Name what shall differ: parts by their name, joints by that of the part which they carry, as in\n"
            << "//   \"parts\": {\"head\": {\"mass\": 5, \"material\": {\"friction\": 0.4}}},\n"
            << "//   \"joints\": {\"head\": {\"ball\": {\"swingLimit\": 0.6}}}\n"
            << "// Masses are in kg, lengths in m, angles in rad; the other file has all that can be named.\n"
            << "{\n  \"extends\": " << Json(base).dump() << ",\n  \"parts\": {},\n  \"joints\": {}\n}\n";
        if (!out.flush()) throw AssetError(path.string() + ": cannot be written");
    }
    return loadRagdoll(path);
}

}  // namespace ragtop
