#include "ragtop/vehicle_file.h"

#include "described_file.h"

namespace ragtop {

VehicleDef loadVehicle(const std::filesystem::path& path) {
    const JsonDocument document = loadExtended(path);
    VehicleDef def = readDocument<VehicleDef>(document);
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) failInvalid(document, wrong);
    return def;
}

void saveVehicle(const VehicleDef& def, const std::filesystem::path& path) {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) {
        throw AssetError(path.string() + ": is not written, the vehicle is not usable: " + wrong);
    }
    writeJson(writeValue(def), path);
}

}  // namespace ragtop
