#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "describe_json.h"
#include "ragtop/tuning.h"

namespace ragtop {
namespace {

/// Unit quaternions in files are rounded to a few digits; more than this is a slip and not rounding.
constexpr float kUnitTolerance = 1e-3f;

template <class T>
void readComponents(const Json& from, T& into) {
    const auto component = [&](std::size_t i) { return from.at(i).get<decltype(T::x)>(); };
    into = {component(0), component(1), component(2)};
}

Vec3 vectorAt(const JsonValue& value) {
    Vec3 vector;
    readVector3(value, vector);
    return vector;
}

void forbidNull(Json& schema) {
    if (!schema.contains("type") || !schema["type"].is_array()) return;
    Json types = Json::array();
    for (const Json& type : schema["type"])
        if (type != "null") types.push_back(type);
    schema["type"] = std::move(types);
}

}  // namespace

Json numberSchema(const Tunable& field, bool integer, double lowest, double highest) {
    Json schema{{"type", integer ? "integer" : "number"}};
    schema["minimum"] = std::max(field.minimum, lowest);
    schema["maximum"] = std::min(field.maximum, highest);
    if (!integer && !(field.minimum > lowest)) schema.erase("minimum");
    if (!integer && !(field.maximum < highest)) schema.erase("maximum");
    if (!field.unit.empty()) schema["unit"] = std::string(field.unit);
    return schema;
}

Json booleanSchema() { return {{"type", "boolean"}}; }

Json textSchema() { return {{"type", "string"}}; }

Json namesSchema(Json names) { return {{"enum", std::move(names)}}; }

Json arraySchema(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json arraySchema(Json items, std::size_t count) {
    Json schema = arraySchema(std::move(items));
    schema["minItems"] = schema["maxItems"] = count;
    return schema;
}

Json mapSchema(Json values) { return {{"type", "object"}, {"additionalProperties", std::move(values)}}; }

Json objectSchema(Json properties, std::span<const char* const> required) {
    Json schema{{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    for (const char* name : required) {
        schema["required"].push_back(name);
        forbidNull(schema["properties"][name]);
    }
    return schema;
}

void addName(Json& names, std::string_view name) { names.push_back(std::string(name)); }

Json schemaWithMeaning(Json schema, const Tunable& field) {
    if (!field.meaning.empty()) schema["meaning"] = std::string(field.meaning);
    return schema;
}

Json schemaWithMeaning(Json schema, const Tunable& field, Json initial) {
    schema = schemaWithMeaning(std::move(schema), field);
    schema["default"] = std::move(initial);
    return schema;
}

void setField(Json& object, std::string_view name, Json value) { object[std::string(name)] = std::move(value); }

Json vectorSchema(const Tunable& field) {
    // Positions are double, but nothing lies farther away than floats reach.
    const Json element = numberSchema(field, false, -3.4e38, 3.4e38);
    return {
        {"type", "array"}, {"items", element}, {"minItems", 3}, {"maxItems", 3}, {"hint", "three numbers [x, y, z]"}};
}

Json rotationSchema() {
    const Tunable component{.name = "", .minimum = -1.001, .maximum = 1.001};
    const Tunable axis{.name = "axis", .minimum = -1e5, .maximum = 1e5};
    const Tunable angle{.name = "angle", .unit = "rad", .minimum = -kWholeTurn, .maximum = kWholeTurn};
    Json schema{{"type", {"array", "object"}},
                {"items", numberSchema(component, false, -2, 2)},
                {"minItems", 4},
                {"maxItems", 4},
                {"additionalProperties", false},
                {"required", {"axis", "angle"}},
                {"hint", "a unit quaternion [x, y, z, w] or {\"axis\": [x, y, z], \"angle\": rad}"}};
    schema["properties"] = {{"axis", vectorSchema(axis)}, {"angle", numberSchema(angle, false, -3.4e38, 3.4e38)}};
    return schema;
}

Json frameSchema() {
    const Tunable position{.name = "position", .unit = "m", .minimum = -1e5, .maximum = 1e5};
    Json schema{{"type", "object"}, {"additionalProperties", false}};
    schema["properties"] = {{"position", vectorSchema(position)}, {"rotation", rotationSchema()}};
    return schema;
}

Json rangeSchema(const Tunable& field) {
    const Json end = numberSchema(field, false, -3.4e38, 3.4e38);
    Json schema{{"type", "object"}, {"additionalProperties", false}, {"required", {"lower", "upper"}}};
    schema["properties"] = {{"lower", end}, {"upper", end}};
    return schema;
}

void allowNull(Json& schema) {
    schema.erase("default");
    if (!schema.contains("type")) {
        if (schema.contains("enum")) schema["enum"].push_back(nullptr);
        return;
    }
    if (schema["type"].is_string()) schema["type"] = Json::array({schema["type"]});
    schema["type"].push_back("null");
}

Quat readRotation(const JsonValue& value) {
    Vec3 axis;
    value.attempt("axis", [&](const JsonValue& at) {
        axis = vectorAt(at);
        if (!(length(axis) > 0)) at.fail("is [0, 0, 0], must have a direction");
    });
    if (value.holdsWrong()) throw Faults::Consequence();
    if (value.json().is_object()) return rotationAbout(axis, value.at("angle").json().get<float>());
    const auto part = [&](std::size_t i) { return value.json().at(i).get<float>(); };
    const Quat q{part(0), part(1), part(2), part(3)};
    const float norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(std::abs(norm - 1) <= kUnitTolerance)) {
        value.fail(fmt::format("is {} of length {:.4g}, must be a unit quaternion [x, y, z, w] of length 1 ± {}",
                               shown(value.json()), norm, kUnitTolerance));
    }
    // One ulp of rounding is what a saved quaternion has; normalizing it again would not round-trip.
    return std::abs(norm - 1) < 1e-6f ? q : normalized(q);
}

Range readRange(const JsonValue& value) {
    const Range range{value.at("lower").json().get<float>(), value.at("upper").json().get<float>()};
    if (range.lower > range.upper) {
        value.at("lower").fail(fmt::format("is {}, must be at most \"upper\", {}", range.lower, range.upper));
    }
    return range;
}

void readVector3(const JsonValue& value, Vec3& into) { readComponents(value.json(), into); }

void readVector3(const JsonValue& value, DVec3& into) { readComponents(value.json(), into); }

Json writeNumber(double value) { return value; }

Json writeNumber(float value) { return shortestDecimal(value); }

template <class T>
void readPlain(const JsonValue& from, T& into) {
    into = from.json().get<T>();
}

template <class T>
Json writePlain(const T& value) {
    return value;
}

template void readPlain(const JsonValue&, float&);
template void readPlain(const JsonValue&, double&);
template void readPlain(const JsonValue&, bool&);
template void readPlain(const JsonValue&, std::string&);
template void readPlain(const JsonValue&, int&);
template void readPlain(const JsonValue&, std::uint8_t&);
template void readPlain(const JsonValue&, std::uint16_t&);
template void readPlain(const JsonValue&, std::uint32_t&);
template void readPlain(const JsonValue&, std::uint64_t&);
template Json writePlain(const bool&);
template Json writePlain(const std::string&);
template Json writePlain(const int&);
template Json writePlain(const std::uint8_t&);
template Json writePlain(const std::uint16_t&);
template Json writePlain(const std::uint32_t&);
template Json writePlain(const std::uint64_t&);

}  // namespace ragtop
