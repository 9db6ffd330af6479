#include "ragdoll_subject.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "body_json.h"
#include "double_math.h"
#include "ragtop/character.h"
#include "ragtop/find_asset.h"
#include "ragtop/gltf_ragdoll.h"
#include "ragtop/ragdoll_file.h"

namespace ragtop::demos {
RagdollSubject loadRagdollSubject(const std::string& asset) {
    RagdollSubject subject;
    subject.name = std::filesystem::path(asset).filename().string();
    if (asset.ends_with(".ragdoll.json")) {
        subject.def = loadRagdoll(asset);
        return subject;
    }
    const std::filesystem::path path = findAsset(asset);
    if (path.extension() == ".urdf" || path.extension() == ".xml") {
        subject.def = loadRobot(path);
        return subject;
    }
    if (hasGltfRagdoll(path)) {
        subject.def = loadGltfRagdoll(path).ragdoll;
        return subject;
    }
    try {
        const Character character = loadCharacter(path);
        RagdollDef def = makeRagdoll(character);
        subject.body = bodyJson(character, recognise(character.skeleton), def);
        subject.def = std::move(def);
        subject.skeleton = character.skeleton;
        subject.clips = character.clips;
    } catch (const std::invalid_argument& error) {
        throw AssetError(asset + ": " + error.what());
    }
    return subject;
}

RagdollStage::RagdollStage(const RagdollSubject& subject, const Pose& placement, const WorldSettings& settings)
    : world(settings) {
    if (const auto* def = std::get_if<RagdollDef>(&subject.def))
        place(*def, placement);
    else
        place(std::get<Robot>(subject.def), placement, subject.holding);
}

void RagdollStage::place(const RagdollDef& def, const Pose& placement) {
    ragdoll.emplace(world, def, placement);
    bodies.assign(ragdoll->bodies().begin(), ragdoll->bodies().end());
    joints.assign(ragdoll->joints().begin(), ragdoll->joints().end());
    for (const RagdollPart& part : def.parts) names.push_back(part.name);
    for (const RagdollJoint& joint : def.joints)
        jointNames.push_back(def.parts[static_cast<std::size_t>(joint.child)].name);
}

void RagdollStage::place(const Robot& robot, const Pose& placement, bool holding) {
    const RobotIds ids = makeRobot(world, robot, placement, {.holding = holding});
    joints = ids.joints;
    for (const RobotJoint& joint : robot.joints) jointNames.push_back(joint.name);
    for (std::size_t i = 0; i < ids.bodies.size(); ++i) {
        if (world.type(ids.bodies[i]) != BodyType::dynamic) continue;
        bodies.push_back(ids.bodies[i]);
        names.push_back(robot.bodies[i].name);
    }
}

void RagdollStage::addGround() {
    world.create(StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}, .material = {.friction = 0.8f}});
}

double RagdollStage::mass() const {
    double sum = 0;
    for (const BodyId body : bodies) sum += static_cast<double>(world.mass(body).mass);
    return sum;
}

DVec3 RagdollStage::centerOfMass() const {
    DVec3 sum;
    for (const BodyId body : bodies) sum = sum + static_cast<double>(world.mass(body).mass) * world.centerOfMass(body);
    return (1 / mass()) * sum;
}

DVec3 RagdollStage::momentum() const {
    DVec3 sum;
    for (const BodyId body : bodies)
        sum = sum + static_cast<double>(world.mass(body).mass) * DVec3(world.linearVelocity(body));
    return sum;
}

DVec3 RagdollStage::angularMomentum() const {
    const DVec3 center = centerOfMass();
    DVec3 sum;
    for (const BodyId body : bodies) {
        const MassProperties mass = world.mass(body);
        const Quat turn = world.pose(body).rotation;
        const Vec3 spin = inverseRotate(turn, world.angularVelocity(body));
        sum = sum + DVec3(rotate(turn, mass.inertia * spin)) +
              cross(world.centerOfMass(body) - center,
                    static_cast<double>(mass.mass) * DVec3(world.linearVelocity(body)));
    }
    return sum;
}

double RagdollStage::meanSquareSpeed() const {
    double sum = 0;
    for (const BodyId body : bodies) {
        const DVec3 velocity(world.linearVelocity(body));
        sum += dot(velocity, velocity);
    }
    return sum / static_cast<double>(bodies.size());
}

double RagdollStage::lowestPoint() const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const BodyId body : bodies)
        for (const ShapeId shape : world.shapes(body))
            lowest = std::min(lowest, static_cast<double>(world.bounds(shape).lower.y));
    return lowest;
}

double RagdollStage::reach(const DVec3& from) const {
    double farthest = 0;
    for (const BodyId body : bodies)
        for (const ShapeId shape : world.shapes(body)) {
            const Bounds bounds = world.bounds(shape);
            const Vec3 to = max(abs(bounds.lower - toVec3(from)), abs(bounds.upper - toVec3(from)));
            farthest = std::max(farthest, static_cast<double>(length(to)));
        }
    return farthest;
}

bool RagdollStage::asleep() const {
    return std::none_of(bodies.begin(), bodies.end(), [&](BodyId body) { return world.isAwake(body); });
}

std::size_t RagdollStage::chest() const {
    std::size_t heaviest = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (ragdoll && ragdoll->def().parts[i].role == BodyRole::chest) return i;
        if (world.mass(bodies[i]).mass > world.mass(bodies[heaviest]).mass) heaviest = i;
    }
    return heaviest;
}

std::vector<std::size_t> RagdollStage::holds() const {
    std::vector<std::size_t> limbs, ends;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto role = ragdoll ? ragdoll->def().parts[i].role : BodyRole::other;
        if (role == BodyRole::hand || role == BodyRole::foot) limbs.push_back(i);
        if (world.jointsOf(bodies[i]).size() == 1) ends.push_back(i);
    }
    if (!limbs.empty()) return limbs;
    return ends.empty() ? std::vector<std::size_t>{0} : ends;
}

float anyNumber(std::mt19937& random) { return static_cast<float>(random()) / 2147483648.0f - 1.0f; }

Quat anyRotation(std::mt19937& random) {
    // Points of the cube within the unit ball are as many in any direction.
    while (true) {
        const float x = anyNumber(random), y = anyNumber(random), z = anyNumber(random), w = anyNumber(random);
        const float squared = x * x + y * y + z * z + w * w;
        if (squared > 0.01f && squared <= 1) return normalized(Quat{x, y, z, w});
    }
}

}  // namespace ragtop::demos
