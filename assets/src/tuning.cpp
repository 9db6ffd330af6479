#include "ragtop/tuning.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace ragtop {
namespace {

bool isWithin(const TunableField& field, double value) {
    return std::isfinite(value) && value >= field.minimum && value <= field.maximum;
}

bool accepts(const TunableField& field, const TuneValue& value) {
    if (std::holds_alternative<std::monostate>(value)) return field.optional;
    switch (field.kind) {
        case TunableKind::boolean:
            return std::holds_alternative<bool>(value);
        case TunableKind::number:
        case TunableKind::integer: {
            const auto* number = std::get_if<double>(&value);
            return number && isWithin(field, *number) &&
                   (field.kind == TunableKind::number || std::floor(*number) == *number);
        }
        case TunableKind::vector: {
            const auto* v = std::get_if<DVec3>(&value);
            return v && isWithin(field, v->x) && isWithin(field, v->y) && isWithin(field, v->z);
        }
        case TunableKind::choice: {
            const auto* name = std::get_if<std::string>(&value);
            return name && std::find(field.choices.begin(), field.choices.end(), *name) != field.choices.end();
        }
    }
    return false;
}

std::string allowed(const TunableField& field) {
    std::string text;
    switch (field.kind) {
        case TunableKind::boolean:
            text = "true or false";
            break;
        case TunableKind::number:
            text = "a number";
            break;
        case TunableKind::integer:
            text = "an integer";
            break;
        case TunableKind::vector:
            text = "three numbers";
            break;
        case TunableKind::choice:
            text = fmt::format("one of \"{}\"", fmt::join(field.choices, "\", \""));
            break;
    }
    const bool ranged = field.kind != TunableKind::boolean && field.kind != TunableKind::choice;
    if (ranged && std::isfinite(field.minimum) && std::isfinite(field.maximum)) {
        text += fmt::format(" in [{:.7g}, {:.7g}]", field.minimum, field.maximum);
    } else if (ranged && std::isfinite(field.minimum)) {
        text += fmt::format(" of at least {:.7g}", field.minimum);
    } else if (ranged && std::isfinite(field.maximum)) {
        text += fmt::format(" of at most {:.7g}", field.maximum);
    }
    if (!field.unit.empty() && field.unit != "1") text += " " + field.unit;
    return text + (field.optional ? " or null" : "");
}

}  // namespace

double shortestDecimal(float value) {
    if (!std::isfinite(value)) return static_cast<double>(value);
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    double shortest = 0;
    std::from_chars(digits, end, shortest);
    // Reading the decimal as a double and rounding that could, in theory, end at the neighbour.
    return static_cast<float>(shortest) == value ? shortest : static_cast<double>(value);
}

std::string shownValue(const TuneValue& value) {
    struct Show {
        std::string operator()(std::monostate) const { return "null"; }
        std::string operator()(bool on) const { return on ? "true" : "false"; }
        std::string operator()(double number) const { return fmt::format("{}", number); }
        std::string operator()(const DVec3& v) const { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }
        std::string operator()(const std::string& name) const { return "\"" + name + "\""; }
    };
    return std::visit(Show{}, value);
}

std::string whyInvalid(const TunableField& field, const TuneValue& value) {
    if (accepts(field, value)) return {};
    return fmt::format("{} is {}, must be {}", field.path, shownValue(value), allowed(field));
}

}  // namespace ragtop
