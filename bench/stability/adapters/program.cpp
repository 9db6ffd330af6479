#include "program.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <variant>
#include <vector>

#include "../scenery.h"
#include "peer.h"

namespace ragtop::stability {
namespace {

using Json = nlohmann::json;

Json toJson(const Vec3& v) { return {v.x, v.y, v.z}; }
Json toJson(const DVec3& v) { return {v.x, v.y, v.z}; }
Json toJson(const Quat& q) { return {q.x, q.y, q.z, q.w}; }
Json toJson(const Frame& f) { return {{"position", toJson(f.position)}, {"rotation", toJson(f.rotation)}}; }

Json geometryOf(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) return {{"type", "box"}, {"half", toJson(box->halfExtents)}};
    if (const auto* ball = std::get_if<Sphere>(&shape)) return {{"type", "sphere"}, {"radius", ball->radius}};
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return {{"type", "capsule"}, {"radius", capsule->radius}, {"half", capsule->halfHeight}};
    if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
        Json vertices = Json::array();
        for (const Vec3& vertex : hull->vertices()) vertices.push_back(toJson(vertex));
        return {{"type", "hull"}, {"vertices", vertices}};
    }
    refuse("the protocol: this shape");
}

Json shapeOf(const ShapeDef& shape) {
    const Material& material = shape.material;
    if (material.surfaceVelocity != Vec3{} || material.rollingResistance != 0) refuse("the protocol: this material");
    Json result = geometryOf(shape.geometry);
    result.update(toJson(shape.frame));
    result["friction"] = material.friction;
    result["restitution"] = material.restitution;
    result["collides"] = shape.filter.mask != 0;
    return result;
}

Json bodyOf(const BodyDef& def) {
    static constexpr const char* kTypes[] = {"fixed", "kinematic", "dynamic"};
    const std::size_t type = def.type == BodyType::fixed ? 0 : def.type == BodyType::kinematic ? 1 : 2;
    Json body = {{"type", kTypes[type]},
                 {"position", toJson(def.pose.position)},
                 {"rotation", toJson(def.pose.rotation)},
                 {"v", toJson(def.linearVelocity)},
                 {"w", toJson(def.angularVelocity)},
                 {"shapes", Json::array()}};
    for (const ShapeDef& shape : def.shapes) body["shapes"].push_back(shapeOf(shape));
    if (def.type != BodyType::dynamic) return body;
    const Inertial inertial = inertialOf(def);
    body["mass"] = inertial.mass;
    body["moments"] = toJson(inertial.moments);
    body["principal"] = toJson(inertial.frame);
    return body;
}

Json jointOf(const SceneJoint& joint) {
    const JointBodies& bodies = bodiesOf(joint.def);
    Json result = {{"a", joint.bodyA},
                   {"b", joint.bodyB},
                   {"frameA", toJson(bodies.frameA)},
                   {"frameB", toJson(bodies.frameB)},
                   {"collide", bodies.collide}};
    if (const auto* ball = std::get_if<BallDef>(&joint.def)) {
        if (ball->swingLimit || ball->swingEllipse || ball->swingPyramid || ball->reach || ball->twistLimit ||
            ball->spring || ball->friction != 0)
            refuse("the protocol: limited ball");
        result["type"] = "ball";
    } else if (const auto* hinge = std::get_if<HingeDef>(&joint.def)) {
        if (hinge->limit || hinge->spring || hinge->motor || hinge->friction != 0 || !isPlain(*hinge))
            refuse("the protocol: hinge with extras");
        result["type"] = "hinge";
    } else {
        refuse("the protocol: this joint");
    }
    return result;
}

/// An answer, which is an object without an error.
Json parsed(const std::string& line) {
    const Json answer = Json::parse(line, nullptr, false);
    if (answer.is_discarded() || !answer.is_object())
        throw std::runtime_error("the program answers what is no object: " + line.substr(0, 60));
    if (answer.contains("unsupported")) throw Unsupported(answer["unsupported"].dump());
    if (answer.contains("error")) throw std::runtime_error("the program says " + answer["error"].dump());
    return answer;
}

double numberOf(const Json& value) {
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

class ProgramEngine : public Engine {
public:
    ProgramEngine(const Scene& scene, const ProgramOptions& options)
        : pipe_(options.command, options.patience), motions_(scene.bodies.size()) {
        pipe_.tell(sceneMessage(scene, options));
        take(parsed(pipe_.answer()));
    }

    void step(double dt) override {
        Json message = {{"do", "step"}, {"dt", dt}};
        if (!pushes_.empty()) message["pushes"] = std::exchange(pushes_, Json::array());
        pipe_.tell(message.dump());
        take(parsed(pipe_.answer()));
    }
    BodyMotion motion(int body) const override { return motions_[static_cast<std::size_t>(body)]; }
    void setVelocity(int body, const Vec3& linear, const Vec3& angular) override {
        pipe_.tell(Json{{"do", "velocity"}, {"body", body}, {"v", toJson(linear)}, {"w", toJson(angular)}}.dump());
        take(parsed(pipe_.answer()));
    }
    void push(int body, const Vec3& force, const DVec3& point) override {
        pushes_.push_back({{"body", body}, {"force", toJson(force)}, {"point", toJson(point)}});
    }
    void remove(int) override { refuse("the protocol: taking bodies away"); }
    double normalForce(int a, int b) const override {
        double sum = 0;
        for (const Json& force : forces_)
            if ((force.at(0) == a && force.at(1) == b) || (force.at(0) == b && force.at(1) == a))
                sum += numberOf(force.at(2));
        return sum;
    }
    StepWork work() const override { return work_; }

private:
    void take(const Json& answer) {
        const Json& bodies = answer.contains("bodies") ? answer["bodies"] : Json();
        if (bodies.size() != motions_.size())
            throw std::runtime_error(
                fmt::format("the program tells of {} bodies, must be of {}", bodies.size(), motions_.size()));
        for (std::size_t i = 0; i < motions_.size(); ++i) takeBody(i, bodies[i]);
        forces_ = answer.value("forces", Json::array());
        work_.contacts = answer.value("contacts", 0);
        work_.passes = answer.value("passes", 0);
        work_.cpuMs = answer.value("cpu_ms", 0.0);
    }
    void takeBody(std::size_t i, const Json& body) {
        constexpr std::size_t kNumbers = 13;
        if (!body.is_array() || body.size() != kNumbers)
            throw std::runtime_error(fmt::format("body {} has {} numbers, must have {}", i, body.size(), kNumbers));
        double n[kNumbers];
        for (std::size_t k = 0; k < kNumbers; ++k) n[k] = numberOf(body[k]);
        const auto f = [&n](std::size_t k) { return static_cast<float>(n[k]); };
        motions_[i] = {{{n[0], n[1], n[2]}, {f(3), f(4), f(5), f(6)}}, {f(7), f(8), f(9)}, {f(10), f(11), f(12)}};
    }

    ProgramPipe pipe_;
    std::vector<BodyMotion> motions_;
    Json pushes_ = Json::array(), forces_ = Json::array();
    StepWork work_;
};

}  // namespace

std::string sceneMessage(const Scene& scene, const ProgramOptions& options) {
    Json message = {{"do", "scene"},
                    {"gravity", toJson(scene.settings.gravity)},
                    {"substeps", options.substeps},
                    {"iterations", options.iterations},
                    {"bodies", Json::array()},
                    {"joints", Json::array()}};
    for (const SceneBody& body : scene.bodies) message["bodies"].push_back(bodyOf(body.def));
    for (const SceneJoint& joint : scene.joints) message["joints"].push_back(jointOf(joint));
    return message.dump();
}

std::string programHello(const std::string& command, double patience) {
    ProgramPipe pipe(command, patience);
    pipe.tell(R"({"do":"hello","protocol":1})");
    return parsed(pipe.answer()).dump();
}

std::unique_ptr<Engine> makeProgram(const Scene& scene, const ProgramOptions& options) {
    return std::make_unique<ProgramEngine>(scene, options);
}

}  // namespace ragtop::stability
