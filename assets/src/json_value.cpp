#include "json_value.h"

#include <string>

namespace ragtop {

JsonValue::JsonValue(const JsonValue& around, const Json* json, const std::string& step)
    : document_(around.document_), json_(json), pointer_(around.pointer_ + step), faults_(around.faults_) {}

bool JsonValue::has(const std::string& key) const { return json_->is_object() && json_->contains(key); }

JsonValue JsonValue::at(const std::string& key) const { return {*this, &json_->at(key), pointerStep(key)}; }

JsonValue JsonValue::at(std::size_t index) const { return {*this, &json_->at(index), "/" + std::to_string(index)}; }

std::filesystem::path JsonValue::folder() const { return document_->folderOf(pointer_); }

JsonPlace JsonValue::place() const { return document_->place(pointer_); }

bool JsonValue::isWrong() const { return faults_ && faults_->at(pointer_); }

bool JsonValue::holdsWrong() const { return faults_ && faults_->within(pointer_); }

bool JsonValue::holdsUnknown() const { return faults_ && faults_->unknownIn(pointer_); }

}  // namespace ragtop
