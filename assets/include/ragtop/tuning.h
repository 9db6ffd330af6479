#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"

/// The numbers of described structs by path, for sliders and for files of changes: "suspension.stiffness" of a wheel,
/// "wheels.front left.suspension.stiffness" of its car. Elements of arrays go by their name, or by their index where
/// they have none of their own.
namespace ragtop {

/// Nothing (an optional that is absent), a switch, a number, a vector, or the name of a choice.
using TuneValue = std::variant<std::monostate, bool, double, DVec3, std::string>;

enum class TunableKind : std::uint8_t { number, integer, boolean, vector, choice };

/// A tunable with the value it has.
struct TunableField {
    std::string path{};
    std::string label{};  ///< last part of the path
    std::string group{};  ///< what it belongs to: "car / wheels / front left"
    std::string unit{}, meaning{};
    double minimum = -kUnbounded, maximum = kUnbounded;
    TunableKind kind = TunableKind::number;
    bool optional = false;               ///< may be absent
    std::vector<std::string> choices{};  ///< of a choice
    TuneValue value{};
};

/// The value as in a message: 0.5, true, [1, 2, 3], "open", null.
std::string shownValue(const TuneValue& value);
/// Empty when the field may have the value; otherwise "path is value unit, must be ...".
std::string whyInvalid(const TunableField& field, const TuneValue& value);

/// A field of a struct that lives elsewhere.
struct TunableRef {
    TunableField field;
    std::function<void(const TuneValue&)> set;  ///< takes what whyInvalid accepts
};

/// A single-precision number as the shortest decimal that names it.
double shortestDecimal(float value);

namespace tuning_detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

struct Ignore {
    template <class T>
    void operator()(const Tunable&, T&) {}
};
template <class T>
concept Described = requires(Ignore visit, T& value) {
    describe(visit, value, static_cast<const T*>(nullptr));
};
template <class T>
concept NamedEnum = std::is_enum_v<T> && requires {
    enumNames(T{});
};
template <class T>
concept Named = requires(const T& value) {
    { value.name } -> std::convertible_to<std::string>;
};
template <class T>
inline constexpr bool kIsVector3 = std::is_same_v<T, Vec3> || std::is_same_v<T, DVec3>;
/// One slider, switch or list.
template <class T>
inline constexpr bool kIsLeaf = std::is_arithmetic_v<T> || kIsVector3<T> || NamedEnum<T>;

template <class T>
TuneValue read(const T& value) {
    if constexpr (std::is_same_v<T, bool>)
        return value;
    else if constexpr (std::is_same_v<T, float>)
        return shortestDecimal(value);
    else if constexpr (std::is_arithmetic_v<T>)
        return static_cast<double>(value);
    else if constexpr (std::is_same_v<T, Vec3>)
        return DVec3{shortestDecimal(value.x), shortestDecimal(value.y), shortestDecimal(value.z)};
    else if constexpr (std::is_same_v<T, DVec3>)
        return value;
    else
        return std::string(*(std::begin(enumNames(T{})) + static_cast<std::ptrdiff_t>(value)));
}

template <class T>
void write(const TuneValue& from, T& into) {
    if constexpr (std::is_same_v<T, bool>)
        into = std::get<bool>(from);
    else if constexpr (std::is_arithmetic_v<T>)
        into = static_cast<T>(std::get<double>(from));
    else if constexpr (std::is_same_v<T, Vec3>)
        into = toVec3(std::get<DVec3>(from));
    else if constexpr (std::is_same_v<T, DVec3>)
        into = std::get<DVec3>(from);
    else {
        int index = 0;
        for (const auto& name : enumNames(T{})) {
            if (std::get<std::string>(from) == name) into = static_cast<T>(index);
            ++index;
        }
    }
}

template <class T>
void describeLeaf(TunableField& field) {
    field.kind = std::is_same_v<T, bool>   ? TunableKind::boolean
                 : std::is_integral_v<T>   ? TunableKind::integer
                 : std::is_arithmetic_v<T> ? TunableKind::number
                 : kIsVector3<T>           ? TunableKind::vector
                                           : TunableKind::choice;
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
        const auto lowest = static_cast<double>(std::numeric_limits<T>::lowest());
        const auto highest = static_cast<double>(std::numeric_limits<T>::max());
        if (field.minimum < lowest) field.minimum = lowest;
        if (field.maximum > highest) field.maximum = highest;
    }
    if constexpr (NamedEnum<T>) {
        for (const auto& name : enumNames(T{})) field.choices.emplace_back(name);
    }
}

/// Visits a struct down to its leaves.
class Collector {
public:
    Collector(std::string path, std::string group, std::vector<TunableRef>& into)
        : path_(std::move(path)), group_(std::move(group)), into_(into) {}

    template <class T>
    void operator()(const Tunable& tunable, T& value) {
        add(tunable, std::string(tunable.name), value);
    }

private:
    template <class T>
    void add(const Tunable& tunable, const std::string& name, T& value) {
        if constexpr (kIsLeaf<T>) {
            leaf<T>(tunable, name, value, false);
        } else if constexpr (std::is_same_v<T, Range>) {
            Collector inner(path_ + name + ".", joined(name), into_);
            inner.add(tunable, "lower", value.lower);
            inner.add(tunable, "upper", value.upper);
        } else if constexpr (IsOptional<T>::value) {
            if constexpr (kIsLeaf<typename T::value_type>)
                leaf<typename T::value_type>(tunable, name, value, true);
            else if (value)
                add(tunable, name, *value);
        } else if constexpr (IsVector<T>::value) {
            addElements(tunable, name, value);
        } else if constexpr (Described<T> && !std::is_same_v<T, Filter>) {
            Collector inner(path_ + name + ".", joined(name), into_);
            describe(inner, value, static_cast<const T*>(nullptr));
        }
    }

    template <class T>
    void addElements(const Tunable& tunable, const std::string& name, std::vector<T>& all) {
        Collector inner(path_ + name + ".", joined(name), into_);
        for (std::size_t i = 0; i < all.size(); ++i) inner.add(tunable, elementName(all, i), all[i]);
    }

    template <class T>
    static std::string elementName(const std::vector<T>& all, std::size_t i) {
        if constexpr (Named<T>) {
            const std::string& name = all[i].name;
            bool own = !name.empty();
            for (std::size_t j = 0; j < all.size(); ++j) own = own && (j == i || all[j].name != name);
            if (own) return name;
        }
        return std::to_string(i);
    }

    template <class T, class Member>
    void leaf(const Tunable& tunable, const std::string& name, Member& member, bool optional) {
        TunableField field;
        field.path = path_ + name;
        field.label = name;
        field.group = group_;
        field.unit = tunable.unit;
        field.meaning = tunable.meaning;
        field.minimum = tunable.minimum;
        field.maximum = tunable.maximum;
        field.optional = optional;
        describeLeaf<T>(field);
        if constexpr (std::is_same_v<Member, T>) {
            field.value = read(member);
            into_.push_back({std::move(field), [&member](const TuneValue& value) { write(value, member); }});
        } else {
            if (member) field.value = read(*member);
            into_.push_back({std::move(field), [&member](const TuneValue& value) {
                                 if (std::holds_alternative<std::monostate>(value)) return member.reset();
                                 if (!member) member.emplace();
                                 write(value, *member);
                             }});
        }
    }

    std::string joined(const std::string& name) const { return group_.empty() ? name : group_ + " / " + name; }

    std::string path_, group_;
    std::vector<TunableRef>& into_;
};

}  // namespace tuning_detail

/// The tunables of a described struct, which must stay where it is while they are set. Paths begin with `path`.
template <tuning_detail::Described T>
void addTunables(T& value, const std::string& path, const std::string& group, std::vector<TunableRef>& into) {
    tuning_detail::Collector collect(path.empty() ? "" : path + ".", group, into);
    describe(collect, value, static_cast<const T*>(nullptr));
}

}  // namespace ragtop
