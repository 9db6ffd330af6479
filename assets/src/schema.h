#pragma once

#include "json_document.h"

namespace ragtop {

/// Validates a document against a JSON schema made by describe_json.h. Throws AssetError that names the innermost
/// wrong value, its place and what is allowed there.
void validate(const JsonDocument& document, const Json& schema);

/// The name that `given` is most likely a slip of, or empty when none is near.
std::string nearestName(const std::string& given, const std::vector<std::string>& names);

}  // namespace ragtop
