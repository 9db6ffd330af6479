#include <algorithm>
#include <cmath>

#include "ragtop/world.h"
#include "session.h"

namespace ragtop::live {
namespace {

const char* nameOf(TunableKind kind) {
    switch (kind) {
        case TunableKind::number:
            return "number";
        case TunableKind::integer:
            return "integer";
        case TunableKind::boolean:
            return "bool";
        case TunableKind::vector:
            return "vector";
        case TunableKind::choice:
            return "choice";
    }
    return "";
}

Json finiteOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json(const DVec3& v) { return Json::array({v.x, v.y, v.z}); }

Json describe(const CastRoad& road, const DVec3& origin) {
    Json points = Json::array();
    for (const DVec3& point : road.line) points.push_back(array(relative(point, origin)));
    return {{"name", road.name}, {"closed", road.closed}, {"width", number(road.width)}, {"points", std::move(points)}};
}

Json describe(const TunableField& field, const TuneValue& initial) {
    Json tunable{{"path", field.path},
                 {"label", field.label},
                 {"group", field.group},
                 {"unit", field.unit},
                 {"min", finiteOrNull(field.minimum)},
                 {"max", finiteOrNull(field.maximum)},
                 {"default", tuneJson(initial)},
                 {"value", tuneJson(field.value)},
                 {"meaning", field.meaning},
                 {"kind", nameOf(field.kind)}};
    if (field.optional) tunable["optional"] = true;
    if (field.kind == TunableKind::choice) tunable["choices"] = field.choices;
    return tunable;
}

}  // namespace

Json Session::helloMessage() const {
    return {{"type", "hello"},
            {"protocol", 1},
            {"version", RAGTOP_VERSION},
            {"scenes", scenesJson()},
            {"scene", stage_->cast().name}};
}

Json Session::scenesJson() const {
    Json scenes = Json::array();
    for (const SceneEntry& entry : stage_->scenes()) {
        scenes.push_back({{"name", entry.name}, {"description", entry.description}});
    }
    return scenes;
}

Json Session::sceneMessage() const {
    const Cast& cast = stage_->cast();
    Json roads = Json::array();
    for (const CastRoad& road : cast.roads) roads.push_back(describe(road, origin_));
    return {{"type", "scene"},
            {"name", cast.name},
            {"description", cast.description},
            {"dt", cast.step},
            {"origin", json(origin_)},
            {"up", "y"},
            {"geometries", nodes_->geometries()},
            {"nodes", nodes_->describe()},
            {"vehicles", nodes_->vehicles()},
            {"ragdolls", nodes_->ragdolls()},
            {"cloths", draped_->describe()},
            {"roads", std::move(roads)},
            {"visuals", nodes_->visuals()},
            {"tunables", tunablesJson()},
            {"warnings", cast.warnings},
            {"camera", cameraJson()}};
}

/// Where the scene says, or so that everything that moves is in view.
Json Session::cameraJson() const {
    const Cast& cast = stage_->cast();
    if (cast.camera)
        return {{"target", json(cast.camera->target - origin_)}, {"eye", json(cast.camera->eye - origin_)}};
    const World& world = *cast.world;
    bool any = false;
    DVec3 lower, upper;
    for (const BodyId body : world.bodies()) {
        if (world.type(body) == BodyType::fixed) continue;
        const DVec3 at = world.pose(body).position - origin_;
        if (!any) lower = upper = at;
        any = true;
        lower = {std::min(lower.x, at.x), std::min(lower.y, at.y), std::min(lower.z, at.z)};
        upper = {std::max(upper.x, at.x), std::max(upper.y, at.y), std::max(upper.z, at.z)};
    }
    const DVec3 middle = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
    const double radius = std::max(3.0, std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z));
    return {{"target", json(middle)}, {"eye", json(middle + 1.5 * radius * DVec3(0.6, 0.45, -0.8))}};
}

Json Session::tunablesJson() const {
    const Tuning& tuning = stage_->tuning();
    Json tunables = Json::array();
    for (std::size_t i = 0; i < tuning.fields().size(); ++i) {
        tunables.push_back(describe(tuning.fields()[i], tuning.defaults()[i]));
    }
    return tunables;
}

Json Session::statusMessage() const {
    const World& world = *stage_->cast().world;
    const StepStats stats = world.stats();
    Json driven = Json::array();
    for (std::size_t i = 0; i < live_->driven().size(); ++i) {
        if (live_->driven()[i]) driven.push_back(i);
    }
    return {{"type", "status"},
            {"playing", playing_},
            {"step", live_->now()},
            {"time", world.time()},
            {"first", live_->first()},
            {"last", live_->last()},
            {"speed", speed_},
            {"realTimeFactor", realTimeFactor_},
            {"awake", stats.awakeBodies},
            {"bodies", stats.bodies},
            {"contacts", stats.touching},
            {"islands", world.countIslands()},
            {"show", show_},
            {"picked", picked_ ? Json(*picked_) : Json(nullptr)},
            {"driven", std::move(driven)}};
}

}  // namespace ragtop::live
