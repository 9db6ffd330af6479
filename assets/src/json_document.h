#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace ragtop {

using Json = nlohmann::ordered_json;

/// Where a value begins in its file; both count from 1. Line 0: `file` is no file but says where it came from.
struct JsonPlace {
    std::string file;
    int line = 1, column = 1;
};

/// A JSON file with comments, and where each of its values stands. Places are kept by JSON pointer.
class JsonDocument {
public:
    /// Throws AssetError on unreadable or malformed text, a key that occurs twice, nesting deeper than 64 levels or
    /// a file above 32 MiB.
    static JsonDocument load(const std::filesystem::path& path);
    static JsonDocument parse(std::string_view text, const std::string& file);

    const Json& root() const { return root_; }
    /// The place of the value at `pointer`, or of the nearest value around it.
    JsonPlace place(const std::string& pointer) const;
    /// The folder that references in the value at `pointer` start from.
    std::filesystem::path folderOf(const std::string& pointer) const;

    /// The files that it was read from: its own, then what it was laid over.
    const std::vector<std::filesystem::path>& files() const { return files_; }

    /// Lays this document over `base`: members of objects are merged, and where the base has a list and this one an
    /// object, its members into the elements of their names; everything else replaces. Throws AssetError where the list
    /// has no such element.
    void layOver(const JsonDocument& base);
    void erase(const std::string& key) { root_.erase(key); }
    /// Sets the value at a path like "settings.sleeping"; its place is the `origin` that the caller names. Throws
    /// AssetError where the path leads through something that is no object or array.
    void set(std::string_view dottedPath, const Json& value, const std::string& origin);
    void set(const std::vector<std::string>& path, const Json& value, const std::string& origin);

    /// "file:line:column: /pointer message".
    std::string complaint(const std::string& pointer, const std::string& message) const;
    /// Throws AssetError with that.
    [[noreturn]] void fail(const std::string& pointer, const std::string& message) const;

private:
    void mergeOver(Json& base, const std::string& pointer, const std::string& pointerInBase);

    Json root_;
    std::string file_;
    std::map<std::string, JsonPlace> places_;
    std::vector<std::filesystem::path> files_;
    std::map<std::string, std::string> moved_;  ///< pointers by name to pointers by index, of the last laying over
};

/// `key` as one step of a JSON pointer, with its slash.
std::string pointerStep(std::string_view key);
/// A text without comments; discarded where it is none of JSON.
Json parsedOrDiscarded(std::string_view text);
/// A value for a message, on one line and short.
std::string shown(const Json& value);

}  // namespace ragtop
