#include "described_file.h"
#include "joint_json.h"
#include "ragtop/scene_tuning.h"
#include "scene_file.h"

namespace ragtop {
namespace {

Json write(const Pose& pose) { return {writeValue(pose.position), writeValue(pose.rotation)}; }

Json write(const ShapeDef& shape) {
    return {writeShape(shape.geometry),
            writeValue(shape.frame),
            writeValue(shape.density),
            writeValue(shape.filter),
            shape.sensor,
            shape.reportsMotion};
}

Json write(const SceneBody& body) {
    Json json = writeValue(body.def);
    json["name"] = body.name;
    json["type"] = writeValue(body.def.type);
    json["pose"] = write(body.def.pose);
    json["material"] = body.material;
    json["masonry"] = body.masonry;
    if (body.color) json["color"] = *body.color;
    for (const ShapeDef& shape : body.def.shapes) json["shapes"].push_back(write(shape));
    return json;
}

Json write(int body, const ScenePart& part) { return {body, static_cast<int>(part.owner), part.index, part.part}; }

Json write(const JointDef& joint) {
    Json json = Json::object();
    writeJointKind(joint, json);
    const JointBodies& ends = std::visit([](const auto& kind) -> const JointBodies& { return kind.bodies; }, joint);
    json["frames"] = {writeValue(ends.frameA), writeValue(ends.frameB), ends.collide};
    return json;
}

Json write(const CouplingDef& coupling, std::size_t parts) {
    Json json{{"sum", writeValue(coupling.sum)}};
    for (std::size_t i = 0; i < parts; ++i) json["parts"].push_back(writeValue(coupling.parts[i]));
    return json;
}

Json write(const SceneJoint& joint) {
    Json json = write(joint.def);
    json["a"] = write(joint.bodyA, joint.partA);
    json["b"] = write(joint.bodyB, joint.partB);
    return json;
}

Json write(const SceneCoupling& coupling) {
    Json json = write(coupling.def, coupling.joints.size());
    json["joints"] = coupling.joints;
    return json;
}

Json write(const Robot& robot) {
    Json json = Json::object();
    for (const RobotBody& body : robot.bodies) {
        const Mat3& inertia = body.mass.inertia;
        Json one{writeValue(body.pose),  body.anchored,          body.mass.mass,        writeValue(body.mass.center),
                 writeValue(inertia.cx), writeValue(inertia.cy), writeValue(inertia.cz)};
        for (const ShapeDef& shape : body.shapes) one.push_back(write(shape));
        json["bodies"].push_back(std::move(one));
    }
    for (const RobotJoint& joint : robot.joints) {
        json["joints"].push_back({joint.parent, joint.child, write(joint.joint), writeValue(joint.effort)});
    }
    for (const RobotCoupling& each : robot.couplings)
        json["couplings"].push_back({each.joints, write(each.coupling, each.joints.size())});
    return json;
}

Json write(const SceneAnimation& animation) {
    const AnimatedBodyDef& def = animation.def;
    Json json{animation.body,           animation.carrier,         def.loops,
              writeValue(def.maxForce), writeValue(def.maxTorque), static_cast<int>(def.whenBlocked),
              writeValue(def.patience)};
    for (const AnimationKey& key : def.keys) json.push_back({key.time, write(key.pose)});
    return json;
}

Json write(const SceneVehicle& vehicle) {
    Json json = writeValue(vehicle.def);
    const VehiclePlacement& place = vehicle.placement;
    json["placement"] = {writeValue(place.position), writeValue(place.heading), writeValue(place.speed)};
    for (const DriverAction& action : vehicle.script) {
        json["script"].push_back(writeValue(ActionInFile{action.time, action.input}));
    }
    if (vehicle.driver) json["driver"] = {vehicle.driver->road, writeValue(vehicle.driver->speed)};
    return json;
}

Json write(const SceneCloth& cloth) {
    Json json{writeValue(cloth.def), write(cloth.placement), writeValue(cloth.velocity)};
    for (const Vec3& point : cloth.def.points) json.push_back(writeValue(point));
    json.push_back({cloth.def.faces.size(), cloth.def.lines.size()});
    for (const SceneClothHold& hold : cloth.holds) json.push_back({hold.point, write(hold.body, hold.part)});
    return json;
}

/// Everything but the names of the scene and what its vehicles, ragdolls and robots are made from.
Json write(const Scene& scene) {
    Json json{
        {"step", scene.step}, {"settings", writeValue(scene.settings)}, {"materials", writeValue(scene.materials)}};
    for (const SceneBody& body : scene.bodies) json["bodies"].push_back(write(body));
    for (const SceneJoint& joint : scene.joints) json["joints"].push_back(write(joint));
    for (const SceneCoupling& coupling : scene.couplings) json["couplings"].push_back(write(coupling));
    for (const SceneAnimation& animation : scene.animated) json["animated"].push_back(write(animation));
    for (const SceneVehicle& vehicle : scene.vehicles) json["vehicles"].push_back(write(vehicle));
    for (const SceneCloth& cloth : scene.cloths) json["cloths"].push_back(write(cloth));
    const RagdollDef* last = nullptr;
    for (const SceneRagdoll& ragdoll : scene.ragdolls) {
        Json one{write(ragdoll.placement), writeValue(ragdoll.velocity), ragdoll.puppet};
        one.push_back(writeValue(ragdoll.pose));
        for (const SceneBlow& blow : ragdoll.blows) one.push_back({blow.time, blow.part, writeValue(blow.impulse)});
        if (ragdoll.def.get() != last) one.push_back(writeRagdoll(*ragdoll.def));
        last = ragdoll.def.get();
        json["ragdolls"].push_back(std::move(one));
    }
    const Robot* lastRobot = nullptr;
    for (const SceneRobot& robot : scene.robots) {
        Json one{write(robot.placement), robot.holding, robot.selfCollision};
        if (robot.robot.get() != lastRobot) one.push_back(write(*robot.robot));
        lastRobot = robot.robot.get();
        json["robots"].push_back(std::move(one));
    }
    return json;
}

}  // namespace

bool sameStructure(const Scene& a, const Scene& b) {
    std::vector<TunedValue> ofB;
    for (const TunableField& field : tunablesOf(b)) ofB.emplace_back(field.path, field.value);
    if (ofB.size() != tunablesOf(a).size()) return false;
    Scene tuned = a;
    try {
        tune(tuned, ofB);
    } catch (const TuneError&) {
        return false;
    }
    return write(tuned) == write(b);
}

}  // namespace ragtop
