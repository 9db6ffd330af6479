#include <fmt/format.h>

#include "described_file.h"
#include "joint_json.h"
#include "ragtop/scene.h"
#include "scene_file.h"

namespace ragtop {
namespace {

/// The one shape of a body, which stands where the body does; throws AssetError on any other.
Shape wholeShape(const BodyDef& def) {
    if (def.shapes.size() == 1 && lengthSquared(def.shapes[0].frame.position) == 0 &&
        def.shapes[0].frame.rotation == Quat{})
        return def.shapes[0].geometry;
    throw AssetError("a body of several shapes has no place in a scene file");
}

BodyInFile bodyInFile(const SceneBody& body, const std::string& name, const std::string& material) {
    BodyInFile in;
    in.name = name;
    in.material = material;
    in.type = body.def.type;
    in.shape = wholeShape(body.def);
    in.place = {body.def.pose.position, body.def.pose.rotation, 0};
    in.density = body.def.shapes[0].density;
    in.masonry = body.masonry;
    in.sensor = body.def.shapes[0].sensor;
    in.filter = body.def.shapes[0].filter;
    in.def = body.def;
    return in;
}

/// The name of a material, which is added where it is new.
std::string nameOf(const Material& material, std::vector<std::pair<std::string, Json>>& known) {
    const Json text = writeValue(material);
    for (const auto& [name, other] : known)
        if (other == text) return name;
    known.emplace_back(fmt::format("material {}", known.size() + 1), text);
    return known.back().first;
}

}  // namespace

void saveScene(const Scene& scene, const std::filesystem::path& path) {
    std::vector<std::pair<std::string, Json>> materials;
    const auto nameOfBody = [](int body) { return fmt::format("body {}", body); };
    Json bodies = Json::array(), joints = Json::array();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const SceneBody& body = scene.bodies[i];
        if (body.def.shapes.empty()) throw AssetError(fmt::format("body {} has no shape", i));
        const std::string material = nameOf(body.def.shapes[0].material, materials);
        bodies.push_back(writeValue(bodyInFile(body, nameOfBody(static_cast<int>(i)), material)));
        for (const char* field : {"color"}) bodies.back().erase(field);
    }
    for (const SceneJoint& joint : scene.joints) {
        if (joint.holdsPart())
            throw AssetError("joint \"" + joint.name + "\" holds a part of what has no place in a saved scene");
        const JointBodies& ends =
            std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
        const auto placed = [&](int body, const Frame& frame) {
            const Pose pose = body < 0 ? Pose{} : scene.bodies[static_cast<std::size_t>(body)].def.pose;
            return Pose{transformPoint(pose, frame.position), pose.rotation * frame.rotation};
        };
        const Pose a = placed(joint.bodyA, ends.frameA), b = placed(joint.bodyB, ends.frameB);
        SceneJointInFile in;
        in.name = joint.name;
        if (joint.bodyA >= 0) in.a = nameOfBody(joint.bodyA);
        if (joint.bodyB >= 0) in.b = nameOfBody(joint.bodyB);
        in.anchor = a.position;
        if (std::holds_alternative<DistanceDef>(joint.def)) in.anchorB = b.position;
        in.axis = rotate(a.rotation, Vec3{1, 0, 0});
        in.collide = ends.collide;
        Json object = writeValue(in);
        for (const char* field : {"name", "a", "b"})
            if (object[field] == "") object.erase(field);
        writeJointKind(joint.def, object);
        joints.push_back(std::move(object));
    }
    Json file = {{"description", scene.description}, {"settings", writeValue(scene.settings)},
                 {"step", writeNumber(scene.step)},  {"duration", writeNumber(scene.duration)},
                 {"materials", Json::object()},      {"bodies", std::move(bodies)},
                 {"joints", std::move(joints)}};
    for (const auto& [name, text] : materials) file["materials"][name] = text;
    writeJson(file, path);
}

}  // namespace ragtop
