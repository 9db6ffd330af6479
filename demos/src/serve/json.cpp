#include "json.h"

#include <cmath>

namespace ragtop::live {

Json number(float value) { return std::isfinite(value) ? Json(shortestDecimal(value)) : Json(nullptr); }

Json array(const Vec3& v) { return Json::array({number(v.x), number(v.y), number(v.z)}); }
Json array(const Quat& q) { return Json::array({number(q.x), number(q.y), number(q.z), number(q.w)}); }

Json array(const Pose& pose, const DVec3& origin) {
    Json json = array(relative(pose.position, origin));
    for (const Json& component : array(pose.rotation)) json.push_back(component);
    return json;
}

Json tuneJson(const TuneValue& value) {
    struct Write {
        Json operator()(std::monostate) const { return nullptr; }
        Json operator()(const DVec3& v) const { return Json::array({v.x, v.y, v.z}); }
        Json operator()(bool on) const { return on; }
        Json operator()(double number) const { return number; }
        Json operator()(const std::string& name) const { return name; }
    };
    return std::visit(Write{}, value);
}

std::string text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace ragtop::live
