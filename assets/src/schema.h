#pragma once

#include <memory>

#include "faults.h"
#include "json_document.h"

namespace ragtop {

/// A JSON schema made by describe_json.h, ready to check documents: making it takes longer than most checks.
class DocumentSchema {
public:
    explicit DocumentSchema(Json schema);
    ~DocumentSchema();
    DocumentSchema(const DocumentSchema&) = delete;
    DocumentSchema& operator=(const DocumentSchema&) = delete;

private:
    friend void findFaults(const JsonDocument&, const DocumentSchema&, Faults&);
    struct Compiled;
    std::unique_ptr<const Compiled> compiled_;
};

/// Finds what of a document does not fit a schema: the innermost wrong values with their places and what is allowed
/// there.
void findFaults(const JsonDocument& document, const DocumentSchema& schema, Faults& faults);

/// Lets objects of a schema have members that it does not name.
void allowUnknown(Json& schema);

/// The name that `given` is most likely a slip of, or empty when none is near.
std::string nearestName(const std::string& given, const std::vector<std::string>& names);

}  // namespace ragtop
