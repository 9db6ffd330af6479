#include "tuning_json.h"

#include <fstream>
#include <stdexcept>

#include "describe_json.h"
#include "described_file.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

TuneValue readTuneValue(const JsonValue& value) {
    const Json& json = value.json();
    if (json.is_boolean()) return json.get<bool>();
    if (json.is_number()) return json.get<double>();
    if (json.is_string()) return json.get<std::string>();
    if (json.is_null()) return {};
    DVec3 vector;
    readVector3(value, vector);
    return vector;
}

Json writeTuneValue(const TuneValue& value) {
    struct Write {
        Json operator()(std::monostate) const { return nullptr; }
        Json operator()(const DVec3& v) const { return writeValue(v); }
        Json operator()(bool on) const { return on; }
        Json operator()(double number) const { return number; }
        Json operator()(const std::string& name) const { return name; }
    };
    return std::visit(Write{}, value);
}

}  // namespace

Json tuningSchema() {
    const Json value{{"type", {"number", "boolean", "string", "array", "null"}},
                     {"items", {{"type", "number"}}},
                     {"minItems", 3},
                     {"maxItems", 3},
                     {"hint", "a number, true or false, three numbers, a name or null"}};
    return {{"type", "object"},
            {"additionalProperties", value},
            {"meaning", "values that replace others, by path, also in files that the scene refers to"}};
}

void readTuning(const JsonValue& tuning, Scene& scene, const std::function<bool(const std::string&)>& isThere) {
    std::vector<TunedValue> values;
    for (const auto& item : tuning.json().items()) {
        const JsonValue at = tuning.at(item.key());
        if (!at.holdsWrong() && isThere(item.key())) values.emplace_back(item.key(), readTuneValue(at));
    }
    while (true) {
        try {
            tune(scene, values);
            return;
        } catch (const TuneError& error) {
            const std::string path = error.path(), why = "is not usable: " + std::string(error.what());
            if (std::erase_if(values, [&](const TunedValue& one) { return one.first == path; }) == 0) tuning.fail(why);
            tuning.attempt(path, [&](const JsonValue& at) { at.fail(why); });
        }
    }
}

Json writeTuning(std::span<const TunedValue> values) {
    Json json = Json::object();
    for (const auto& [path, value] : values) json[path] = writeTuneValue(value);
    return json;
}

void saveTuning(const std::filesystem::path& file, const std::filesystem::path& scene,
                std::span<const TunedValue> values) {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(fs::absolute(file).parent_path(), error);
    const fs::path target = fs::weakly_canonical(fs::absolute(scene), error);
    const fs::path folder = fs::weakly_canonical(fs::absolute(file).parent_path(), error);
    // A name that holds when both are moved together, unless they are far apart.
    const fs::path near = target.lexically_relative(folder);
    const bool apart = near.empty() || near.string().starts_with("../../../");
    const Json json{{"extends", (apart ? target : near).generic_string()}, {"tuning", writeTuning(values)}};
    writeJson(json, file);
}

}  // namespace ragtop
