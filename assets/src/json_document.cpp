#include "json_document.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "json_scan.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{32} << 20;

std::string located(const JsonPlace& place, const std::string& message) {
    if (place.line == 0) return place.file + ": " + message;
    return fmt::format("{}:{}:{}: {}", place.file, place.line, place.column, message);
}

/// nlohmann's texts begin with "[json.exception…] parse error at line…: "; what follows says what is wrong.
std::string reasonOf(const nlohmann::json::exception& error) {
    std::string text = error.what();
    if (const auto bracket = text.find("] "); bracket != std::string::npos) text.erase(0, bracket + 2);
    if (const auto colon = text.find(": "); text.starts_with("parse error") && colon != std::string::npos) {
        text.erase(0, colon + 2);
    }
    std::string line;
    // It quotes the last bytes read, which may be anything.
    for (const char c : text) line += c < 0x20 ? '?' : c;
    // A value that is not closed is quoted to the end of the file.
    constexpr std::size_t kBegin = 100, kEnd = 60;
    if (line.size() <= kBegin + kEnd) return line;
    const auto wholeCharacter = [&](std::size_t at) {
        while (at > 0 && (static_cast<unsigned char>(line[at]) & 0xc0u) == 0x80u) --at;
        return at;
    };
    return line.substr(0, wholeCharacter(kBegin)) + " … " + line.substr(wholeCharacter(line.size() - kEnd));
}

/// Accepts everything, and turns the first error into an AssetError that has a place.
class SyntaxCheck : public nlohmann::json_sax<Json> {
public:
    SyntaxCheck(std::string_view text, const std::string& file) : text_(text), file_(file) {}
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return true; }
    bool key(string_t&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) override {
        JsonPlace place = placeAt(text_, position > 0 ? position - 1 : 0);
        place.file = file_;
        throw AssetError(located(place, "is not JSON: " + reasonOf(error)));
    }

private:
    std::string_view text_;
    const std::string& file_;
};

std::string read(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw AssetError(path.string() + ": no such file");
    if (!std::filesystem::is_regular_file(path, error)) throw AssetError(path.string() + ": is not a file");
    const auto bytes = std::filesystem::file_size(path, error);
    if (error || bytes > kMaxBytes) {
        throw AssetError(fmt::format("{}: is {} bytes long, must be at most {}", path.string(), bytes, kMaxBytes));
    }
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw AssetError(path.string() + ": cannot be read");
    return std::move(text).str();
}

/// What the elements of a list go by: their name, or of joints the part that they carry; empty: by nothing.
std::string nameOf(const Json& element) {
    for (const char* key : {"name", "child"})
        if (element.is_object() && element.contains(key) && element.at(key).is_string())
            return element.at(key).get<std::string>();
    return {};
}

}  // namespace

JsonDocument JsonDocument::load(const std::filesystem::path& path) {
    JsonDocument document = parse(read(path), path.string());
    document.files_.push_back(path);
    return document;
}

JsonDocument JsonDocument::parse(std::string_view text, const std::string& file) {
    JsonDocument document;
    document.file_ = file;
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
        throw AssetError(file + ":1:1: is empty, must be a JSON object");
    }
    SyntaxCheck check(text, file);
    Json::sax_parse(text, &check, nlohmann::detail::input_format_t::json, true, true);
    document.places_ = scanPlaces(text, file);
    document.root_ = Json::parse(text, nullptr, true, true);
    return document;
}

JsonPlace JsonDocument::place(const std::string& pointer) const {
    for (std::string at = pointer;; at.erase(at.rfind('/'))) {
        if (const auto found = places_.find(at); found != places_.end()) return found->second;
        if (at.empty()) return {file_, 1, 1};
    }
}

std::filesystem::path JsonDocument::folderOf(const std::string& pointer) const {
    return std::filesystem::path(place(pointer).file).parent_path();
}

/// Members of objects are merged, and an object over a list into the elements of these names. Everything else replaces.
void JsonDocument::mergeOver(Json& base, const std::string& pointer, const std::string& pointerInBase) {
    const Json over = pointer.empty() ? root_ : root_.at(Json::json_pointer(pointer));
    if (pointer != pointerInBase) moved_[pointer] = pointerInBase;
    if (base.is_object() && over.is_object()) {
        for (const auto& [key, value] : over.items()) {
            const std::string step = pointerStep(key);
            if (base.contains(key))
                mergeOver(base[key], pointer + step, pointerInBase + step);
            else
                base[key] = value;
        }
    } else if (base.is_array() && over.is_object()) {
        for (const auto& [key, value] : over.items()) {
            std::size_t i = 0;
            std::string names;
            for (; i < base.size() && nameOf(base[i]) != key; ++i) names += (i > 0 ? ", " : "") + nameOf(base[i]);
            if (i == base.size())
                fail(pointer + pointerStep(key), "is no element of the list, must be one of " + names);
            mergeOver(base[i], pointer + pointerStep(key), pointerInBase + "/" + std::to_string(i));
        }
    } else {
        base = over;
    }
}

void JsonDocument::layOver(const JsonDocument& base) {
    Json merged = base.root_;
    moved_.clear();
    mergeOver(merged, "", "");
    std::map<std::string, JsonPlace> places;
    for (const auto& [pointer, place] : places_) {
        std::string around = pointer;
        while (!around.empty() && !moved_.contains(around)) around.erase(around.rfind('/'));
        places.emplace(around.empty() ? pointer : moved_.at(around) + pointer.substr(around.size()), place);
    }
    places_ = std::move(places);
    places_.insert(base.places_.begin(), base.places_.end());
    root_ = std::move(merged);
    files_.insert(files_.end(), base.files_.begin(), base.files_.end());
}

void JsonDocument::set(std::string_view dottedPath, const Json& value, const std::string& origin) {
    std::vector<std::string> path;
    std::istringstream steps{std::string(dottedPath)};
    for (std::string step; std::getline(steps, step, '.');) path.push_back(step);
    set(path, value, origin);
}

void JsonDocument::set(const std::vector<std::string>& path, const Json& value, const std::string& origin) {
    Json* at = &root_;
    std::string pointer;
    for (const std::string& step : path) {
        if (at->is_array()) {
            const bool isIndex =
                !step.empty() && step.size() < 9 && step.find_first_not_of("0123456789") == std::string::npos;
            if (!isIndex || std::stoul(step) >= at->size()) {
                throw AssetError(fmt::format("{}: {}/{} is no element, must be an index below {}", origin, pointer,
                                             step, at->size()));
            }
            at = &(*at)[std::stoul(step)];
        } else {
            if (at->is_null()) *at = Json::object();
            if (!at->is_object()) {
                throw AssetError(fmt::format("{}: {} is {}, has no member {}", origin, pointer, shown(*at), step));
            }
            at = &(*at)[step];
        }
        pointer += pointerStep(step);
    }
    *at = value;
    places_[pointer] = {origin, 0, 0};
}

std::string JsonDocument::complaint(const std::string& pointer, const std::string& message) const {
    return located(place(pointer), (pointer.empty() ? "/" : pointer) + " " + message);
}

void JsonDocument::fail(const std::string& pointer, const std::string& message) const {
    throw AssetError(complaint(pointer, message));
}

std::string pointerStep(std::string_view key) {
    std::string step = "/";
    for (const char c : key) {
        if (c == '~')
            step += "~0";
        else if (c == '/')
            step += "~1";
        else
            step += c;
    }
    return step;
}

Json parsedOrDiscarded(std::string_view text) { return Json::parse(text, nullptr, false); }

std::string shown(const Json& value) {
    if (value.is_object()) {
        std::string keys;
        for (const auto& item : value.items()) {
            if (keys.size() > 40) return "{" + keys + ", ...}";
            keys += (keys.empty() ? "" : ", ") + item.key();
        }
        return "{" + keys + "}";
    }
    std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (value.is_array() && text.size() > 40) return fmt::format("an array of {}", value.size());
    if (text.size() <= 60) return text;
    std::size_t end = 57;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
    return text.substr(0, end) + "...";
}

}  // namespace ragtop
