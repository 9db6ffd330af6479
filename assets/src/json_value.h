#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "faults.h"
#include "json_document.h"

namespace ragtop {

/// A value of a document with its pointer, for readers that may have to complain about it. Where the faults of the
/// document are collected, readers ask what is wrong already.
class JsonValue {
public:
    explicit JsonValue(const JsonDocument& document, Faults* faults = nullptr)
        : document_(&document), json_(&document.root()), faults_(faults) {}

    const Json& json() const { return *json_; }
    const std::string& pointer() const { return pointer_; }
    bool has(const std::string& key) const;
    std::size_t size() const { return json_->size(); }
    JsonValue at(const std::string& key) const;
    JsonValue at(std::size_t index) const;
    /// The folder of the file that the value stands in.
    std::filesystem::path folder() const;
    JsonPlace place() const;
    [[noreturn]] void fail(const std::string& message) const { document_->fail(pointer_, message); }

    bool isWrong() const;
    /// Itself or something in it.
    bool holdsWrong() const;
    bool holdsUnknown() const;
    /// Calls `read`; what that complains about is collected, or thrown where nobody collects.
    template <class Read>
    void attempt(Read read) const {
        if (faults_)
            faults_->attempt(pointer_, read);
        else
            read();
    }
    /// Calls `read` with a member that is there and not wrong, likewise.
    template <class Read>
    void attempt(const std::string& key, Read read) const {
        if (!has(key)) return;
        const JsonValue member = at(key);
        if (!member.holdsWrong()) member.attempt([&] { read(member); });
    }

private:
    JsonValue(const JsonValue& around, const Json* json, const std::string& step);

    const JsonDocument* document_;
    const Json* json_;
    std::string pointer_;
    Faults* faults_ = nullptr;
};

}  // namespace ragtop
