#include "ragtop/vehicle_file.h"

#include "asset_reference.h"
#include "described_file.h"

namespace ragtop {

/// Names of files become paths that hold wherever the definition goes, and are equal where the files are.
static void findModels(const JsonDocument& document, VehicleVisualDef& visual) {
    const JsonValue at = JsonValue(document).at("visual");
    const auto found = [&](const char* key) {
        const auto file = std::filesystem::absolute(assetFile(at.at(key)));
        return (std::filesystem::canonical(file.parent_path()) / file.filename()).string();
    };
    visual.chassis = found("chassis");
    if (!visual.wheel.empty()) visual.wheel = found("wheel");
}

VehicleDef readVehicle(const JsonDocument& document) {
    VehicleDef def = readDocument<VehicleDef>(document);
    if (def.visual) findModels(document, *def.visual);
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) failInvalid(document, wrong);
    return def;
}

VehicleDef loadVehicle(const std::filesystem::path& path) { return readVehicle(loadExtended(path)); }

void saveVehicle(const VehicleDef& def, const std::filesystem::path& path) {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) {
        throw AssetError(path.string() + ": is not written, the vehicle is not usable: " + wrong);
    }
    writeJson(writeValue(def), path);
}

}  // namespace ragtop
