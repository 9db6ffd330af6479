#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "describe_json.h"
#include "json_document.h"
#include "ragtop/ragdoll.h"
#include "ragtop/vehicle_def.h"
#include "schema.h"

namespace ragtop {

/// How many files may extend, or include, one another in a row.
inline constexpr std::size_t kLongestChain = 64;

/// Reads a file and what it `extends`, from the base up. Throws AssetError on a file that extends itself, or in too
/// long a row.
JsonDocument loadExtended(const std::filesystem::path& path);

/// The file that the string `value` names, relative to the file that it stands in.
std::filesystem::path referencedFile(const JsonValue& value);

/// Fails with what a whyInvalid says, at the value that its first word names ("wheels[2].radius is ...") if there is one.
[[noreturn]] void failInvalid(const JsonDocument& document, const std::string& wrong);

/// What loadVehicle and loadRagdoll read, from a document.
VehicleDef readVehicle(const JsonDocument& document);
RagdollDef readRagdoll(const JsonDocument& document);
/// What saveRagdoll writes.
Json writeRagdoll(const RagdollDef& def);

void writeJson(const Json& json, const std::filesystem::path& path);

/// Reads a described struct from a file. `T`'s own whyInvalid has the last word.
template <Described T>
T readDocument(const JsonDocument& document, Faults& faults) {
    static const DocumentSchema schema(objectSchema(T{}));
    T value{};
    findFaults(document, schema, faults);
    readValue(JsonValue(document, &faults), value);
    return value;
}

/// The same of somebody else's document, whose members that `T` does not have are passed over. Throws AssetError that
/// names all faults.
template <Described T>
T readOpenDocument(const JsonDocument& document) {
    static const DocumentSchema schema([] {
        Json open = objectSchema(T{});
        allowUnknown(open);
        return open;
    }());
    T value{};
    Faults faults(document);
    findFaults(document, schema, faults);
    readValue(JsonValue(document, &faults), value);
    faults.throwIfAny();
    return value;
}

}  // namespace ragtop
