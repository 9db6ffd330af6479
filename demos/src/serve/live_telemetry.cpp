#include "live_telemetry.h"

#include <cmath>

#include "ragtop/world.h"

namespace ragtop::live {
namespace {

Json wheelJson(const WheelTelemetry& wheel) {
    return {{"grounded", wheel.grounded},
            {"slipRatio", number(wheel.slipRatio)},
            {"slipAngle", number(wheel.slipAngle)},
            {"load", number(wheel.load)},
            {"longitudinal", number(wheel.longitudinalForce)},
            {"lateral", number(wheel.lateralForce)},
            {"compression", number(wheel.compression)}};
}

Json vehicleJson(const Vehicle& vehicle) {
    const VehicleTelemetry& car = vehicle.telemetry();
    Json wheels = Json::array();
    for (const WheelTelemetry& wheel : car.wheels) wheels.push_back(wheelJson(wheel));
    return {{"rpm", number(car.engine.rpm)},        {"gear", car.gear},
            {"speed", number(car.speed)},           {"throttle", number(vehicle.input.throttle)},
            {"brake", number(vehicle.input.brake)}, {"steer", number(vehicle.input.steer)},
            {"wheels", std::move(wheels)}};
}

Json margin(const char* axis, float value, std::optional<float> lower, std::optional<float> upper) {
    return {{"axis", axis},
            {"value", number(value)},
            {"lower", lower ? number(*lower) : Json(nullptr)},
            {"upper", upper ? number(*upper) : Json(nullptr)}};
}

std::optional<float> lowerOf(const std::optional<Range>& range) {
    return range ? std::optional(range->lower) : std::nullopt;
}
std::optional<float> upperOf(const std::optional<Range>& range) {
    return range ? std::optional(range->upper) : std::nullopt;
}

struct Margins {
    const JointState& state;

    Json operator()(const BallDef& ball) const {
        return {margin("swing", state.swing, 0.0f, ball.swingLimit),
                margin("twist", state.coordinate, lowerOf(ball.twistLimit), upperOf(ball.twistLimit))};
    }
    Json operator()(const HingeDef& hinge) const {
        return Json::array({margin("angle", state.coordinate, lowerOf(hinge.limit), upperOf(hinge.limit))});
    }
    Json operator()(const SliderDef& slider) const {
        return Json::array({margin("travel", state.coordinate, lowerOf(slider.limit), upperOf(slider.limit))});
    }
    Json operator()(const DistanceDef& distance) const {
        return Json::array({margin("distance", state.coordinate, lowerOf(distance.limit), upperOf(distance.limit))});
    }
    Json operator()(const CylindricalDef& joint) const {
        return {of("angle", state.coordinate, joint.turn), of("travel", state.second, joint.travel)};
    }
    Json operator()(const UniversalDef& joint) const {
        return {of("first", state.coordinate, joint.first), of("second", state.second, joint.second)};
    }
    Json operator()(const PlaneDef& joint) const {
        return {of("angle", state.coordinate, joint.turn), of("y", state.second, joint.y),
                of("z", state.third, joint.z)};
    }
    Json operator()(const ScrewDef& joint) const { return Json::array({of("angle", state.coordinate, joint.turn)}); }
    Json operator()(const PathDef& joint) const { return Json::array({of("travel", state.coordinate, joint.travel)}); }
    Json operator()(const SixDofDef& joint) const {
        return {of("twist", state.coordinate, joint.twist), of("swing y", state.second, joint.swingY),
                of("swing z", state.third, joint.swingZ),   of("x", state.travel.x, joint.x),
                of("y", state.travel.y, joint.y),           of("z", state.travel.z, joint.z)};
    }
    Json operator()(const FixedDef&) const { return Json::array(); }

private:
    static Json of(const char* axis, float value, const AxisDef& def) {
        return margin(axis, value, lowerOf(def.limit), upperOf(def.limit));
    }
};

/// The joint that carries the body, or any other one; null: none.
JointId jointOf(const World& world, BodyId body) {
    JointId any;
    for (const JointId joint : world.jointsOf(body)) {
        const JointBodies& ends =
            std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, world.def(joint));
        if (ends.b == body) return joint;
        any = joint;
    }
    return any;
}

Json jointJson(const World& world, JointId joint, const std::string& name) {
    const JointState state = world.state(joint);
    return {{"name", name},
            {"force", array(state.force)},
            {"torque", number(length(state.torque))},
            {"margins", std::visit(Margins{state}, world.def(joint))}};
}

Json pickedJson(const World& world, BodyId body, std::uint32_t node, const std::string& name, const DVec3& origin) {
    Vec3 force;
    int contacts = 0;
    world.forEachContact(body, [&](const Contact& contact) {
        const float sign = contact.bodyB == body ? 1.0f : -1.0f;
        force += sign * (contact.normalForce * contact.normal + contact.frictionForce);
        ++contacts;
    });
    const Pose pose = world.pose(body);
    const BodyType type = world.type(body);
    Json json{{"node", node},
              {"name", name},
              {"type", typeName(type)},
              {"awake", world.isAwake(body)},
              {"mass", type == BodyType::dynamic ? number(world.mass(body).mass) : Json(nullptr)},
              {"position", array(relative(pose.position, origin))},
              {"rotation", array(pose.rotation)},
              {"velocity", array(world.linearVelocity(body))},
              {"spin", array(world.angularVelocity(body))},
              {"contactForce", array(force)},
              {"contacts", contacts}};
    if (const JointId joint = jointOf(world, body); !joint.isNull()) json["joint"] = jointJson(world, joint, name);
    return json;
}

}  // namespace

Json telemetryMessage(const Cast& cast, const Nodes& nodes, std::optional<std::uint32_t> picked, const DVec3& origin) {
    const World& world = *cast.world;
    const StepStats stats = world.stats();
    Json stages = Json::array(), vehicles = Json::array();
    for (const StepStats::Stage& stage : stats.stages) stages.push_back({{"name", stage.name}, {"ms", stage.ms}});
    for (const CastVehicle& car : cast.vehicles) vehicles.push_back(vehicleJson(*car.vehicle));
    Json message{{"type", "telemetry"},
                 {"step", world.stepCount()},
                 {"time", world.time()},
                 {"stages", std::move(stages)},
                 {"vehicles", std::move(vehicles)}};
    const BodyId body = picked ? nodes.body(*picked) : BodyId{};
    if (!body.isNull()) message["picked"] = pickedJson(world, body, *picked, nodes.name(*picked), origin);
    return message;
}

}  // namespace ragtop::live
