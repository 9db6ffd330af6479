#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "json_value.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"
#include "shape_json.h"

/// One description of a struct, three visitors: the schema of its JSON form, reading it, writing it.
///
/// A type takes part through `describe` (ragtop/tunables.h); enums through `enumNames(Enum)`, a range of names in the
/// order of the values, which count from zero; fields that a file must have through `requiredFields(const T*)`.
namespace ragtop {

/// rad, a whole turn with the digits that people write. Directions and rotations beyond it are degrees.
inline constexpr double kWholeTurn = 6.2832;

struct IgnoreFields {
    template <class T>
    void operator()(const Tunable&, T&) {}
};

template <class T>
concept Described = requires(IgnoreFields visit, T& value) {
    describe(visit, value, static_cast<const T*>(nullptr));
};
template <class T>
concept NamedEnum = std::is_enum_v<T> && requires {
    enumNames(T{});
};
template <class T>
concept HasRequiredFields = requires {
    requiredFields(static_cast<const T*>(nullptr));
};

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t N>
struct IsArray<std::array<T, N>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class T>
struct IsMap<std::map<std::string, T>> : std::true_type {};
template <class T>
inline constexpr bool kIsVector3 = std::is_same_v<T, Vec3> || std::is_same_v<T, DVec3>;

// Schemas of the types that are no templates (schema_nodes.cpp). "unit", "hint" and "meaning" are annotations that
// messages and the manual use; validators skip them.
Json numberSchema(const Tunable& field, bool integer, double lowest, double highest);
Json booleanSchema();
Json textSchema();
Json vectorSchema(const Tunable& field);
Json rotationSchema();
Json frameSchema();
Json rangeSchema(const Tunable& field);
void allowNull(Json& schema);

// Schemas made of others: what is done with JSON is compiled there, once, and not again for each described type.
Json namesSchema(Json names);
Json arraySchema(Json items);
Json arraySchema(Json items, std::size_t count);
Json mapSchema(Json values);
Json objectSchema(Json properties, std::span<const char* const> required);
void addName(Json& names, std::string_view name);
/// With the field's meaning, and where there is one its default.
Json schemaWithMeaning(Json schema, const Tunable& field);
Json schemaWithMeaning(Json schema, const Tunable& field, Json initial);
void setField(Json& object, std::string_view name, Json value);

// The same for values.
Quat readRotation(const JsonValue& value);
Range readRange(const JsonValue& value);
void readVector3(const JsonValue& value, Vec3& into);
void readVector3(const JsonValue& value, DVec3& into);
/// A boolean, a number or a text, of one of the types that the end of schema_nodes.cpp lists.
template <class T>
void readPlain(const JsonValue& from, T& into);
Json writeNumber(double value);
Json writeNumber(float value);
/// A boolean, an integer or a text, likewise.
template <class T>
Json writePlain(const T& value);

template <class T>
Json writeValue(const T& value);

template <class T>
Json schemaOf(const Tunable& field, const T& initial);

// Visitors are of one type for all that is described: what several descriptions share is compiled once.
struct SchemaFields {
    Json& properties;
    template <class T>
    void operator()(const Tunable& field, const T& member) const {
        setField(properties, field.name, schemaOf(field, member));
    }
};

template <Described T>
Json objectSchema(const T& initial) {
    Json properties = Json::object();
    SchemaFields visit{properties};
    describe(visit, initial, static_cast<const T*>(nullptr));
    if constexpr (HasRequiredFields<T>)
        return objectSchema(std::move(properties), requiredFields(static_cast<const T*>(nullptr)));
    else
        return objectSchema(std::move(properties), {});
}

template <class T>
Json schemaWithoutMeaning(const Tunable& field, const T& initial) {
    if constexpr (std::is_same_v<T, bool>) {
        return booleanSchema();
    } else if constexpr (std::is_integral_v<T>) {
        return numberSchema(field, true, static_cast<double>(std::numeric_limits<T>::lowest()),
                            static_cast<double>(std::numeric_limits<T>::max()));
    } else if constexpr (std::is_floating_point_v<T>) {
        return numberSchema(field, false, std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max());
    } else if constexpr (std::is_same_v<T, std::string>) {
        return textSchema();
    } else if constexpr (NamedEnum<T>) {
        Json names = Json::array();
        for (const auto& name : enumNames(T{})) addName(names, name);
        return namesSchema(std::move(names));
    } else if constexpr (kIsVector3<T>) {
        return vectorSchema(field);
    } else if constexpr (std::is_same_v<T, Quat>) {
        return rotationSchema();
    } else if constexpr (std::is_same_v<T, Frame>) {
        return frameSchema();
    } else if constexpr (std::is_same_v<T, Range>) {
        return rangeSchema(field);
    } else if constexpr (std::is_same_v<T, Shape>) {
        return shapeSchema();
    } else if constexpr (IsOptional<T>::value) {
        Json schema = schemaOf(field, initial.value_or(typename T::value_type{}));
        allowNull(schema);
        return schema;
    } else if constexpr (IsVector<T>::value) {
        return arraySchema(schemaOf(field, typename T::value_type{}));
    } else if constexpr (IsArray<T>::value) {
        return arraySchema(schemaOf(field, typename T::value_type{}), initial.size());
    } else if constexpr (IsMap<T>::value) {
        return mapSchema(schemaOf(field, typename T::mapped_type{}));
    } else {
        return objectSchema(initial);
    }
}

template <class T>
Json schemaOf(const Tunable& field, const T& initial) {
    if constexpr (std::is_arithmetic_v<T> || NamedEnum<T> || kIsVector3<T>)
        return schemaWithMeaning(schemaWithoutMeaning(field, initial), field, writeValue(initial));
    else
        return schemaWithMeaning(schemaWithoutMeaning(field, initial), field);
}

template <class T>
void readValue(const JsonValue& from, T& into);

struct ReadFields {
    const JsonValue& from;
    template <class T>
    void operator()(const Tunable& field, T& member) const {
        const std::string name(field.name);
        if (from.has(name)) readValue(from.at(name), member);
    }
};

template <Described T>
void readObject(const JsonValue& from, T& into) {
    ReadFields visit{from};
    describe(visit, into, static_cast<const T*>(nullptr));
}

template <class T>
void readEnum(const JsonValue& from, T& into) {
    std::string given;
    readPlain(from, given);
    int value = 0;
    for (const auto& name : enumNames(T{})) {
        if (given == name) into = static_cast<T>(value);
        ++value;
    }
}

/// Types that are right or wrong as a whole; of others the parts are.
template <class T>
struct IsWhole : std::bool_constant<!Described<T>> {};
template <>
struct IsWhole<Quat> : std::false_type {};
template <>
struct IsWhole<Range> : std::true_type {};
template <>
struct IsWhole<Frame> : std::false_type {};
template <>
struct IsWhole<Shape> : std::false_type {};
template <class T>
struct IsWhole<std::optional<T>> : std::false_type {};
template <class T>
struct IsWhole<std::vector<T>> : std::false_type {};
template <class T, std::size_t N>
struct IsWhole<std::array<T, N>> : std::false_type {};
template <class T>
struct IsWhole<std::map<std::string, T>> : std::false_type {};

template <class T>
void readWhole(const JsonValue& from, T& into) {
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
        readPlain(from, into);
    } else if constexpr (NamedEnum<T>) {
        readEnum(from, into);
    } else if constexpr (kIsVector3<T>) {
        readVector3(from, into);
    } else {
        into = readRange(from);
    }
}

/// Reads what the schema has accepted; fields that are absent, or wrong, keep what `into` holds.
template <class T>
void readValue(const JsonValue& from, T& into) {
    if (from.isWrong()) return;
    if constexpr (IsWhole<T>::value) {
        if (!from.holdsWrong()) from.attempt([&] { readWhole(from, into); });
    } else if constexpr (std::is_same_v<T, Shape>) {
        from.attempt([&] { into = readShape(from); });
    } else if constexpr (std::is_same_v<T, Quat>) {
        from.attempt([&] { into = readRotation(from); });
    } else if constexpr (std::is_same_v<T, Frame>) {
        if (from.has("position")) readValue(from.at("position"), into.position);
        if (from.has("rotation")) readValue(from.at("rotation"), into.rotation);
    } else if constexpr (IsOptional<T>::value) {
        if (from.json().is_null()) {
            into.reset();
        } else {
            if (!into) into.emplace();
            readValue(from, *into);
        }
    } else if constexpr (IsVector<T>::value || IsArray<T>::value) {
        if constexpr (IsVector<T>::value) into.assign(from.size(), {});
        for (std::size_t i = 0; i < from.size(); ++i) {
            typename T::value_type element{};
            readValue(from.at(i), element);
            into[i] = std::move(element);
        }
    } else if constexpr (IsMap<T>::value) {
        into.clear();
        for (const auto& item : from.json().items()) readValue(from.at(item.key()), into[item.key()]);
    } else {
        readObject(from, into);
    }
}

struct WriteFields {
    Json& object;
    template <class T>
    void operator()(const Tunable& field, const T& member) const {
        if constexpr (IsOptional<T>::value) {
            if (member) setField(object, field.name, writeValue(*member));
        } else {
            setField(object, field.name, writeValue(member));
        }
    }
};

template <Described T>
Json writeObject(const T& value) {
    Json object = Json::object();
    WriteFields visit{object};
    describe(visit, value, static_cast<const T*>(nullptr));
    return object;
}

template <class T>
Json writeValue(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
        return writeNumber(value);
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
        return writePlain(value);
    } else if constexpr (NamedEnum<T>) {
        const auto& names = enumNames(T{});
        return writePlain(std::string(*(std::begin(names) + static_cast<std::ptrdiff_t>(value))));
    } else if constexpr (kIsVector3<T>) {
        return Json::array({writeNumber(value.x), writeNumber(value.y), writeNumber(value.z)});
    } else if constexpr (std::is_same_v<T, Quat>) {
        return Json::array({writeNumber(value.x), writeNumber(value.y), writeNumber(value.z), writeNumber(value.w)});
    } else if constexpr (std::is_same_v<T, Frame>) {
        return {{"position", writeValue(value.position)}, {"rotation", writeValue(value.rotation)}};
    } else if constexpr (std::is_same_v<T, Range>) {
        return {{"lower", writeNumber(value.lower)}, {"upper", writeNumber(value.upper)}};
    } else if constexpr (std::is_same_v<T, Shape>) {
        return writeShape(value);
    } else if constexpr (IsVector<T>::value || IsArray<T>::value) {
        Json array = Json::array();
        for (const auto& element : value) array.push_back(writeValue(element));
        return array;
    } else if constexpr (IsMap<T>::value) {
        Json object = Json::object();
        for (const auto& [key, element] : value) object[key] = writeValue(element);
        return object;
    } else {
        return writeObject(value);
    }
}

}  // namespace ragtop
