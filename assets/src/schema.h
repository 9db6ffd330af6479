#pragma once

#include "faults.h"
#include "json_document.h"

namespace ragtop {

/// Finds what of a document does not fit a JSON schema made by describe_json.h: the innermost wrong values with their
/// places and what is allowed there.
void findFaults(const JsonDocument& document, const Json& schema, Faults& faults);

/// Lets objects of a schema have members that it does not name.
void allowUnknown(Json& schema);

/// The name that `given` is most likely a slip of, or empty when none is near.
std::string nearestName(const std::string& given, const std::vector<std::string>& names);

}  // namespace ragtop
