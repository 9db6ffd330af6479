#include "schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <set>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>
#include <vector>

namespace ragtop {
namespace {

using PlainJson = nlohmann::json;

std::string number(double value) { return fmt::format("{:.7g}", value); }

std::string article(const std::string& type) {
    return (type == "integer" || type == "array" || type == "object" ? "an " : "a ") + type;
}

/// "a number in [0.05, 2] m", from the annotations of a schema node.
std::string allowed(const Json& schema) {
    if (schema.contains("enum")) {
        std::vector<std::string> names;
        for (const Json& name : schema["enum"]) names.push_back(name.dump());
        return fmt::format("one of {}", fmt::join(names, ", "));
    }
    if (schema.contains("hint")) return schema["hint"].get<std::string>();
    const Json type = schema.value("type", Json("value"));
    std::string text;
    for (const Json& one : type.is_array() ? type : Json::array({type})) {
        if (one == "null") continue;
        text += (text.empty() ? "" : " or ") + article(one.get<std::string>());
    }
    const bool low = schema.contains("minimum"), high = schema.contains("maximum");
    if (low && high)
        text += fmt::format(" in [{}, {}]", number(schema["minimum"]), number(schema["maximum"]));
    else if (low)
        text += " of at least " + number(schema["minimum"]);
    else if (high)
        text += " of at most " + number(schema["maximum"]);
    if (const std::string unit = schema.value("unit", ""); !unit.empty() && unit != "1") text += " " + unit;
    if (schema.contains("minItems")) {
        const auto least = schema["minItems"].get<std::size_t>();
        const auto most = schema.value("maxItems", std::size_t{0});
        text += most == least ? fmt::format(" of {} elements", least) : fmt::format(" of at least {} elements", least);
    }
    return text;
}

bool hasType(const Json& value, const std::string& type) {
    return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
           (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
           (type == "null" && value.is_null()) || (type == "integer" && value.is_number_integer()) ||
           (type == "number" && value.is_number());
}

bool hasAllowedType(const Json& schema, const Json& value) {
    if (!schema.contains("type")) return true;
    const Json& type = schema["type"];
    if (type.is_string()) return hasType(value, type.get<std::string>());
    return std::any_of(type.begin(), type.end(),
                       [&](const Json& one) { return hasType(value, one.get<std::string>()); });
}

std::string suggestion(const std::string& given, const std::vector<std::string>& names) {
    const std::string near = nearestName(given, names);
    return near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near);
}

std::vector<std::string> namesOf(const Json& schema) {
    std::vector<std::string> names;
    if (schema.contains("properties")) {
        for (const auto& item : schema["properties"].items()) names.push_back(item.key());
    }
    return names;
}

/// Unknown and missing members of an object; one that is missing may be there misspelled. Whether there are any.
bool addWrongMembers(const Json& schema, const Json& value, const std::string& pointer, Faults& faults) {
    bool any = false;
    std::set<std::string> meant;
    const auto names = namesOf(schema);
    const bool open = !schema.contains("additionalProperties");
    for (const auto& item : value.items()) {
        if (open || names.empty() || std::find(names.begin(), names.end(), item.key()) != names.end()) continue;
        any = true;
        meant.insert(nearestName(item.key(), names));
        faults.addUnknown(
            pointer + pointerStep(item.key()),
            fmt::format("is unknown, must be one of {}{}", fmt::join(names, ", "), suggestion(item.key(), names)));
    }
    for (const Json& name : schema.value("required", Json::array())) {
        const std::string key = name.get<std::string>();
        if (value.contains(key)) continue;
        any = true;
        if (meant.contains(key)) continue;
        faults.add(pointer + pointerStep(key),
                   fmt::format("is missing, must be {}", allowed(schema["properties"][key])));
    }
    return any;
}

std::string whyWrong(const Json& schema, const Json& value) {
    std::string hint;
    if (schema.contains("enum") && value.is_string()) {
        hint = suggestion(value.get<std::string>(), schema["enum"].get<std::vector<std::string>>());
    }
    return fmt::format("is {}, must be {}{}", shown(value), allowed(schema), hint);
}

using Path = std::vector<std::string>;

/// Follows valijson's path, elements like "[wheels]" and "[1]", through schema and value at once. `isInnermost`:
/// nothing inside of the value is wrong.
void addFaultsAt(const JsonDocument& document, const Json& root, const Path& path, bool isInnermost, Faults& faults) {
    const Json* schema = &root;
    const Json* value = &document.root();
    std::string pointer;
    for (std::size_t i = 1; i < path.size(); ++i) {
        const std::string step = path[i].substr(1, path[i].size() - 2);
        if (value->is_array()) {
            schema = &schema->at("items");
            value = &value->at(std::stoul(step));
        } else {
            const bool named = schema->contains("properties") && schema->at("properties").contains(step);
            schema = named ? &schema->at("properties").at(step) : &schema->at("additionalProperties");
            // A member that is missing or unknown is told of where it ought to be.
            if (!value->contains(step) || !schema->is_object()) return;
            value = &value->at(step);
        }
        pointer += pointerStep(step);
    }
    const bool isObject = hasAllowedType(*schema, *value) && value->is_object();
    const bool ofMembers = isObject && addWrongMembers(*schema, *value, pointer, faults);
    if (!ofMembers && isInnermost) faults.add(pointer, whyWrong(*schema, *value));
}

/// The places that valijson found wrong; a wrong value makes everything around it wrong too.
std::set<Path> wrongPaths(const JsonDocument& document, const valijson::Schema& compiled) {
    const PlainJson plainRoot = document.root();
    valijson::ValidationResults results;
    valijson::Validator validator;
    if (validator.validate(compiled, valijson::adapters::NlohmannJsonAdapter(plainRoot), &results)) return {};
    std::set<Path> paths;
    for (const auto& result : results) paths.insert(result.context);
    if (paths.empty()) paths.insert(Path{"<root>"});
    return paths;
}

}  // namespace

struct DocumentSchema::Compiled {
    Json schema;
    valijson::Schema rules;
};

DocumentSchema::DocumentSchema(Json schema) {
    auto compiled = std::make_unique<Compiled>();
    const PlainJson plain = schema;
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(plain), compiled->rules);
    compiled->schema = std::move(schema);
    compiled_ = std::move(compiled);
}

DocumentSchema::~DocumentSchema() = default;

void findFaults(const JsonDocument& document, const DocumentSchema& schema, Faults& faults) {
    const std::set<Path> paths = wrongPaths(document, schema.compiled_->rules);
    for (auto path = paths.begin(); path != paths.end(); ++path) {
        // What is inside of a value comes right after it.
        const auto next = std::next(path);
        const bool isInnermost = next == paths.end() || next->size() <= path->size() ||
                                 !std::equal(path->begin(), path->end(), next->begin());
        addFaultsAt(document, schema.compiled_->schema, *path, isInnermost, faults);
    }
    if (!faults.any() && !paths.empty()) faults.add("", "does not fit its schema");
}

std::string nearestName(const std::string& given, const std::vector<std::string>& names) {
    // Levenshtein's distance, one row at a time; a slip changes at most about a third of a name.
    auto distance = [&](const std::string& name) {
        std::vector<std::size_t> row(name.size() + 1);
        std::iota(row.begin(), row.end(), std::size_t{0});
        for (std::size_t i = 0; i < given.size(); ++i) {
            std::size_t diagonal = std::exchange(row[0], i + 1);
            for (std::size_t j = 0; j < name.size(); ++j) {
                const std::size_t replaced = diagonal + (std::tolower(given[i]) == std::tolower(name[j]) ? 0 : 1);
                diagonal = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
            }
        }
        return row.back();
    };
    std::string best;
    std::size_t least = 1 + std::max<std::size_t>(given.size() / 3, 1);
    for (const std::string& name : names) {
        if (const std::size_t d = distance(name); d < least) {
            least = d;
            best = name;
        }
    }
    return best;
}

void allowUnknown(Json& schema) {
    if (schema.is_object() && schema.value("additionalProperties", Json()) == false)
        schema.erase("additionalProperties");
    for (Json& inner : schema)
        if (inner.is_structured()) allowUnknown(inner);
}

}  // namespace ragtop
