#include "described_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <vector>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

JsonDocument loadExtended(const std::filesystem::path& path, std::vector<std::filesystem::path>& chain) {
    JsonDocument document = JsonDocument::load(path);
    chain.push_back(std::filesystem::weakly_canonical(path));
    if (!document.root().is_object()) return document;
    if (document.root().contains("extends")) {
        const JsonValue reference = JsonValue(document).at("extends");
        if (!reference.json().is_string()) {
            reference.fail("is " + shown(reference.json()) + ", must be the name of a file");
        }
        const auto base = referencedFile(reference);
        if (std::find(chain.begin(), chain.end(), std::filesystem::weakly_canonical(base)) != chain.end()) {
            reference.fail("is " + shown(reference.json()) + ", must not lead back to the file itself");
        }
        if (chain.size() >= kLongestChain)
            reference.fail(fmt::format("follows {} others, the most allowed", chain.size()));
        document.erase("extends");
        document.layOver(loadExtended(base, chain));
    }
    document.erase("$schema");
    return document;
}

/// Objects over several lines, arrays of numbers on one: as a person would write them.
void print(std::ostream& out, const Json& json, const std::string& indent) {
    const bool flat =
        json.is_primitive() || json.empty() ||
        (json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& element) {
             return element.is_primitive() ||
                    (element.is_array() &&
                     std::all_of(element.begin(), element.end(), [](const Json& e) { return e.is_primitive(); }) &&
                     element.size() <= 4);
         }));
    if (flat) {
        out << json.dump();
        return;
    }
    const std::string inner = indent + "  ";
    const char* separator = "\n";
    out << (json.is_object() ? "{" : "[");
    for (const auto& item : json.items()) {
        out << separator << inner;
        if (json.is_object()) out << Json(item.key()).dump() << ": ";
        print(out, item.value(), inner);
        separator = ",\n";
    }
    out << "\n" << indent << (json.is_object() ? "}" : "]");
}

}  // namespace

JsonDocument loadExtended(const std::filesystem::path& path) {
    std::vector<std::filesystem::path> chain;
    return loadExtended(path, chain);
}

std::filesystem::path referencedFile(const JsonValue& value) {
    const auto file = value.folder() / value.json().get<std::string>();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        value.fail("is " + shown(value.json()) + ", must name a file, and there is no " + file.string());
    }
    // Behind a symbolic link ".." leads elsewhere than its spelling says.
    const auto shorter = file.lexically_normal();
    return std::filesystem::equivalent(shorter, file, error) ? shorter : file;
}

void failInvalid(const JsonDocument& document, const std::string& wrong) {
    const std::string path = wrong.substr(0, wrong.find(' '));
    std::string pointer = path.starts_with('/') ? "" : "/";
    for (const char c : path) {
        if (c == '.' || c == '[')
            pointer += '/';
        else if (c != ']')
            pointer += c;
    }
    const bool isPointer = pointer.size() > 1 && pointer.find('~') == std::string::npos && path.size() < wrong.size();
    if (isPointer && document.root().contains(Json::json_pointer(pointer))) {
        document.fail(pointer, wrong.substr(path.size() + 1));
    }
    document.fail("", "is not usable: " + wrong);
}

void writeJson(const Json& json, const std::filesystem::path& path) {
    std::ostringstream text;
    try {
        print(text, json, "");
    } catch (const Json::type_error&) {
        // Of file systems, where names are any bytes. Nothing is written then: a half of a file would be read as none.
        throw AssetError(path.string() + ": cannot be written, since a name in it is not UTF-8, as JSON is");
    }
    std::ofstream out(path, std::ios::binary);
    out << text.view() << "\n";
    if (!out.flush()) throw AssetError(path.string() + ": cannot be written");
}

}  // namespace ragtop
