#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "json_document.h"

namespace ragtop {

/// A value of a document with its pointer, for readers that may have to complain about it.
class JsonValue {
public:
    explicit JsonValue(const JsonDocument& document) : document_(&document), json_(&document.root()) {}

    const Json& json() const { return *json_; }
    const std::string& pointer() const { return pointer_; }
    bool has(const std::string& key) const { return json_->is_object() && json_->contains(key); }
    std::size_t size() const { return json_->size(); }
    JsonValue at(const std::string& key) const { return {document_, &json_->at(key), pointer_ + pointerStep(key)}; }
    JsonValue at(std::size_t index) const {
        return {document_, &json_->at(index), pointer_ + "/" + std::to_string(index)};
    }
    /// The folder of the file that the value stands in.
    std::filesystem::path folder() const { return document_->folderOf(pointer_); }
    JsonPlace place() const { return document_->place(pointer_); }
    [[noreturn]] void fail(const std::string& message) const { document_->fail(pointer_, message); }

private:
    JsonValue(const JsonDocument* document, const Json* json, std::string pointer)
        : document_(document), json_(json), pointer_(std::move(pointer)) {}

    const JsonDocument* document_;
    const Json* json_;
    std::string pointer_;
};

}  // namespace ragtop
